/* Rounds of a biased randomized insertion order. */
#ifndef BRIO_ORDER_ROUNDS_H
#define BRIO_ORDER_ROUNDS_H

#include "base/context.h"

enum { BRIO_MOST_ROUNDS = 64 };

/** The ends of the rounds of an order, from the first round on. An order without rounds has one round. */
typedef struct {
    int count;
    size_t end[BRIO_MOST_ROUNDS];
} brio_round_ends;

/** The indices to be divided into rounds, and the arrays for the result. */
typedef struct {
    const uint32_t *index; /* n indices of points */
    const double *weights; /* of each point, where `sequence` is wanted */
    size_t n;
    double ratio;       /* the expected share of the points that the rounds before the last hold */
    uint64_t seed;      /* the seed and the index of a point determine its round */
    uint32_t *order;    /* n: receives the indices by rounds; each round keeps the order of `index` */
    uint32_t *rank;     /* NULL, or n: receives for each position in `order` the position in `index` */
    uint32_t *sequence; /* NULL, or n: receives positions in `order`, as the heavier points come to earlier rounds */
} brio_division;

/** Divides indices into rounds.   ends  receives the ends of the rounds.   Needs n bytes of workspace. */
brio_status brio_divide_into_rounds(brio_context *ctx, const brio_division *division, brio_round_ends *ends);

#endif
