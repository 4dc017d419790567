/* How dense a sample is, held against the guarantee. */
#ifndef BRIO_RECONSTRUCT_SAMPLING_DENSITY_H
#define BRIO_RECONSTRUCT_SAMPLING_DENSITY_H

#include "dual/pole_vectors.h"

/** Adds to the mesh, whose faces are triangles of the samples, the vertex properties "feature_size" (the distance to
 *  the nearest pole, in the unit of the mesh) and "r": the largest circumradius among the faces of a sample over its
 *  feature size, 0 without faces. Sets outside_guarantee, r_median and r_p95 of the stats.
 *  exponent  the points of v are those of the mesh times 2^-exponent.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_sampling_density(brio_context *ctx, const brio_pole_vectors *v, int exponent, brio_mesh *mesh,
                                  brio_cocone_stats *stats);

#endif
