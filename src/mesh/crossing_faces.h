/* Which faces of a mesh cross others. */
#ifndef BRIO_MESH_CROSSING_FACES_H
#define BRIO_MESH_CROSSING_FACES_H

#include "mesh/face_groups.h"

/** Counts pairs as brio_mesh_self_intersections does, with its cost and errors, and tells which faces they are of.
 *  only     NULL, or #F: 1 for the faces of which one at least is in each pair that counts.
 *  crosses  NULL, or #F: receives 1 or 0. */
brio_status brio_crossing_faces(brio_context *ctx, const brio_mesh *mesh, const uint8_t *only, uint8_t *crosses,
                                int64_t *pairs);

/** The same of faces whose boxes are found already: for several searches, between which vertices move a little. */
brio_status brio_search_crossings(const brio_face_groups *g, const uint8_t *only, uint8_t *crosses, int64_t *pairs);

#endif
