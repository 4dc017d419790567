/* What is asked of a living triangulation between its changes: facts, points, neighbours, location, a snapshot, the
 * exact check. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "dynamic/live.h"
#include "triangulation/triangulation.h"
#include <string.h>

brio_status brio_dynamic_facts(const brio_dynamic *d, brio_dynamic_stats *stats) {
    BRIO_DOOR;
    BRIO_FORWARD(BRIO_CHECK_RESULT(d->ctx, brio_dynamic_stats, stats));
    brio_dynamic_stats mine = {
        .size = sizeof mine,
        .indices = d->num_names,
        .points = d->counts.alive,
        .vertices = d->counts.vertices,
        .tetrahedra = d->counts.finite,
        .hull_facets = d->counts.infinite,
        .dimension = d->dimension,
        .in_place = d->in_place,
        .replaced = d->replaced,
        .anew = d->anew,
        .walk_steps = d->walk.steps,
        .exact_calls = d->filter.unsettled,
    };
    BRIO_GIVE(brio_dynamic_stats, stats, &mine);
    return BRIO_OK;
}

brio_dynamic_state brio_dynamic_point(const brio_dynamic *d, uint32_t index, double record[4]) {
    BRIO_DOOR;
    static const brio_dynamic_state OF_KIND[] = {BRIO_DYNAMIC_NONE, BRIO_DYNAMIC_VERTEX, BRIO_DYNAMIC_HIDDEN,
                                                 BRIO_DYNAMIC_DUPLICATE, BRIO_DYNAMIC_FLAT};
    if (index >= d->num_names || d->row_of[index] == BRIO_NONE) return BRIO_DYNAMIC_NONE;
    uint32_t row = d->row_of[index];
    if (record) memcpy(record, d->record[row], sizeof(brio_record));
    return OF_KIND[brio_row_kind(d, row)];
}

void brio_dynamic_points(const brio_dynamic *d, uint32_t *indices, double *points, double *weights) {
    BRIO_DOOR;
    size_t n = 0;
    for (size_t i = 0; i < d->num_names; i++) {
        if (d->row_of[i] == BRIO_NONE) continue;
        const double *r = d->record[d->row_of[i]];
        if (indices) indices[n] = (uint32_t)i;
        if (points) memcpy(points + 3 * n, r, 3 * sizeof *r);
        if (weights) weights[n] = r[3];
        n++;
    }
}

brio_status brio_dynamic_neighbours(brio_dynamic *d, uint32_t index, const uint32_t **neighbours, size_t *count) {
    BRIO_DOOR;
    brio_hole *h = &d->hole;
    *neighbours = h->outer;
    *count = 0;
    BRIO_EXPECT(d->ctx, index < d->num_names && d->row_of[index] != BRIO_NONE, BRIO_ERR_ARGUMENT,
                "there is no point %u", index);
    uint32_t row = d->row_of[index];
    if (brio_row_kind(d, row) != ROW_VERTEX) return BRIO_OK;
    brio_status status = brio_live_star(d, row);
    if (status == BRIO_OK) {
        brio_hole_number(d);
        *count = h->num_vertices - 1;
        for (size_t i = 0; i < *count; i++) h->outer[i] = d->row[h->vertex[i + 1]].name;
        *neighbours = h->outer;
    }
    brio_hole_forget(d);
    return status;
}

brio_status brio_dynamic_locate(brio_dynamic *d, const double position[3], uint32_t vertices[4]) {
    BRIO_DOOR;
    double record[4] = {position[0] + 0.0, position[1] + 0.0, position[2] + 0.0, d->low[3]};
    for (int k = 0; k < 4; k++) vertices[k] = BRIO_INFINITE;
    for (int c = 0; c < 3; c++)
        BRIO_EXPECT(d->ctx, isfinite(record[c]), BRIO_ERR_NOT_FINITE, "the position is not finite");
    if (d->dimension < 3) return BRIO_OK;
    brio_filter filter = d->filter; /* wider for this position alone: one far away would slow all later changes */
    double extent[4];
    for (int c = 0; c < 4; c++) extent[c] = fmax(d->high[c], record[c]) - fmin(d->low[c], record[c]);
    brio_filter_set(&filter, extent, extent[3], d->weighted);
    brio_live_approach(d, record);
    uint32_t tet = d->engine->walk(&d->t, NULL, &filter, &d->walk, record, UINT64_MAX);
    d->walk.start = tet;
    if (brio_is_infinite(&d->t, tet)) return BRIO_OK;
    for (int k = 0; k < 4; k++) vertices[k] = d->row[d->t.tet[tet].vertex[k]].name;
    return BRIO_OK;
}

