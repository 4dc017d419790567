/* A tetrahedron of each vertex, which the store itself does not keep. */
#ifndef BRIO_TRIANGULATION_VERTEX_TETS_H
#define BRIO_TRIANGULATION_VERTEX_TETS_H

#include "base/vector.h"
#include "triangulation/inserter.h"

/** Sets vertex_tet[v] to a tetrahedron of v, for all vertices, the infinite one included. Leaves the other entries
 *  unchanged. */
static inline void brio_vertex_tets_fill(const brio_store *s, uint32_t *vertex_tet) {
    for (size_t t = 0; t < s->t.count; t++)
        if (s->state[t] == TET_PLAIN)
            for (int i = 0; i < 4; i++) vertex_tet[s->t.tet[t].vertex[i]] = (uint32_t)t;
}

/** Updates vertex_tet after one insertion: only the vertices of the new star can have lost their tetrahedron. */
static inline void brio_vertex_tets_filled(const brio_inserter *ins, uint32_t *vertex_tet) {
    const brio_tetrahedron *tets = ins->store->t.tet;
    const brio_cavity *c = &ins->cavity;
    for (size_t b = 0; b < c->num_created; b++)
        for (int i = 0; i < 4; i++) vertex_tet[tets[c->created[b]].vertex[i]] = c->created[b];
}

#endif
