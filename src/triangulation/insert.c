/* Incremental insertion: locate, dig the cavity, fill the cavity. */
#include "triangulation/insert.h"
#include "triangulation/zone.h"
#include <assert.h>

/* Returns the vertex of a finite tetrahedron at the position of p, or the infinite vertex. */
static uint32_t vertex_at(const brio_store *s, uint32_t tet, const double *p) {
    assert(s->t.tet[tet].vertex[3] != s->t.infinite);
    const uint32_t *v = s->t.tet[tet].vertex;
    for (int i = 0; i < 4; i++)
        if (brio_same_position(s->record[v[i]], p)) return v[i];
    return s->t.infinite;
}

/* Returns whether p, coincident with vertex v, adds nothing: of equal weights the lower index keeps the name. */
static bool absorbed(brio_store *s, uint32_t p, uint32_t v) {
    assert(s->representative[p] == p && s->representative[v] == v); /* I7: p is not in yet, and v is a vertex */
    double wp = s->record[p][3], wv = s->record[v][3];
    if (s->weighted && wp > wv) return false;
    if ((!s->weighted || wp == wv) && s->caller[p] < s->caller[v]) {
        uint32_t swap = s->caller[p];
        s->caller[p] = s->caller[v], s->caller[v] = swap;
    }
    s->representative[p] = v;
    return true;
}

/* Returns what becomes of record p, which a tetrahedron holds or conflicts with. */
static brio_insertion judge(brio_inserter *ins, uint32_t p, uint32_t tet) {
    brio_store *s = ins->store;
    assert(p < s->num_points && brio_has_tet(&s->t, tet));
    const double *point = s->record[p];
    if (!brio_is_infinite(&s->t, tet)) {
        uint32_t v = vertex_at(s, tet, point);
        /* v's name may change. The thread holds v, a vertex of a tetrahedron that it holds, so it alone renames v
         * (P4). */
        assert(v == s->t.infinite || !ins->zone || brio_zone_holds(ins->zone, v)); /* P4 */
        if (v != s->t.infinite && absorbed(s, p, v)) return BRIO_ABSORBED;
        if (s->weighted && !brio_in_conflict(&s->t, &ins->filter, tet, point, true)) {
            assert(!ins->zone || brio_zone_holds(ins->zone, p)); /* P4 */
            s->representative[p] = s->t.tet[tet].vertex[0];
            ins->walk.start = tet;
            return BRIO_HIDDEN;
        }
    }
    return brio_owns(&s->t, ins->zone, tet) ? BRIO_INSERTED : BRIO_DEFERRED;
}

/* Announces what the next insertions will read: they go to where this point is, and take fresh slots and points in
 * sequence. */
static void expect_neighbours(brio_inserter *ins, uint32_t p) {
    enum { SOON = 512 };
    const brio_cavity *c = &ins->cavity;
    const brio_store *s = ins->store;
    size_t fresh = ins->zone ? ins->next_slot : s->t.count, end = ins->zone ? ins->end_slot : s->capacity;
    if (p + SOON < s->num_points) brio_expect(&ins->read_ahead, s->record[p + SOON]);
    if (fresh + SOON < end) brio_expect(&ins->read_ahead, &s->t.tet[fresh + SOON]);
    for (size_t i = 0; i < c->num_created; i++) {
        const brio_tetrahedron *t = &s->t.tet[c->created[i]];
        brio_expect(&ins->read_ahead, &s->t.tet[brio_tet_of(t->mate[0])]);
        brio_expect(&ins->read_ahead, s->record[t->vertex[1]]);
    }
}

/* Times one location in TIMED and scales the sum by TIMED: reading the clock costs as much as a step of a walk. */
static brio_status locate(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    enum { TIMED = 64 };
    if (p % TIMED) return ins->locator->locate(ins, p, tet);
    double start = brio_seconds();
    brio_status status = ins->locator->locate(ins, p, tet);
    ins->stats.locate_seconds += TIMED * (brio_seconds() - start);
    return status;
}

brio_status brio_insert(brio_inserter *ins, uint32_t p, brio_insertion *outcome) {
    uint32_t tet = BRIO_NO_TET;
    bool deferred = false;
    brio_status status = BRIO_OK;
    assert(ins->zone || ins->store->state[ins->walk.start] == TET_PLAIN);     /* N1 */
    assert(p < ins->store->num_points && ins->store->representative[p] == p); /* I7: p is not in yet */
    BRIO_TRY(locate(ins, p, &tet));
    *outcome = tet == BRIO_NO_TET ? BRIO_DEFERRED : judge(ins, p, tet);
    if (*outcome != BRIO_INSERTED) return BRIO_OK;
    assert(ins->store->state[tet] == TET_PLAIN && brio_zone_holds_tet(&ins->store->t, ins->zone, tet)); /* I5, P1 */
    BRIO_TRY(ins->engine->dig(ins, tet, p, &deferred));
    if (!deferred) BRIO_TRY(brio_cavity_fill(ins, p, &deferred));
    if (deferred) {
        *outcome = BRIO_DEFERRED;
        return BRIO_OK;
    }
    assert(ins->store->state[ins->walk.start] == TET_PLAIN); /* N1 */
    if (ins->goes_on) expect_neighbours(ins, p);
    if (ins->locator->filled) status = ins->locator->filled(ins, p);
done:
    return status;
}
