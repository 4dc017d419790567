/* The noise of samples: measuring and reducing it. */
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

#endif
