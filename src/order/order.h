/* Insertion orders: permutations of the points for the incremental construction. */
#ifndef BRIO_ORDER_ORDER_H
#define BRIO_ORDER_ORDER_H

#include "order/rounds.h"

/** Writes the indices of the #P by 3 points to order[0 .. num_points), in the order of insertion. The result depends
 *  only on the options and the points.
 *  rank    NULL, or receives for each position in `order` the rank of its point along the curve, or through the blocks,
 *          among all points. Ranks rise inside a round. Meaningful only where brio_order_has_ranks is true.
 *  rounds  NULL, or receives the ends of the rounds.
 *  Workspace in bytes for each point: brio, hilbert and random 16, brio-octree 5, octree 4, brio-kdtree 20, input
 *  none. */
brio_status brio_order_points(brio_context *ctx, const double *points, size_t num_points,
                              const brio_delaunay_options *options, uint32_t *order, uint32_t *rank,
                              brio_round_ends *rounds);

/** Returns whether the order, inside each round, follows a path through space. */
bool brio_order_has_ranks(brio_order order);

#endif
