/* The half-edges of a mesh of triangles. Half-edge h starts at corner h and runs to the next corner of its triangle,
 * and its twin is the half-edge of the other triangle at that edge, which runs back. */
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

/** The twin of each half-edge, BRIO_NO_HALF_EDGE at the boundary. O(F log F), linear for vertices of few neighbours.
 *  twin  3 #F, owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_ANSWER (faces that are no triangles, edges
 *  of more than two faces or of faces that disagree), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_mesh_twins(brio_context *ctx, const brio_mesh *mesh, uint32_t **twin);

#endif
