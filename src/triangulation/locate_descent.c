/* Point location by descent along edges to the nearest vertex.
 *
 * Samples of a smooth surface have stacks of thin tetrahedra between sheets, and a walk to a near point crosses
 * hundreds of them. But the nearest vertex is a Delaunay neighbour of the new point, so some tetrahedron round that
 * vertex is in conflict. The search starts at the star of the last inserted vertex. It goes to the vertex nearest to
 * the point, tests that vertex's star, and goes on to a nearer vertex while no tetrahedron conflicts. If the descent
 * ends without a conflict (hidden points), a walk starts from the nearest vertex.
 *
 * Based on: the nearest-neighbour graph is a part of the Delaunay triangulation; Birn, Holtgrewe, Sanders, Singler.
 * Simple and fast nearest neighbor search. ALENEX 2010, for the descent. */
#include "triangulation/locate_descent.h"
#include "base/memory.h"
#include <assert.h>

enum { MOST_OF_STAR = 512 }; /* tetrahedra to test round one vertex; chosen, bounds the cost at the apex of a cone */

typedef struct {
    uint32_t vertex, tet; /* a vertex and a tetrahedron that has it */
    double square;        /* its squared distance from the point */
} candidate;

static inline void offer(const brio_tetrahedra *t, candidate *best, uint32_t tet, const double *p) {
    assert(brio_has_tet(t, tet));
    for (size_t i = 0; i < 4; i++) {
        uint32_t v = t->tet[tet].vertex[i];
        if (v == t->infinite) continue;
        double x = t->record[v][0] - p[0], y = t->record[v][1] - p[1], z = t->record[v][2] - p[2];
        double square = x * x + y * y + z * z;
        if (square < best->square) *best = (candidate){v, tet, square};
    }
}

/* Returns the first of some tetrahedra that is in conflict with p, or BRIO_NO_TET. */
static uint32_t first_conflict(brio_inserter *ins, const uint32_t *tets, size_t count, const double *p) {
    for (size_t n = 0; n < count; n += BRIO_BATCH) {
        size_t size = count - n < BRIO_BATCH ? count - n : BRIO_BATCH;
        uint32_t facet[BRIO_BATCH];
        for (size_t i = 0; i < BRIO_BATCH; i++) facet[i] = brio_facet_of(tets[i < size ? n + i : n], 0);
        assert(size > 0);
        unsigned mask = ins->engine->conflicts(&ins->store->t, &ins->filter, facet, size, p);
        ins->stats.insphere_calls += size;
        assert(mask >> size == 0);
        if (mask) return tets[n + (size_t)__builtin_ctz(mask)];
    }
    return BRIO_NO_TET;
}

/* Collects the tetrahedra of the last inserted vertex's star that also have vertex v; this star is still in the
 * caches. */
static brio_status collect_last(brio_inserter *ins, uint32_t v) {
    const brio_store *s = ins->store;
    brio_star *star = &ins->star;
    brio_status status = BRIO_RESERVE(s->ctx, star->tet, star->capacity, ins->cavity.num_created);
    if (status != BRIO_OK) return status;
    star->size = 0;
    for (size_t b = 0; b < ins->cavity.num_created; b++) {
        uint32_t tet = ins->cavity.created[b];
        assert(s->state[tet] == TET_PLAIN); /* N2 */
        star->tet[star->size] = tet;
        star->size += brio_slot_of_vertex(s->t.tet[tet].vertex, v) < 4;
    }
    return BRIO_OK;
}

brio_status brio_locate_descent(brio_inserter *ins, const double *p, uint32_t *tet) {
    const brio_store *s = ins->store;
    candidate best = {s->t.infinite, BRIO_NO_TET, INFINITY};
    ins->star.mark = s->state; /* 0 for every tetrahedron, since no insertion is under way (I5) */
    ins->star.zone = ins->zone;
    assert(s->state[ins->walk.start] == TET_PLAIN); /* N1, I5 */
    offer(&s->t, &best, ins->walk.start, p);
    for (size_t b = 0; b < ins->cavity.num_created; b++) offer(&s->t, &best, ins->cavity.created[b], p);
    if (best.square > 0 && best.vertex != s->t.infinite) {
        brio_status status = collect_last(ins, best.vertex);
        if (status != BRIO_OK) return status;
        *tet = first_conflict(ins, ins->star.tet, ins->star.size, p);
        if (*tet != BRIO_NO_TET) return BRIO_OK;
    }
    for (uint32_t from = s->t.infinite; best.vertex != from && best.square > 0;) {
        from = best.vertex;
        brio_status status = brio_star_collect(s->ctx, &s->t, from, best.tet, MOST_OF_STAR, &ins->star);
        if (status != BRIO_OK) return status;
        for (size_t n = 0; n < ins->star.size; n++) {
            if (ins->walk.watch) ins->walk.watch->came_to(ins->walk.watch, &s->t, ins->star.tet[n]);
            offer(&s->t, &best, ins->star.tet[n], p);
        }
        ins->walk.steps++;
        if (best.square == 0) break;
        *tet = first_conflict(ins, ins->star.tet, ins->star.size, p);
        if (*tet != BRIO_NO_TET) return BRIO_OK;
    }
    if (best.tet != BRIO_NO_TET) ins->walk.start = best.tet;
    *tet = brio_inserter_walk(ins, p, UINT64_MAX);
    return BRIO_OK;
}
