/* A kernel of its own for tests, to look at while it works. */
#ifndef BRIO_TESTS_KERNEL_H
#define BRIO_TESTS_KERNEL_H

#include "harness.h"
#include "triangulation/kernel.h"
#include "triangulation/triangulation.h"

/* Records in the caller's order, with the first tetrahedron, located by the options' strategy; nothing inserted. */
static inline void kernel_begin(brio_kernel *k, brio_context *ctx, const double *points, const double *weights,
                                size_t n, const brio_delaunay_options *options) {
    *k = (brio_kernel){.ctx = ctx, .num_points = n, .weighted = weights != NULL};
    k->engine = brio_engine_choose(k->weighted);
    k->locator = brio_locator_choose(options->locate);
    k->max_tetrahedra = options->max_tetrahedra;
    k->t.infinite = (uint32_t)n + 2;
    EXPECT(brio_records_new(ctx, points, weights, n, NULL, 3, &k->record) == BRIO_OK);
    k->record[n + 2][3] = INFINITY;
    k->t.record = k->record;
    k->caller = brio_resize(ctx, NULL, n, sizeof *k->caller, &(brio_status){BRIO_OK});
    for (uint32_t i = 0; i < n; i++) k->caller[i] = i;
    EXPECT(brio_kernel_workspace(k) == BRIO_OK);
    EXPECT(brio_kernel_start(k) == BRIO_OK && k->dimension > 0);
    if (k->locator->start) EXPECT(k->locator->start(k, options) == BRIO_OK);
}

/* Inserts the records before `end` that are not in yet; `begin` is 0 at first. */
static inline void kernel_insert(brio_kernel *k, uint32_t begin, uint32_t end) {
    if (begin <= (uint32_t)k->dimension) begin = (uint32_t)k->dimension + 1;
    for (uint32_t p = begin; p < end; p++) EXPECT(brio_kernel_insert(k, p) == BRIO_OK, "record %u", p);
}

/* Whether p is in the closure of a finite tetrahedron, or strictly outside the facet of an infinite one. */
static inline bool kernel_holds(brio_kernel *k, uint32_t tet, const double *p) {
    const uint32_t *v = k->t.tet[tet].vertex;
    const brio_record *r = k->t.record;
    if (v[3] == k->t.infinite) return brio_orient3d(r[v[0]], r[v[1]], r[v[2]], p) > 0;
    for (int i = 0; i < 4; i++) {
        const double *corner[4] = {r[v[0]], r[v[1]], r[v[2]], r[v[3]]};
        corner[i] = p;
        if (brio_orient3d(corner[0], corner[1], corner[2], corner[3]) < 0) return false;
    }
    return true;
}

#endif