/* --- snapshot --- */

/* Returns the place of the point that stands for the twins of a vertex: the first of the heaviest ones. In another
 * order than that of the names it need not be the vertex (L3). */
static uint32_t first_of_twins(const brio_dynamic *d, const uint32_t *place, uint32_t vertex) {
    uint32_t first = place[vertex];
    for (uint32_t r = d->row[vertex].twins; r != BRIO_NONE; r = d->row[r].next)
        if (d->record[r][3] == d->record[vertex][3] && place[r] < first) first = place[r];
    return first;
}

brio_status brio_live_snapshot(brio_context *ctx, const brio_dynamic *d, const brio_live_points *list,
                               brio_triangulation **out) {
    brio_status status = BRIO_OK;
    uint32_t *place = NULL, *vertex_of = NULL; /* of each row: its place in the list; of each place: its vertex */
    uint32_t *standing = NULL;                 /* of each row that is a vertex: the place that stands for it */
    brio_adoption *adoption = NULL;
    uint32_t *moved = NULL;
    size_t live = d->counts.finite + d->counts.infinite, n = 0;
    if (d->dimension < 3) return brio_delaunay(ctx, list->point, list->weight, list->count, NULL, out);
    BRIO_TRY(BRIO_ALLOC(ctx, place, d->num_rows));
    BRIO_TRY(BRIO_ALLOC(ctx, standing, d->num_rows));
    BRIO_TRY(BRIO_ALLOC(ctx, vertex_of, list->count));
    BRIO_TRY(BRIO_ALLOC(ctx, moved, d->t.count));
    BRIO_TRY(brio_adoption_begin(ctx, &(brio_input){list->point, list->weight, list->count}, 0, live, &adoption));
    brio_tetrahedron *tet = brio_adoption_tetrahedra(adoption);
    const uint32_t *record = brio_adoption_records(adoption), infinite = brio_adoption_infinite(adoption);
    for (size_t i = 0; i < list->count; i++) place[d->row_of[list->name[i]]] = (uint32_t)i;
    for (uint32_t r = 1; r < d->num_rows; r++)
        if (brio_row_kind(d, r) == ROW_VERTEX) standing[r] = first_of_twins(d, place, r);
    for (size_t r = 1; r < d->num_rows; r++) {
        uint32_t home = d->home[r];
        int kind = brio_row_kind(d, (uint32_t)r);
        if (kind == ROW_FREE) continue;
        uint32_t v = kind == ROW_VERTEX ? (uint32_t)r : kind == ROW_TWIN ? home : d->t.tet[home].vertex[0];
        vertex_of[place[r]] = standing[v];
    }
    for (size_t s = 0; s < d->t.count; s++)
        if (!(d->state[s] & SLOT_UNUSED)) moved[s] = (uint32_t)n++;
    assert(n == live);
    for (size_t s = 0; s < d->t.count; s++) {
        if (d->state[s] & SLOT_UNUSED) continue;
        brio_tetrahedron *to = &tet[moved[s]];
        for (int k = 0; k < 4; k++) {
            uint32_t v = d->t.tet[s].vertex[k], mate = d->t.tet[s].mate[k];
            to->vertex[k] = v ? record[standing[v]] : infinite;
            to->mate[k] = brio_facet_of(moved[brio_tet_of(mate)], brio_slot_of(mate));
        }
    }
    BRIO_TRY(brio_look(ctx, live));
    status = brio_adoption_end(ctx, adoption, vertex_of, out);
done:
    brio_adoption_free(ctx, adoption);
    brio_release(ctx, place);
    brio_release(ctx, standing);
    brio_release(ctx, vertex_of);
    brio_release(ctx, moved);
    return status;
}

