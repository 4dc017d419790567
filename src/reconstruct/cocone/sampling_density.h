/* The density of a sample, compared with the guarantee. */
#ifndef BRIO_RECONSTRUCT_SAMPLING_DENSITY_H
#define BRIO_RECONSTRUCT_SAMPLING_DENSITY_H

#include "base/context.h"

/** Adds two vertex properties to a mesh of triangles. "feature_size" is `size` in the unit of the mesh. "r" is the
 *  largest circumradius of the faces at a sample divided by its feature size, or 0 without faces. Sets
 *  outside_guarantee, r_median and r_p95 of the stats.
 *  size  #P: size[p] * 2^exponent is in the unit of the mesh. All coordinates are at most 2^exponent.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the mesh has such properties), BRIO_ERR_NO_MEMORY. */
brio_status brio_sampling_density(const double *size, int exponent, brio_mesh *mesh, brio_surface_stats *stats);

#endif
