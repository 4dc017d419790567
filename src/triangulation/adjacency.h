/* Adjacency of tetrahedra that come without it. */
#ifndef BRIO_TRIANGULATION_ADJACENCY_H
#define BRIO_TRIANGULATION_ADJACENCY_H

#include "triangulation/tetrahedra.h"

/** Finite tetrahedra that a caller has: the four vertices of tetrahedron i are at vertices + stride * i. */
typedef struct {
    const uint32_t *vertices;
    size_t stride, count;
} brio_tetrahedron_list;

/** Builds the full structure of `tetrahedra.h` from the vertices of finite tetrahedra: makes each positive, matches facets, and closes the hull with infinite tetrahedra. record holds num_points records; tet of
 *  *out becomes owned by the caller. Returns BRIO_OK, BRIO_ERR_CHECK (an index out of range, a flat tetrahedron, a
 *  facet of three tetrahedra, an edge of the hull without exactly two hull facets; the message says where),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_adjacency_build(brio_context *ctx, const brio_record *record, size_t num_points,
                                 const brio_tetrahedron_list *tetrahedra, brio_tetrahedra *out);

#endif
