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

/** What is to be divided into rounds, and where the result goes. */
typedef struct {
    const uint32_t *index; /* n indices of points */
    size_t n;
    double ratio;    /* share of the points left for the rounds before the last */
    uint64_t seed;   /* the round of a point follows from the seed and the point's index */
    uint32_t *order; /* receives the indices by rounds, within a round in the order in which they stand in `index` */
    uint32_t *rank;  /* NULL, or receives for each place in the order the place in `index` */
} brio_division;

/** Divides indices into rounds.   ends  receives where the rounds end.   Needs n bytes of workspace. */
brio_status brio_divide_into_rounds(brio_context *ctx, const brio_division *division, brio_round_ends *ends);

#endif
