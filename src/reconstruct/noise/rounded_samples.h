/* Samples whose depths are rounded. */
#ifndef BRIO_RECONSTRUCT_ROUNDED_SAMPLES_H
#define BRIO_RECONSTRUCT_ROUNDED_SAMPLES_H

#include "base/context.h"

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
