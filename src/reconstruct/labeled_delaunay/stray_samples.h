/* Samples that lie alone, far from every surface. */
#ifndef BRIO_RECONSTRUCT_STRAY_SAMPLES_H
#define BRIO_RECONSTRUCT_STRAY_SAMPLES_H

#include "base/context.h"

/** Finds samples that lie alone: their second nearest sample is several times as far away as the sampling round them
 *  allows.
 *  spacing, second  #P: of the samples, as brio_sample_spacing finds them.
 *  stray    #P, written: 1 for such samples; all 0 if they are more than a few.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_find_strays(brio_context *ctx, const brio_triangulation *t, const double *points, size_t num_points,
                             const double *spacing, const float *second, uint8_t *stray);

#endif
