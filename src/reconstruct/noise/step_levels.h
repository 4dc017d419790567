/* Levels on which samples lie because their depths are rounded. */
#ifndef BRIO_RECONSTRUCT_STEP_LEVELS_H
#define BRIO_RECONSTRUCT_STEP_LEVELS_H

#include "base/context.h"

/** Depths that are rounded: along a direction, or the distance from a place. */
typedef struct {
    size_t count;     /* of the levels; 0: the samples are on none */
    double *depth;    /* #L, rising */
    double *step;     /* #L: to the nearer one of the levels beside it */
    int32_t *number;  /* #L: counted in steps, so that levels without samples count, too */
    bool is_distance; /* depths are distances from `place` */
    double place[3], direction[3];
    double spacing; /* of samples on one level, as their median */
    double angle;   /* likewise, as seen from `place` */
    double coarse;  /* the median step, of the samples that were looked at */
} brio_step_levels;

/** Finds whether the samples lie on levels more than a spacing apart, as those of a depth camera do whose depths are
 *  rounded.
 *  points  count by 3, neighbours in memory near each other in space.
 *  place   of the scanner, or NULL.
 *  out     freed with brio_step_levels_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_find_step_levels(brio_context *ctx, const double *points, size_t count, const double *place,
                                  brio_step_levels *out);
void brio_step_levels_free(brio_context *ctx, brio_step_levels *levels);

/** Returns the depth of a point. */
double brio_depth_of(const brio_step_levels *levels, const double *point);

/** Returns the level on which a point lies; levels->count if it lies on none. */
size_t brio_level_of(const brio_step_levels *levels, const double *point);

#endif
