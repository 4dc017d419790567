/* Insertion orders: permutations of the points for the incremental construction. */
#ifndef BRIO_ORDER_ORDER_H
#define BRIO_ORDER_ORDER_H

#include "base/experiment.h"
#include "order/rounds.h"

/** Points that a caller has. */
typedef struct {
    const double *points;  /* count by 3 */
    const double *weights; /* count, or NULL */
    size_t count;
} brio_input;

/** Where an order goes, as brio_order_points has it. */
typedef struct {
    uint32_t *order, *rank;
    brio_round_ends *rounds;
} brio_ordering;

/** An experiment's part in the insertion order. */
struct brio_order_part {
    const void *user;
    /** Takes the place of brio_order_points; the order has ranks. A sequence is never wanted. */
    brio_status (*order)(const void *user, brio_context *ctx, const brio_input *input,
                         const brio_delaunay_options *options, const brio_ordering *out);
};

/** Writes the indices of the points to order[0 .. count), in the order of insertion. The result depends only on the
 *  options and the input; weights change nothing but the sequence.
 *  rank    NULL, or receives for each position in `order` the rank of its point along the curve among all points.
 *          Ranks rise inside a round. Meaningful only where brio_order_has_ranks is true.
 *  sequence  NULL, or, only for BRIO_ORDER_BRIO with weights, receives positions in `order`: a better sequence, whose
 *          early rounds hold the heavier points. Ranks rise inside its rounds, too.
 *  rounds  NULL, or receives the ends of the rounds, of `order` and of the sequence.
 *  Workspace in bytes for each point: brio, hilbert and random 16, input none. */
brio_status brio_order_points(brio_context *ctx, const brio_input *input, const brio_delaunay_options *options,
                              uint32_t *order, uint32_t *rank, uint32_t *sequence, brio_round_ends *rounds);

/** Returns whether the order, inside each round, follows a path through space. */
bool brio_order_has_ranks(brio_order order);

#endif
