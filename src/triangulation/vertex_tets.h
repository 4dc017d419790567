/* A tetrahedron of each vertex, which the kernel itself does not keep. */
#ifndef BRIO_TRIANGULATION_VERTEX_TETS_H
#define BRIO_TRIANGULATION_VERTEX_TETS_H

#include "base/vector.h"
#include "triangulation/kernel.h"

/** vertex_tet[v] = a tetrahedron of v, for all vertices, the infinite one included; others are left as they are. */
static inline void brio_vertex_tets_fill(const brio_kernel *k, uint32_t *vertex_tet) {
    for (size_t t = 0; t < k->t.count; t++)
        if (k->state[t] == TET_PLAIN)
            for (int i = 0; i < 4; i++) vertex_tet[k->t.tet[t].vertex[i]] = (uint32_t)t;
}

/** The same after one insertion: only the vertices of the new star can have lost their tetrahedron. */
static inline void brio_vertex_tets_filled(const brio_kernel *k, uint32_t *vertex_tet) {
    for (size_t b = 0; b < k->cavity.num_created; b++)
        for (int i = 0; i < 4; i++) vertex_tet[k->t.tet[k->cavity.created[b]].vertex[i]] = k->cavity.created[b];
}

#endif
