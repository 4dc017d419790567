/* Rounds of a biased randomized insertion order. */
#ifndef BRIO_ORDER_ROUNDS_H
#define BRIO_ORDER_ROUNDS_H

#include "base/context.h"

enum { BRIO_MOST_ROUNDS = 64 };

/** Where the rounds of an order end, the first one first; an order without rounds has one. */
typedef struct {
    int count;
    size_t end[BRIO_MOST_ROUNDS];
} brio_round_ends;

/** order = the n indices by rounds, in each round in the order in which they stand. The round of a point follows from
 *  the seed and its index.
 *  ratio  share of the points left for the rounds before the last.
 *  rank   NULL, or receives for each place in the order the index's place in `index`.
 *  Needs n bytes of workspace. */
brio_status brio_divide_into_rounds(brio_context *ctx, const uint32_t *index, size_t n, double ratio, uint64_t seed,
                                    uint32_t *order, uint32_t *rank, brio_round_ends *rounds);

#endif
