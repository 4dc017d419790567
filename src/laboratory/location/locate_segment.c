/* Point location by a walk along a segment whose start has a known tetrahedron.
 *
 * A visibility walk steps across a facet that has the segment's end strictly on its far side. Among such facets this
 * walk takes one that the line of the segment meets, borders included. A tetrahedron that touches the segment has such
 * a facet, at the last point of their intersection, and the next tetrahedron touches the segment at that point. So the
 * walk visits only tetrahedra that touch the segment, even where the segment runs through vertices and edges. The walk
 * ends, as every visibility walk in a regular triangulation does. A segment that starts outside the hull has no
 * tetrahedra there. Then the walk begins next to the hull facet that the start sees, and is an ordinary visibility
 * walk until it meets the line.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#include "laboratory/location/locate_segment.h"
#include <assert.h>

/* Returns whether the line through u and w meets the closed triangle of a facet; w is off the facet's plane. */
static bool line_meets(brio_inserter *ins, const uint32_t *v, int slot, const double *u, const double *w) {
    const brio_store *s = ins->store;
    unsigned sides = 0;
    for (int i = 0; i < 3; i++) {
        const double *a = s->t.record[v[BRIO_FACET[slot][i]]], *b = s->t.record[v[BRIO_FACET[slot][(i + 1) % 3]]];
        int side = brio_orient3d_sign(&ins->filter, u, w, a, b);
        sides |= side > 0 ? 1u : side < 0 ? 2u : 0u;
    }
    return sides != 3;
}

/* Returns, as bits, the slots of the facets that have w strictly on their far side. */
static unsigned facets_before(brio_inserter *ins, const uint32_t *v, int came_through, const double *w) {
    const brio_record *r = ins->store->t.record;
    unsigned before = 0;
    for (int i = 0; i < 4; i++) {
        if (i == came_through) continue;
        const uint8_t *facet = BRIO_FACET[i];
        bool beyond = brio_orient3d_sign(&ins->filter, r[v[facet[0]]], r[v[facet[1]]], r[v[facet[2]]], w) < 0;
        before |= (unsigned)beyond << i;
    }
    return before;
}

/* Returns the slot of the facet to cross, out of `before`. */
static int facet_ahead(brio_inserter *ins, const uint32_t *v, unsigned before, const double *u, const double *w) {
    assert(before != 0 && before >> 4 == 0);
    int any = __builtin_ctz(before);
    if ((before & (before - 1)) == 0) return any;
    for (; before; before &= before - 1)
        if (line_meets(ins, v, __builtin_ctz(before), u, w)) return __builtin_ctz(before);
    return any;
}

uint32_t brio_locate_segment(brio_inserter *ins, uint32_t tet, const double *u, const double *w, uint64_t *entered) {
    const brio_store *s = ins->store;
    int came_through = 4;
    if (brio_is_infinite(&s->t, tet)) tet = brio_tet_of(s->t.tet[tet].mate[3]);
    for (;; ++*entered) {
        assert(s->state[tet] == TET_PLAIN);
        const uint32_t *v = s->t.tet[tet].vertex;
        if (v[3] == s->t.infinite) return tet;
        unsigned before = facets_before(ins, v, came_through, w);
        if (!before) return tet;
        uint32_t mate = s->t.tet[tet].mate[facet_ahead(ins, v, before, u, w)];
        tet = brio_tet_of(mate);
        came_through = brio_slot_of(mate);
    }
}
