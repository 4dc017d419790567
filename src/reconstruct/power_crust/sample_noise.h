/* Noise of samples: how much there is, and samples with less. */
#ifndef BRIO_RECONSTRUCT_SAMPLE_NOISE_H
#define BRIO_RECONSTRUCT_SAMPLE_NOISE_H

#include "base/context.h"

/** *level = the standard deviation of the noise in units of the spacing between samples, or 0 where what the samples are
 *  off smooth surfaces is their shape or is little beside the spacing.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_noise_level(brio_context *ctx, const double *points, size_t count, double *level);

/** Moves every point onto a piece of surface through the middle of its neighbours. Duplicates stay duplicates.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_smooth_samples(brio_context *ctx, double *points, size_t count);

#endif
