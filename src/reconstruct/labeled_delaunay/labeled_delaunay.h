/* The labeled Delaunay triangulation. */
#ifndef BRIO_RECONSTRUCT_LABELED_DELAUNAY_H
#define BRIO_RECONSTRUCT_LABELED_DELAUNAY_H

#include "base/context.h"

/** Makes a surface, as brio_surface describes it, in an empty mesh.   options  with their defaults.   stats  zeros. */
brio_status brio_labeled_delaunay(brio_context *ctx, const double *points, size_t num_points,
                                  const brio_surface_options *options, brio_mesh *mesh, brio_surface_stats *stats);

#endif
