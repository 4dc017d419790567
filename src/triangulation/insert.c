/* Incremental insertion: locate, dig the cavity, fill the cavity. */
#include "base/memory.h"
#include "triangulation/kernel.h"
#include <math.h>

brio_status brio_kernel_reserve(brio_kernel *k, size_t more) {
    brio_status status = BRIO_OK;
    size_t need = k->t.count + more;
    if (need <= k->capacity) return BRIO_OK;
    if (k->pass) return brio_pass_reserve(k, more);
    size_t capacity = need + need / 8 + 1024;
    BRIO_REQUIRE(k->ctx, need <= k->max_tetrahedra, BRIO_ERR_TOO_LARGE, "more than %zu tetrahedra", k->max_tetrahedra);
    if (capacity > k->max_tetrahedra) capacity = k->max_tetrahedra;
    BRIO_TRY(BRIO_RESIZE(k->ctx, k->t.tet, capacity));
    BRIO_TRY(BRIO_RESIZE(k->ctx, k->state, capacity));
    k->capacity = capacity;
done:
    return status;
}

/* The vertex of a finite tetrahedron at the position of p, or the infinite vertex. */
static uint32_t vertex_at(const brio_kernel *k, uint32_t tet, const double *p) {
    const uint32_t *v = k->t.tet[tet].vertex;
    for (int i = 0; i < 4; i++)
        if (brio_same_position(k->record[v[i]], p)) return v[i];
    return k->t.infinite;
}

/* Whether p, coincident with vertex v, adds nothing: of equal weights the lower index keeps the name. */
static bool absorbed(brio_kernel *k, uint32_t p, uint32_t v) {
    double wp = k->record[p][3], wv = k->record[v][3];
    if (k->weighted && wp > wv) return false;
    if ((!k->weighted || wp == wv) && k->caller[p] < k->caller[v]) {
        uint32_t swap = k->caller[p];
        k->caller[p] = k->caller[v], k->caller[v] = swap;
    }
    k->representative[p] = v;
    return true;
}

/* Around a point is where the next ones go; fresh slots are taken in sequence, and so are the points. */
static void expect_neighbours(brio_kernel *k, uint32_t p) {
    enum { SOON = 512 };
    const brio_cavity *c = &k->cavity;
    k->read_ahead.now++;
    if (p + SOON < k->num_points) brio_expect(&k->read_ahead, k->record[p + SOON]);
    if (k->t.count + SOON < k->capacity) brio_expect(&k->read_ahead, &k->t.tet[k->t.count + SOON]);
    for (size_t i = 0; i < c->num_created; i++) {
        const brio_tetrahedron *t = &k->t.tet[c->created[i]];
        brio_expect(&k->read_ahead, &k->t.tet[brio_tet_of(t->mate[0])]);
        brio_expect(&k->read_ahead, k->record[t->vertex[1]]);
    }
}

/* Every so manieth location is timed and stands for the others: a clock costs as much as a walk step. */
static brio_status locate(brio_kernel *k, uint32_t p, uint32_t *tet) {
    enum { TIMED = 64 };
    if (p % TIMED) return k->locator->locate(k, p, tet);
    double start = brio_seconds();
    brio_status status = k->locator->locate(k, p, tet);
    k->stats.locate_seconds += TIMED * (brio_seconds() - start);
    return status;
}

brio_status brio_kernel_report(brio_kernel *k, double done) {
    k->done = fmax(k->done, done); /* a second try of deferred points does not step back */
    k->report_at = brio_kernel_work(k) + BRIO_INSERT_WORK;
    return k->reports ? brio_progress(k->ctx, "insert", k->done) : BRIO_OK;
}

brio_status brio_kernel_insert(brio_kernel *k, uint32_t p) {
    const double *point = k->record[p];
    uint32_t tet;
    brio_status located = locate(k, p, &tet);
    if (located != BRIO_OK) return located;
    if (!brio_is_infinite(&k->t, tet)) {
        uint32_t v = vertex_at(k, tet, point);
        /* v's name may change: no other thread may absorb a point into v meanwhile */
        if (v != k->t.infinite && k->t.zone && !brio_zone_has(k->t.zone, v)) return BRIO_DEFERRED;
        if (v != k->t.infinite && absorbed(k, p, v)) return BRIO_OK;
        if (k->weighted && !brio_in_conflict(&k->t, &k->filter, tet, point, true)) {
            k->representative[p] = k->t.tet[tet].vertex[0];
            k->walk.start = tet;
            return BRIO_OK;
        }
    }
    if (!brio_owns(&k->t, tet)) return BRIO_DEFERRED;
    brio_status status = k->engine->dig(k, tet, p);
    if (status == BRIO_OK) status = brio_cavity_fill(k, p);
    if (status == BRIO_OK && k->goes_on) expect_neighbours(k, p);
    return status == BRIO_OK && k->locator->filled ? k->locator->filled(k, p) : status;
}
