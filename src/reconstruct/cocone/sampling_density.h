/* How dense a sample is, held against the guarantee. */
#ifndef BRIO_RECONSTRUCT_SAMPLING_DENSITY_H
#define BRIO_RECONSTRUCT_SAMPLING_DENSITY_H

#include "base/context.h"

/** Adds to the mesh, whose faces are triangles of the samples, the vertex properties "feature_size" (`size` in the unit
 *  of the mesh) and "r": the largest circumradius among the faces of a sample over its feature size, 0 without faces.
 *  Sets outside_guarantee, r_median and r_p95 of the stats.
 *  size  #P, in units of 2^exponent, in which all coordinates are at most 1.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_sampling_density(const double *size, int exponent, brio_mesh *mesh, brio_cocone_stats *stats);

#endif
