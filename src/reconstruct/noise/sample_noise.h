/* The noise of samples: measuring and reducing it, and undoing the rounding that hides it (rounded_samples.c). */
#ifndef BRIO_RECONSTRUCT_SAMPLE_NOISE_H
#define BRIO_RECONSTRUCT_SAMPLE_NOISE_H

#include "base/context.h"

/** Estimates the standard deviation of the noise, in spacings of the samples. *level is 0 if the deviation from smooth
 *  surfaces is the shape of the surface or that of two sheets, one close behind the other, is under 0.1 spacings, or is
 *  over 0.5 spacings.
 *  points  count by 3.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_noise_level(brio_context *ctx, const double *points, size_t count, double *level);

/** How points scatter where they scatter least. */
typedef struct {
    double level; /* in spacings; 0 if there are too few points */
    bool
        layered; /* most of the points have a second sheet close behind theirs: walls are about as thin as the spacing */
} brio_least_scatter;

/** Estimates the noise where there is least of it: at a tenth of the samples the standard deviation of the nearest
 *  points from a plane is lower, in spacings. Few points are near enough that shape hardly counts. Of two sheets, one
 *  close behind the other, each counts alone. Noise of 0.3 spacings in each coordinate gives about 0.11.
 *  points  count by 3.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_least_noise(brio_context *ctx, const double *points, size_t count, brio_least_scatter *out);

/** Moves every point, twice, onto a quadratic surface through the middle of its 48 nearest points. Equal points stay
 *  equal. Fewer than 48 points stay as they are.
 *  points  count by 3, read and written.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_smooth_samples(brio_context *ctx, double *points, size_t count);

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

/** What was rounded. */
typedef struct {
    double step;  /* in the unit of the points: the median of the steps; 0: nothing is rounded */
    size_t moved; /* samples */
} brio_rounding;

/** Finds whether the depths of samples are rounded to steps of over a spacing, along one direction or as distances from
 *  one place. If so, moves each sample by at most half a step, towards the scanner or away from it, so that the steps
 *  become slopes. Samples whose depths are not rounded stay, bit for bit.
 *  points  count by 3, read and written; neighbours in memory near each other in space.
 *  place   of the scanner that saw all of them, or NULL.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. Does not depend on the number of threads. */
brio_status brio_unround_samples(brio_context *ctx, double *points, size_t count, const double *place,
                                 brio_rounding *out);

#endif
