/* The spacing of samples. */
#ifndef BRIO_DUAL_SPACING_H
#define BRIO_DUAL_SPACING_H

#include "dual/poles.h"

/** Writes spacing[s], #samples: the mean length of the six shortest Delaunay edges of sample s. Six is the mean degree
 *  of a vertex of a triangulated surface. A sample with fewer edges takes the mean of all its edges; a duplicate has
 *  spacing 0.
 *  second  NULL, or receives the length of the second shortest edge, INFINITY for a sample that has fewer.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_sample_spacing(brio_context *ctx, const brio_triangulation *t, const double *points,
                                size_t num_samples, double *spacing, float *second);

/** Writes spacing[p], #poles: the largest spacing of a sample that has p as a pole. */
void brio_pole_spacing(const brio_poles *poles, size_t num_samples, const double *of_sample, double *spacing);

#endif
