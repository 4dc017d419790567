/* The co-cone and the tight co-cone. */
#ifndef BRIO_RECONSTRUCT_COCONE_H
#define BRIO_RECONSTRUCT_COCONE_H

#include "base/context.h"

/** Makes a surface, as brio_surface describes it, in an empty mesh.   options  with their defaults; a theta of 0 is pi
 *  / 8.
 *  stats  zeros. */
brio_status brio_cocone(brio_context *ctx, const double *points, size_t num_points, const brio_surface_options *options,
                        brio_mesh *mesh, brio_surface_stats *stats);

#endif
