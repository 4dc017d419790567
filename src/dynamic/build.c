/* Built anew: from a list of points, by brio_delaunay.
 *
 * Rows are numbered as the tetrahedra of the result name them. These are sorted along the curve of the insertion, so
 * that near points have near rows. */
#include "base/memory.h"
#include "dynamic/live.h"
#include "triangulation/triangulation.h"
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

static uint32_t add(brio_dynamic *d, const brio_live_points *list, size_t i) {
    double record[4];
    for (int c = 0; c < 3; c++) record[c] = list->point[3 * i + (size_t)c] + 0.0;
    record[3] = list->weight ? list->weight[i] + 0.0 : 0;
    return brio_live_add_row(d, record, list->name[i]);
}

/* Takes the tetrahedra of a result, whose vertices become rows. */
static brio_status take_tetrahedra(brio_dynamic *d, brio_triangulation *t, const brio_live_points *list,
                                   uint32_t *row) {
    enum { AHEAD = 8 };
    size_t count = t->stats.tetrahedra + t->stats.hull_facets;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(d->ctx, d->state, count));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->hidden, count));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->unused, count));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->until, count));
    memset(d->hidden, 0xff, count * sizeof *d->hidden);
    d->t.tet = t->tet;
    d->t.count = d->capacity = d->unused_capacity = count;
    brio_slack_end_all(d);
    t->tet = NULL;
    for (uint32_t slot = 0; slot < count; slot++) {
        uint32_t *v = d->t.tet[slot].vertex;
        if (slot + AHEAD < count)
            for (int k = 0; k < 3; k++) __builtin_prefetch(&row[d->t.tet[slot + AHEAD].vertex[k]]);
        bool infinite = v[3] == BRIO_INFINITE;
        for (int k = 0; k < 4 - infinite; k++) {
            uint32_t r = row[v[k]];
            bool fresh = r == BRIO_NONE;
            if (fresh) r = row[v[k]] = add(d, list, v[k]);
            if (fresh) d->kind[r] = ROW_VERTEX;
            if (fresh || infinite) d->home[r] = slot; /* vertices of the hull are at home outside */
            v[k] = r;
        }
        if (infinite) v[3] = 0;
    }
    d->counts.vertices = t->stats.vertices;
    d->counts.finite = t->stats.tetrahedra;
    d->counts.infinite = t->stats.hull_facets;
    return BRIO_OK;
}

/* Finds the places of the points that are no vertices. */
static brio_status put_others(brio_dynamic *d, const brio_triangulation *t, const brio_live_points *list,
                              uint32_t *row) {
    for (size_t i = 0; i < list->count; i++) {
        uint32_t vertex = row[t->representative[i]], r;
        if (t->representative[i] == i) continue;
        r = row[i] = add(d, list, i);
        if (brio_same_position(d->record[r], d->record[vertex])) {
            BRIO_FORWARD(brio_live_join(d, r, vertex));
        } else {
            d->walk.start = d->home[vertex];
            uint32_t tet = d->engine->walk(&d->t, NULL, &d->filter, &d->walk, d->record[r], UINT64_MAX);
            BRIO_FORWARD(brio_live_hide(d, r, tet));
        }
        BRIO_FORWARD(brio_look(d->ctx, 16));
    }
    return BRIO_OK;
}

/* Fills an empty store. */
static brio_status fill(brio_dynamic *d, const brio_live_points *list, size_t num_names) {
    brio_status status = BRIO_OK;
    brio_triangulation *t = NULL;
    uint32_t *row = NULL;
    size_t n = list->count;
    BRIO_TRY(brio_delaunay(d->ctx, list->point, list->weight, n, NULL, &t));
    d->dimension = t->stats.dimension;
    BRIO_TRY(brio_live_reserve_rows(d, n));
    BRIO_TRY(brio_live_reserve_names(d, num_names));
    if (num_names) memset(d->row_of, 0xff, num_names * sizeof *d->row_of);
    d->num_names = num_names;
    BRIO_TRY(BRIO_ALLOC(d->ctx, row, n));
    memset(row, 0xff, n * sizeof *row);
    if (d->dimension == 3) {
        BRIO_TRY(take_tetrahedra(d, t, list, row));
        assert(d->num_rows == d->counts.vertices + 1);
    } else {
        for (size_t i = 0; i < n; i++) row[i] = add(d, list, i);
    }
    if (d->dimension == 3) {
        for (size_t i = 0; i < n; i++) { /* the box is that of all points */
            double record[4] = {list->point[3 * i], list->point[3 * i + 1], list->point[3 * i + 2],
                                list->weight ? list->weight[i] : 0};
            if (i == 0) brio_live_choose_filter(d);
            if (t->representative[i] != i) brio_live_admit(d, record);
        }
        BRIO_TRY(put_others(d, t, list, row));
        d->walk.start = 0;
    }
    BRIO_TRY(brio_live_refresh_hints(d));
done:
    brio_triangulation_free(t);
    brio_release(d->ctx, row);
    return status;
}

brio_status brio_live_build(brio_dynamic *d, const brio_live_points *list, size_t num_names) {
    brio_dynamic *made = NULL, old;
    brio_status status = BRIO_OK;
    assert(!d->in_transaction);
    BRIO_TRY(brio_live_new(d->ctx, d->weighted, &made));
    BRIO_TRY(fill(made, list, num_names));
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
