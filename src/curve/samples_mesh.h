/* A mesh whose vertices are the distinct positions of points. */
#ifndef BRIO_CURVE_SAMPLES_MESH_H
#define BRIO_CURVE_SAMPLES_MESH_H

#include "base/context.h"

/** Makes a mesh of the points that stand for themselves, in their order, with the property "sample" (uint32), the index
 *  of the point.
 *  vertex  #P: in, BRIO_INFINITE for points that are no vertices; out, the vertex of each other one.
 *  out     owned by the caller. */
brio_status brio_samples_mesh(brio_context *ctx, const double *points, size_t num_points, uint32_t *vertex,
                              brio_mesh **out);

#endif
