/* One vertex for each fan of faces. */
#ifndef BRIO_SURFACE_SPLIT_VERTICES_H
#define BRIO_SURFACE_SPLIT_VERTICES_H

#include "base/context.h"

/** Gives each fan of faces round a vertex a vertex of its own, at the same place and with the same properties, and
 *  drops vertices without faces. A mesh whose edges have at most two faces, oriented alike, is then manifold. Returns
 *  BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_split_vertices(brio_context *ctx, brio_mesh *mesh);

#endif
