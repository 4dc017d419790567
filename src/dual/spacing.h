/* The spacing of samples. */
#ifndef BRIO_DUAL_SPACING_H
#define BRIO_DUAL_SPACING_H

#include "dual/poles.h"

/** spacing[s], #samples: the mean length of the six shortest Delaunay edges of sample s, as many as a vertex of a
 *  triangulated surface has; of fewer where there are fewer, 0 for duplicates.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_sample_spacing(brio_context *ctx, const brio_triangulation *t, const double *points,
                                size_t num_samples, double *spacing);

/** spacing[p], #poles: the largest spacing of the samples whose pole p is. */
void brio_pole_spacing(const brio_poles *poles, size_t num_samples, const double *of_sample, double *spacing);

#endif
