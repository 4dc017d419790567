/* The inner loops around the conflict test; included by one source file an instruction set, after its
 * batch_in_conflict and lanes_sound, with ENGINE, the name of its table, WALK, ABREAST and FIND_ROWS. See cavity.c for
 * the method.
 *
 * Lists are written always and their length is advanced by a bit, since no branch could be foreseen. */
#include "base/memory.h"
#include "triangulation/inserter.h"
#include <assert.h>

/* Lists the facets of a cavity tetrahedron that leave the cavity found so far. Returns the length of the list. Other
 * threads may hold the tetrahedra behind these facets, but may not destroy or mark them (P1, P3). */
static inline size_t leave(const brio_tetrahedron *tets, const uint8_t *state, uint32_t tet, uint32_t *facet,
                           size_t n) {
    for (int i = 0; i < 4; i++) {
        uint32_t outer = tets[tet].mate[i], other = brio_tet_of(outer);
        __builtin_prefetch(&tets[other]);
        assert(tets[other].mate[brio_slot_of(outer)] == brio_facet_of(tet, i)); /* I3 */
        facet[n] = outer;
        n += state[other] != TET_CAVITY;
    }
    return n;
}

/* Adds the tetrahedra of those facets that are in conflict, each once, and the other facets to the border. Returns
 * false when the thread does not own one of these tetrahedra. */
static inline bool divide(brio_inserter *ins, const uint32_t *facet, size_t count, unsigned conflicts) {
    brio_cavity *c = &ins->cavity;
    const brio_tetrahedra *t = &ins->store->t;
    brio_zone *zone = ins->zone;
    uint32_t *entries = c->entry, *border = c->border;
    uint8_t *state = ins->store->state; /* stores to bytes may alias anything: what is used again stays in locals */
    size_t num_tets = c->num_tets, num_border = c->num_border;
    bool own = true;
    assert(0 < count && count <= BRIO_BATCH && conflicts >> count == 0);
    assert(num_tets + BRIO_BATCH <= c->capacity && num_border + BRIO_BATCH <= 4 * c->capacity); /* brio_cavity_pause */
    unsigned borders = ~conflicts & ((1u << count) - 1);
    for (size_t i = 0; i < BRIO_BATCH; i++) {
        border[num_border] = facet[i];
        num_border += borders >> i & 1;
    }
    for (; conflicts; conflicts &= conflicts - 1) {
        uint32_t entry = facet[__builtin_ctz(conflicts)], tet = brio_tet_of(entry);
        entries[num_tets] = entry;
        if (!brio_owns_beyond(t, zone, entry)) {
            own = false;
            break;
        }
        assert(state[tet] != TET_UNUSED && brio_zone_holds_tet(t, zone, tet)); /* I5, P1 */
        num_tets += state[tet] != TET_CAVITY;
        state[tet] = TET_CAVITY;
    }
    c->num_tets = num_tets;
    c->num_border = num_border;
    return own;
}

static inline __attribute__((always_inline)) brio_status
dig_cavity(brio_inserter *ins, uint32_t first, const double *point, bool *deferred, const bool weighted) {
    brio_cavity *c = &ins->cavity;
    const brio_tetrahedra *t = &ins->store->t;
    const brio_tetrahedron *tets = t->tet; /* a dig moves neither the tetrahedra nor their states */
    uint8_t *state = ins->store->state;
    size_t expanded = 0, tested = 0, listed = 0;
    c->entry[0] = brio_facet_of(first, 0);
    c->num_tets = 1;
    c->num_border = 0;
    c->pause = c->capacity < BRIO_INSERT_WORK ? c->capacity : BRIO_INSERT_WORK;
    assert(c->capacity >= 2 * BRIO_BATCH && brio_zone_holds_tet(t, ins->zone, first)); /* P1 */
    state[first] = TET_CAVITY;
    for (;;) {
        while (expanded < c->num_tets && listed - tested < BRIO_BATCH)
            listed = leave(tets, state, brio_tet_of(c->entry[expanded++]), c->facet, listed);
        size_t count = listed - tested < BRIO_BATCH ? listed - tested : BRIO_BATCH;
        if (count == 0) break;
        assert(listed + 4 <= 4 * c->capacity && tested + BRIO_BATCH <= 4 * c->capacity);
        uint32_t *facet = c->facet + tested;
        for (size_t i = count; i < BRIO_BATCH; i++) facet[i] = facet[0];
        unsigned conflicts = batch_in_conflict(t, &ins->filter, facet, count, point, weighted);
        if (!divide(ins, facet, count, conflicts)) {
            ins->stats.insphere_calls += tested + count;
            brio_cavity_undo(ins);
            *deferred = true;
            return BRIO_OK;
        }
        assert(c->num_border <= tested + count && expanded <= c->num_tets);
        tested += count;
        if (c->num_tets + 2 * BRIO_BATCH <= c->pause) continue;
        brio_status status = brio_cavity_pause(ins);
        if (status != BRIO_OK) return status;
    }
    assert(tested == listed && expanded == c->num_tets && c->num_border >= 4); /* the border is a sphere */
    ins->stats.insphere_calls += tested;
    return BRIO_OK;
}

static unsigned test_batch(const brio_tetrahedra *t, brio_filter *f, const uint32_t facets[BRIO_BATCH], size_t count,
                           const double *p) {
    return batch_in_conflict(t, f, facets, count, p, false);
}

static unsigned test_batch_weighted(const brio_tetrahedra *t, brio_filter *f, const uint32_t facets[BRIO_BATCH],
                                    size_t count, const double *p) {
    return batch_in_conflict(t, f, facets, count, p, true);
}

static brio_status dig(brio_inserter *ins, uint32_t first, uint32_t p, bool *deferred) {
    return dig_cavity(ins, first, ins->store->record[p], deferred, false);
}

static brio_status dig_weighted(brio_inserter *ins, uint32_t first, uint32_t p, bool *deferred) {
    return dig_cavity(ins, first, ins->store->record[p], deferred, true);
}

/* Finds the rows of all first, and calls for them, so that no arithmetic waits. */
static inline __attribute__((always_inline)) uint64_t batch_sound(const brio_tetrahedra *t, const brio_filter *f,
                                                                  const uint32_t *tets, size_t count, double *slack,
                                                                  const bool weighted) {
    star_rows near[BRIO_SOUND_BATCH / LANES];
    uint64_t sound = 0;
    for (size_t i = 0; i < count; i += LANES) {
        star_rows *r = &near[i / LANES];
        FIND_ROWS(t, tets + i, r);
        for (int s = 0; s < 4; s++)
            for (int k = 0; k < LANES; k++) __builtin_prefetch(r->apex[s][k]), __builtin_prefetch(r->vertex[s][k]);
    }
    for (size_t i = 0; i < count; i += LANES)
        sound |= (uint64_t)lanes_sound(&near[i / LANES], f, slack + i, weighted) << i;
    return sound;
}

static uint64_t sound(const brio_tetrahedra *t, const brio_filter *f, const uint32_t *tets, size_t count,
                      double *slack) {
    return batch_sound(t, f, tets, count, slack, false);
}

static uint64_t sound_weighted(const brio_tetrahedra *t, const brio_filter *f, const uint32_t *tets, size_t count,
                               double *slack) {
    return batch_sound(t, f, tets, count, slack, true);
}

const brio_engine ENGINE[2] = {{test_batch, dig, WALK, ABREAST, sound},
                               {test_batch_weighted, dig_weighted, WALK, ABREAST, sound_weighted}};
