/* Fewer balls for nearly the same union. */
#ifndef BRIO_RECONSTRUCT_MEDIAL_BALL_COVER_H
#define BRIO_RECONSTRUCT_MEDIAL_BALL_COVER_H

#include "base/context.h"

/** A ball covers a smaller one if it contains it after one of two changes. */
typedef struct {
    double scale;      /* s >= 1: both radii are multiplied by s */
    double redundancy; /* e >= 0: only the larger radius is multiplied by 1 + e */
} brio_cover_rule;

/** A selection of balls. */
typedef struct {
    const double *centre; /* #P by 3 */
    const double *square; /* #P squared radii */
    const uint32_t *ball; /* `count` indices of balls, faster if neighbours in space are neighbours in this list */
    size_t count;
} brio_balls;

/** Keeps the largest ball and then, by descending radius, each ball that no ball kept before covers. So every point of
 *  a dropped ball of radius r is within max ((s - 1) (R - r), e R) of a kept ball of radius R >= r.
 *  keep  #P: set to 0 for the selected balls that are dropped; other entries are not written.
 *  Cost: one search in a tree of boxes for each ball.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_cover_balls(brio_context *ctx, const brio_balls *balls, const brio_cover_rule *rule, uint8_t *keep);

/** Scales all balls by `scale`, and drops those that then lie in the union of the others: those whose spheres reach no
 *  place of its boundary, except what is needed so that the union has no voids without them.
 *  keep  #P: set to 0 for the selected balls that are dropped; other entries are not written.
 *  Returns what brio_ball_union returns. */
brio_status brio_scale_axis(brio_context *ctx, const brio_balls *balls, double scale, uint64_t seed, uint8_t *keep);

#endif
