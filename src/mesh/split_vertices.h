/* One vertex for each fan of faces. */
#ifndef BRIO_MESH_SPLIT_VERTICES_H
#define BRIO_MESH_SPLIT_VERTICES_H

#include "base/context.h"

/** Gives each fan of faces round a vertex a vertex of its own, at the same place and with the same properties, and
 *  drops vertices without faces. A mesh whose edges have at most two faces, oriented alike, is then manifold. Returns
 *  BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_split_vertices(brio_context *ctx, brio_mesh *mesh);

/** The same for the boundary of a solid, made of triangles, where edges may have more than two faces: of these, each two
 *  stay together that have the inside between them. The mesh is then manifold, and closed when it was.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_split_sheets(brio_context *ctx, brio_mesh *mesh);

#endif
