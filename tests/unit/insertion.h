/* An insertion for tests, to look at while it goes on. */
#ifndef BRIO_TESTS_INSERTION_H
#define BRIO_TESTS_INSERTION_H

#include "harness.h"
#include "laboratory/laboratory.h"
#include "trial.h"
#include "triangulation/insert.h"
#include "triangulation/start.h"
#include <stddef.h>

/* An inserter whose store has the records in the caller's order and the first tetrahedron, and which locates by the
 * options' strategy; nothing inserted. */
static inline brio_inserter *insertion_begin(brio_context *ctx, const double *points, const double *weights, size_t n,
                                             const trial_options *options) {
    brio_delaunay_options o = trial_library(options);
    const brio_laboratory_options experiment = trial_experiment(options);
    brio_store *store = NULL;
    brio_inserter *ins = NULL;
    brio_laboratory *lab;
    brio_round_ends rounds;
    o.order = BRIO_ORDER_INPUT;
    EXPECT(brio_laboratory_new(ctx, &experiment, &lab) == BRIO_OK);
    if (!o.max_tetrahedra) o.max_tetrahedra = UINT32_C(1) << 30; /* brio_delaunay fills in the defaults, */
    if (!o.seed) o.seed = 1;                                     /* which is left out here */
    EXPECT(brio_store_new(ctx, &(brio_input){points, weights, n}, &o, &rounds, &store) == BRIO_OK);
    EXPECT(brio_start(store) == BRIO_OK && store->dimension > 0);
    EXPECT(brio_inserter_new(store, &ins) == BRIO_OK);
    const struct brio_insertion_part *part = BRIO_PART(ctx, insertion);
    if (part) {
        part->start(part->user, ins, &o, &rounds, 0);
        ins->locator = part->strategy;
        EXPECT(!ins->locator->start || ins->locator->start(ins) == BRIO_OK);
    }
    return ins;
}

/* Frees the inserter, its store and the experiment. */
static inline void insertion_end(brio_inserter *ins) {
    brio_store *store = ins->store;
    char *experiment = (char *)store->ctx->experiment;
    brio_inserter_free(ins);
    brio_store_free(store);
    brio_laboratory_free((brio_laboratory *)(experiment - offsetof(brio_laboratory, experiment)));
}

/* Inserts the records before `end` that are not in yet; `begin` is 0 at first. */
static inline void insert_records(brio_inserter *ins, uint32_t begin, uint32_t end) {
    uint32_t first = (uint32_t)ins->store->dimension + 1;
    for (uint32_t p = begin < first ? first : begin; p < end; p++) {
        brio_insertion outcome = BRIO_DEFERRED;
        EXPECT(brio_insert(ins, p, &outcome) == BRIO_OK && outcome != BRIO_DEFERRED, "record %u", p);
    }
}

/* Whether p is in the closure of a finite tetrahedron, or strictly outside the facet of an infinite one. */
static inline bool tetrahedron_holds(const brio_store *store, uint32_t tet, const double *p) {
    const uint32_t *v = store->t.tet[tet].vertex;
    const brio_record *r = store->t.record;
    if (v[3] == store->t.infinite) return brio_orient3d(r[v[0]], r[v[1]], r[v[2]], p) > 0;
    for (int i = 0; i < 4; i++) {
        const double *corner[4] = {r[v[0]], r[v[1]], r[v[2]], r[v[3]]};
        corner[i] = p;
        if (brio_orient3d(corner[0], corner[1], corner[2], corner[3]) < 0) return false;
    }
    return true;
}

#endif
