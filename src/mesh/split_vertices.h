/* One vertex for each fan of faces. */
#ifndef BRIO_MESH_SPLIT_VERTICES_H
#define BRIO_MESH_SPLIT_VERTICES_H

#include "base/context.h"

/** Gives each fan of faces round a vertex its own vertex, with the position and the properties of the old vertex.
 *  Drops vertices without faces. If every edge has at most two faces, oriented alike, the result is manifold.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_split_vertices(brio_context *ctx, brio_mesh *mesh);

/** Does what brio_mesh_split_vertices does, and joins no faces across an edge that has more than two of them, or two
 *  that run along it in one direction. So the result is manifold and oriented for every mesh whose faces have distinct
 *  vertices. */
brio_status brio_mesh_cut_apart(brio_context *ctx, brio_mesh *mesh);

/** Does what brio_mesh_split_vertices does for the boundary of a solid, made of triangles, where edges may have more
 *  than two faces. Of these faces, two stay joined when the inside lies between them. The result is manifold, and
 *  closed if the mesh was closed.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_split_sheets(brio_context *ctx, brio_mesh *mesh);

/** Returns the half-edge in the ring of h across the inside wedge of h or, with inside false, across its outside wedge;
 *  h itself where no face of the ring runs the other way. The mesh is of triangles, with positions.
 *  ring  as of brio_edge_rings. */
uint32_t brio_wedge_partner(const brio_mesh *mesh, const uint32_t *ring, uint32_t h, bool inside);

#endif
