/* The ring of tetrahedra round an edge. Its first one in memory speaks for the edge, so that threads which look at
 * different tetrahedra find each edge once. */
#ifndef BRIO_TRIANGULATION_RING_H
#define BRIO_TRIANGULATION_RING_H

#include "triangulation/tetrahedra.h"
#include <assert.h>

/** A place in a ring. The next tetrahedron is behind the facet opposite to `pivot`. */
typedef struct {
    const brio_tetrahedra *t;
    uint32_t tet, pivot, apex, last;
} brio_ring;

/** Returns the ring round the edge from slot i to slot j of `tet`, counterclockwise seen from the far end, at its
 *  second tetrahedron, `tet` being the first. */
static inline brio_ring brio_ring_second(const brio_tetrahedra *t, uint32_t tet, int i, int j) {
    assert(brio_has_tet(t, tet) && 0 <= i && i < 4 && 0 <= j && j < 4 && i != j);
    const brio_tetrahedron *first = &t->tet[tet];
    int k = BRIO_EDGE[i][j][0], l = BRIO_EDGE[i][j][1];
    return (brio_ring){t, brio_tet_of(first->mate[k]), first->vertex[l], brio_apex(t, first->mate[k]),
                       brio_tet_of(first->mate[l])};
}

/** Goes on; false, and no step, from the last one. */
static inline bool brio_ring_next(brio_ring *r) {
    assert(brio_has_tet(r->t, r->tet));
    const uint32_t *v = r->t->tet[r->tet].vertex;
    /* without a branch: any slot is as likely as another */
    int slot = (v[1] == r->pivot) + 2 * (v[2] == r->pivot) + 3 * (v[3] == r->pivot);
    assert(v[slot] == r->pivot); /* the tetrahedra of a ring have the vertices of the facet between them (I3) */
    if (r->tet == r->last) return false;
    uint32_t mate = r->t->tet[r->tet].mate[slot];
    r->tet = brio_tet_of(mate);
    r->pivot = r->apex;
    r->apex = brio_apex(r->t, mate);
    return true;
}

/** Returns whether neither neighbour in the ring comes before `tet`: where one does, the ring need not be walked. */
static inline bool brio_ring_may_lead(const brio_tetrahedra *t, uint32_t tet, int i, int j) {
    assert(brio_has_tet(t, tet) && i != j);
    const uint32_t *mate = t->tet[tet].mate;
    uint32_t one = brio_tet_of(mate[BRIO_EDGE[i][j][0]]), other = brio_tet_of(mate[BRIO_EDGE[i][j][1]]);
    return (one < other ? one : other) > tet;
}

/** Returns the number of tetrahedra in the ring when `tet` is the first of them in memory, else 0. */
static inline size_t brio_ring_size(const brio_tetrahedra *t, uint32_t tet, int i, int j) {
    size_t size = 2;
    if (!brio_ring_may_lead(t, tet, i, j)) return 0;
    for (brio_ring r = brio_ring_second(t, tet, i, j); brio_ring_next(&r); size++) {
        assert(size <= t->count); /* the ring comes back to its first tetrahedron */
        if (r.tet < tet) return 0;
    }
    return size;
}

/** Calls for the neighbours of a tetrahedron, where walks begin. */
static inline void brio_ring_fetch(const brio_tetrahedra *t, size_t tet) {
    for (int i = 0; i < 4; i++) __builtin_prefetch(&t->tet[brio_tet_of(t->tet[tet].mate[i])]);
}

#endif
