/* Which tetrahedra meet in a facet, and the edges of tetrahedra. Facet 4*t + i is opposite to corner i of tetrahedron
 * t. */
#ifndef BRIO_MESH_TETRAHEDRA_ADJACENCY_H
#define BRIO_MESH_TETRAHEDRA_ADJACENCY_H

#include "base/context.h"

/** The corners of tetrahedron t that facet 4*t + i has. Seen from outside of a positive tetrahedron they run
 *  counterclockwise. */
extern const uint8_t brio_facet_corners[4][3];

/** Finds for each facet the tetrahedron on its other side, or BRIO_INFINITE if there is none.
 *  mesh        its indices are in range.
 *  neighbours  #T by 4, owned by the caller (brio_release); NULL on failure.
 *  Cost: O(T log T); 20 bytes a tetrahedron and 4 a vertex, of which 16 a tetrahedron stay.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (three tetrahedra share a facet), BRIO_ERR_TOO_LARGE (2^30 tetrahedra or more),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_tetrahedra_neighbours(brio_context *ctx, const brio_mesh *mesh, uint32_t **neighbours);

typedef struct brio_tetrahedra_edges {
    uint32_t *ends; /* #E by 2, the lesser vertex first, in lexicographic order */
    uint8_t *hull;  /* #E: whether a facet without a neighbour has the edge */
    size_t count, ends_capacity, hull_capacity;
} brio_tetrahedra_edges;

/** Lists the edges of tetrahedra, each once.   neighbours  as above.
 *  out  freed with brio_tetrahedra_edges_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_tetrahedra_edges_find(brio_context *ctx, const brio_mesh *mesh, const uint32_t *neighbours,
                                       brio_tetrahedra_edges *out);
void brio_tetrahedra_edges_free(brio_context *ctx, brio_tetrahedra_edges *edges);

#endif
