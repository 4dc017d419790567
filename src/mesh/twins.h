/* The half-edges of a mesh of triangles. Half-edge h starts at corner h and ends at the next corner of its triangle.
 * Its twin is the half-edge of the neighbouring triangle at that edge, in the opposite direction. */
#ifndef BRIO_MESH_TWINS_H
#define BRIO_MESH_TWINS_H

#include "base/memory.h"

#define BRIO_NO_HALF_EDGE UINT32_MAX

static inline uint32_t brio_next_corner(uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}
static inline uint32_t brio_previous_corner(uint32_t h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}

/** Writes the twin of each half-edge, or BRIO_NO_HALF_EDGE at the boundary. O(F log F); linear when vertices have few
 *  neighbours.   twin  3 #F, owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (a face that is not a triangle, an
 *  edge of more than two faces, or two faces that disagree on the direction of an edge), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_twins(brio_context *ctx, const brio_mesh *mesh, uint32_t **twin);

#endif
