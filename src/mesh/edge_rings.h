/* Which faces meet at which edge. Half-edge h of a mesh starts at corner h (entry h of face_vertices) and ends at the
 * next corner of its face. An edge is the set of all half-edges between two vertices, in either direction. */
#ifndef BRIO_MESH_EDGE_RINGS_H
#define BRIO_MESH_EDGE_RINGS_H

#include "base/memory.h"

/** Checks the faces of a mesh: offsets ascend from 0, all vertices exist, and 32 bits can name all corners. Returns
 *  BRIO_OK, or BRIO_ERR_ARGUMENT or BRIO_ERR_TOO_LARGE with a message that names the fault. */
brio_status brio_mesh_check_faces(brio_context *ctx, const brio_mesh *mesh);

/** Links the half-edges of each edge into a ring: ring[h] is the next half-edge of the edge in ascending order; the
 *  last one links back to the first. So ring[h] == h at a boundary edge, and ring[h] <= h for exactly one half-edge of
 *  each edge. The mesh has passed brio_mesh_check_faces.   ring  #corners, owned by the caller (brio_release). */
brio_status brio_edge_rings(brio_context *ctx, const brio_mesh *mesh, uint32_t **ring);

#endif