brio_status brio_dynamic_snapshot(brio_context *ctx, const brio_dynamic *d, brio_triangulation **out) {
    BRIO_DOOR;
    brio_live_points list;
    *out = NULL;
    BRIO_FORWARD(brio_live_list(ctx, d, 0, &list));
    brio_status status = brio_live_snapshot(ctx, d, &list, out);
    brio_live_list_free(ctx, &list);
    return status;
}

brio_status brio_dynamic_checksum(brio_context *ctx, const brio_dynamic *d, uint64_t *checksum) {
    BRIO_DOOR;
    brio_triangulation *t = NULL;
    brio_live_points list = {0};
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_live_list(ctx, d, 0, &list));
    BRIO_TRY(brio_live_snapshot(ctx, d, &list, &t));
    status = brio_triangulation_checksum(ctx, t, list.point, checksum);
done:
    brio_triangulation_free(t);
    brio_live_list_free(ctx, &list);
    return status;
}

/* Checks L1 and L2 for each row. */
static brio_status check_rows(brio_context *ctx, const brio_dynamic *d) {
    size_t vertices = 0, alive = 0;
    for (uint32_t r = 1; r < d->num_rows; r++) {
        int kind = d->kind[r];
        uint32_t home = d->home[r], next = d->row[r].next;
        if (kind == ROW_FREE) continue;
        alive++;
        BRIO_EXPECT(ctx, d->row_of[d->row[r].name] == r, BRIO_ERR_CHECK, "row %u has the name of another row", r);
        if (kind == ROW_LOOSE) continue;
        vertices += kind == ROW_VERTEX;
        bool homely = kind == ROW_TWIN ? d->kind[home] == ROW_VERTEX : d->state[home] == SLOT_PLAIN;
        if (kind == ROW_VERTEX) homely &= brio_slot_of_vertex(d->t.tet[home].vertex, r) < 4;
        if (kind == ROW_HIDDEN) homely &= !brio_is_infinite(&d->t, home);
        BRIO_EXPECT(ctx, homely, BRIO_ERR_CHECK, "row %u is not at home", r);
        if (kind == ROW_VERTEX || next == BRIO_NONE) continue;
        BRIO_EXPECT(ctx, d->row[next].prev == r && d->home[next] == home && d->kind[next] == kind, BRIO_ERR_CHECK,
                    "the list of row %u is broken", r);
    }
    BRIO_EXPECT(ctx, alive == d->counts.alive && vertices == d->counts.vertices, BRIO_ERR_CHECK,
                "%zu rows and %zu vertices are counted as %zu and %zu", alive, vertices, d->counts.alive,
                d->counts.vertices);
    return BRIO_OK;
}

brio_status brio_dynamic_check(brio_context *ctx, const brio_dynamic *d) {
    BRIO_DOOR;
    brio_triangulation *t = NULL;
    brio_live_points list = {0};
    brio_status status = BRIO_OK;
    BRIO_TRY(check_rows(ctx, d));
    BRIO_TRY(brio_live_list(ctx, d, 0, &list));
    BRIO_TRY(brio_live_snapshot(ctx, d, &list, &t));
    status = brio_triangulation_check(ctx, t, list.point, list.weight, list.count);
done:
    brio_triangulation_free(t);
    brio_live_list_free(ctx, &list);
    return status;
}
