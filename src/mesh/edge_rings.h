/* Which faces meet at which edge. The half-edge h of a mesh starts at corner h (entry h of face_vertices) and runs to
 * the next corner of its face; an edge is the set of the half-edges over the same two vertices, in either direction. */
#ifndef BRIO_MESH_EDGE_RINGS_H
#define BRIO_MESH_EDGE_RINGS_H

#include "base/memory.h"

/** BRIO_OK when the faces of a mesh are sound: offsets that ascend from 0, vertices that exist, and no more corners
 *  than 32 bits can name. Otherwise BRIO_ERR_ARGUMENT or BRIO_ERR_TOO_LARGE, with the first face that is not. */
brio_status brio_mesh_check_faces(brio_context *ctx, const brio_mesh *mesh);

/** Links the half-edges of each edge into a ring: ring[h] is the next half-edge of the same edge in ascending order,
 *  and the last one leads back to the first. So ring[h] == h at a boundary edge, and ring[h] <= h for exactly one
 *  half-edge of each edge. The mesh has passed brio_mesh_check_faces.   ring  #corners, owned by the caller
 *  (brio_release). */
brio_status brio_edge_rings(brio_context *ctx, const brio_mesh *mesh, uint32_t **ring);

#endif
