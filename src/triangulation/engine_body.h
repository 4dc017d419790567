/* The inner loops around the conflict test; included by one source file an instruction set, after its
 * batch_in_conflict. See cavity.c for the method.
 *
 * Lists are written always and their length is advanced by a bit, since no branch could be foreseen. */
#include "base/memory.h"
#include "triangulation/kernel.h"

/* Lists the facets of a cavity tetrahedron that leave the cavity as it is; their number afterwards. */
static inline size_t leave(const brio_kernel *k, uint32_t tet, uint32_t *facet, size_t n) {
    const brio_tetrahedron *tets = k->t.tet;
    const uint8_t *state = k->state;
    for (int i = 0; i < 4; i++) {
        uint32_t outer = tets[tet].mate[i], other = brio_tet_of(outer);
        __builtin_prefetch(&tets[other]);
        facet[n] = outer;
        n += state[other] != TET_CAVITY;
    }
    return n;
}

/* Adds the tetrahedra of those facets that are in conflict, each once, and the other facets to the border. False when
 * one of them is not the thread's own. */
static inline bool divide(brio_kernel *k, const uint32_t *facet, size_t count, unsigned conflicts) {
    brio_cavity *c = &k->cavity;
    uint32_t *entries = c->entry, *border = c->border;
    uint8_t *state = k->state; /* stores to bytes may alias anything: what is used again stays in locals */
    size_t num_tets = c->num_tets, num_border = c->num_border;
    bool own = true;
    unsigned borders = ~conflicts & ((1u << count) - 1);
    for (size_t i = 0; i < BRIO_BATCH; i++) {
        border[num_border] = facet[i];
        num_border += borders >> i & 1;
    }
    for (; conflicts; conflicts &= conflicts - 1) {
        uint32_t entry = facet[__builtin_ctz(conflicts)], tet = brio_tet_of(entry);
        entries[num_tets] = entry;
        if (!brio_owns_beyond(&k->t, entry)) {
            own = false;
            break;
        }
        num_tets += state[tet] != TET_CAVITY;
        state[tet] = TET_CAVITY;
    }
    c->num_tets = num_tets;
    c->num_border = num_border;
    return own;
}

static inline __attribute__((always_inline)) brio_status dig_cavity(brio_kernel *k, uint32_t first, const double *point,
                                                                    const bool weighted) {
    brio_cavity *c = &k->cavity;
    size_t expanded = 0, tested = 0, listed = 0;
    c->entry[0] = brio_facet_of(first, 0);
    c->num_tets = 1;
    c->num_border = 0;
    c->pause = c->capacity < BRIO_INSERT_WORK ? c->capacity : BRIO_INSERT_WORK;
    k->state[first] = TET_CAVITY;
    for (;;) {
        while (expanded < c->num_tets && listed - tested < BRIO_BATCH)
            listed = leave(k, brio_tet_of(c->entry[expanded++]), c->facet, listed);
        size_t count = listed - tested < BRIO_BATCH ? listed - tested : BRIO_BATCH;
        if (count == 0) break;
        uint32_t *facet = c->facet + tested;
        for (size_t i = count; i < BRIO_BATCH; i++) facet[i] = facet[0];
        unsigned conflicts = batch_in_conflict(&k->t, &k->filter, facet, count, point, weighted);
        if (!divide(k, facet, count, conflicts)) return brio_cavity_defer(k);
        tested += count;
        if (c->num_tets + 2 * BRIO_BATCH <= c->pause) continue;
        brio_status status = brio_cavity_pause(k);
        if (status != BRIO_OK) return status;
    }
    k->stats.insphere_calls += tested;
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

static brio_status dig(brio_kernel *k, uint32_t first, uint32_t p) {
    return dig_cavity(k, first, k->record[p], false);
}

static brio_status dig_weighted(brio_kernel *k, uint32_t first, uint32_t p) {
    return dig_cavity(k, first, k->record[p], true);
}

const brio_engine ENGINE[2] = {{test_batch, dig, walk}, {test_batch_weighted, dig_weighted, walk}};
