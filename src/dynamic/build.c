/* Built anew: from a list of points, as brio_delaunay does it. The canonical order of the tetrahedra, a sixth
 * of its work, is left out where all points move far: they will soon do so again. Else it is worth its time: changes
 * take a seventh more where near tetrahedra are not near in memory.
 *
 * Rows are the records of the insertion, which follow a curve in each of its rounds, so that near points have near
 * rows. */
#include "base/memory.h"
#include "dynamic/live.h"
#include "triangulation/canonical_order.h"
#include "triangulation/inserter.h"
#include <string.h>

brio_status brio_live_list(brio_context *ctx, const brio_dynamic *d, size_t more, brio_live_points *out) {
    brio_live_points list = {0};
    size_t n = d->counts.alive + more;
    brio_status status = BRIO_OK;
    *out = list;
    BRIO_TRY(BRIO_ALLOC(ctx, list.point, 3 * n));
    if (d->weighted) BRIO_TRY(BRIO_ALLOC(ctx, list.weight, n));
    BRIO_TRY(BRIO_ALLOC(ctx, list.name, n));
    for (size_t i = 0; i < d->num_names; i++) {
        if (d->row_of[i] == BRIO_NONE) continue;
        const double *r = d->record[d->row_of[i]];
        memcpy(list.point + 3 * list.count, r, 3 * sizeof *r);
        if (list.weight) list.weight[list.count] = r[3];
        list.name[list.count++] = (uint32_t)i;
    }
    assert(list.count == d->counts.alive);
    *out = list;
    list = (brio_live_points){0};
done:
    brio_live_list_free(ctx, &list);
    return status;
}

void brio_live_list_free(brio_context *ctx, brio_live_points *list) {
    brio_release(ctx, list->point);
    brio_release(ctx, list->weight);
    brio_release(ctx, list->name);
    *list = (brio_live_points){0};
}

/* Adds the records of a store as rows: record r becomes row r + 1. */
static void add_rows(brio_dynamic *d, const brio_store *store, const brio_live_points *list) {
    for (size_t r = 0; r < store->num_points; r++) {
        uint32_t row = brio_live_add_row(d, store->record[r], list->name[store->caller[r]]);
        assert(row == r + 1);
        if (d->dimension == 3 && store->representative[r] == r) d->kind[row] = ROW_VERTEX;
    }
}

/* Brings the tetrahedra of a store into their canonical order, with rows for vertices. */
static brio_status sort_slots(brio_store *store, brio_inserter *ins) {
    size_t finite;
    for (uint32_t r = 0; r < store->num_points; r++) store->caller[r] = r + 1; /* what vertices are named by */
    BRIO_FORWARD(brio_canonical_order(store, store->t.count - ins->num_unused, &finite));
    ins->num_unused = 0;
    ins->walk.start = 0;
    return BRIO_ALLOC_ZERO(store->ctx, store->state, store->t.count);
}

/* Names the vertices of a store's tetrahedra by rows. */
static void name_vertices(brio_store *store) {
    for (size_t slot = 0; slot < store->t.count; slot++) {
        uint32_t *v = store->t.tet[slot].vertex;
        if (store->state[slot] != TET_PLAIN) continue;
        for (int k = 0; k < 3; k++) v[k]++;
        v[3] = v[3] == store->t.infinite ? BRIO_INFINITE : v[3] + 1;
    }
}

/* Takes the tetrahedra of a store, whose records are rows, with their vertices' names.   sorted  brings near ones
 * near to each other first. */
static brio_status take_tetrahedra(brio_dynamic *d, brio_store *store, brio_inserter *ins, bool sorted) {
    if (sorted)
        BRIO_FORWARD(sort_slots(store, ins));
    else
        name_vertices(store);
    size_t count = store->t.count;
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, store->t.tet, count));
    BRIO_FORWARD(BRIO_RESIZE(d->ctx, store->state, count));
    if (d->weighted) BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->hidden, count));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->unused, count));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->until, count));
    if (d->weighted) memset(d->hidden, 0xff, count * sizeof *d->hidden);
    if (ins->num_unused) memcpy(d->unused, ins->unused, ins->num_unused * sizeof *d->unused);
    d->num_unused = ins->num_unused;
    d->t.tet = store->t.tet, d->state = store->state;
    store->t.tet = NULL, store->state = NULL;
    d->t.count = d->capacity = d->unused_capacity = count;
    brio_slack_end_all(d);
    d->walk.start = ins->walk.start;
    for (uint32_t slot = 0; slot < count; slot++) {
        uint32_t *v = d->t.tet[slot].vertex;
        if (d->state[slot] & SLOT_UNUSED) continue;
        bool outside = v[3] == BRIO_INFINITE;
        if (outside) v[3] = 0;
        for (int k = 0; k < 4; k++)
            if (d->home[v[k]] == BRIO_NONE || outside) d->home[v[k]] = slot; /* hull vertices are at home outside */
        d->counts.infinite += outside;
        d->counts.finite += !outside;
    }
    d->counts.vertices = ins->stats.vertices;
    return BRIO_OK;
}

/* Finds the places of the rows that are no vertices. */
static brio_status put_others(brio_dynamic *d, const brio_store *store) {
    for (uint32_t r = 0; r < store->num_points; r++) {
        uint32_t vertex = store->representative[r] + 1, row = r + 1;
        if (vertex == row) continue;
        if (brio_same_position(d->record[row], d->record[vertex])) {
            BRIO_FORWARD(brio_live_join(d, row, vertex));
        } else {
            d->walk.start = d->home[vertex];
            uint32_t tet = d->engine->walk(&d->t, NULL, &d->filter, &d->walk, d->record[row], UINT64_MAX);
            BRIO_FORWARD(brio_live_hide(d, row, tet));
        }
        BRIO_FORWARD(brio_look(d->ctx, 16));
    }
    return BRIO_OK;
}

/* Fills an empty store. */
static brio_status fill(brio_dynamic *d, const brio_live_points *list, size_t num_names, bool sorted) {
    brio_status status = BRIO_OK;
    brio_store *store = NULL;
    brio_inserter *ins = NULL;
    size_t n = list->count;
    BRIO_TRY(brio_delaunay_unordered(d->ctx, &(brio_input){list->point, list->weight, n}, &store, &ins));
    d->dimension = store->dimension;
    BRIO_TRY(brio_live_reserve_rows(d, n));
    BRIO_TRY(brio_live_reserve_names(d, num_names));
    if (num_names) memset(d->row_of, 0xff, num_names * sizeof *d->row_of);
    d->num_names = num_names;
    add_rows(d, store, list);
    if (d->dimension == 3) {
        BRIO_TRY(take_tetrahedra(d, store, ins, sorted));
        brio_live_choose_filter(d);
        BRIO_TRY(put_others(d, store));
    }
    BRIO_TRY(brio_live_refresh_hints(d));
done:
    brio_inserter_free(ins);
    brio_store_free(store);
    return status;
}

brio_status brio_live_build(brio_dynamic *d, const brio_live_points *list, size_t num_names, bool sorted) {
    brio_dynamic *made = NULL, old;
    brio_status status = BRIO_OK;
    assert(!d->in_transaction);
    BRIO_TRY(brio_live_new(d->ctx, d->weighted, &made));
    BRIO_TRY(fill(made, list, num_names, sorted));
    made->in_place = d->in_place;
    made->replaced = d->replaced;
    made->anew = d->anew + 1;
    made->walk.steps += d->walk.steps;
    made->filter.unsettled += d->filter.unsettled;
    old = *d, *d = *made, *made = old;
done:
    brio_dynamic_free(made);
    return status;
}
