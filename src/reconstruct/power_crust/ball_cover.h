/* Fewer balls for nearly the same union. */
#ifndef BRIO_RECONSTRUCT_BALL_COVER_H
#define BRIO_RECONSTRUCT_BALL_COVER_H

#include "base/context.h"

/** When one ball may stand for another. */
typedef struct {
    double scale;      /* s >= 1: when both are scaled by s, it holds the other: noise */
    double redundancy; /* e >= 0: enlarged by e times its radius it holds the other as it is */
} brio_cover_rule;

/** Balls, and some of them. */
typedef struct {
    const double *centre; /* #P by 3 */
    const double *square; /* #P squared radii */
    const uint32_t *ball; /* `count` indices; balls that are near in space should be near in this list */
    size_t count;
} brio_balls;

/** Of some balls, keeps the largest and then, by descending radius, each that no ball kept before can stand for. So
 *  every point of the balls left out is within max ((s - 1) (R - r), e R) of one that is kept, of radius R >= r.
 *  keep  #P: set to 0 for those that are left out, not written for others.
 *  Cost: a search in a tree of boxes for each ball.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_cover_balls(brio_context *ctx, const brio_balls *balls, const brio_cover_rule *rule, uint8_t *keep);

#endif
