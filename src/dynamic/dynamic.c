/* A triangulation that lives: the public calls.
 *
 * A call that changes something checks all it was given, then works in a transaction (live.h), point by point. Where
 * building anew is faster than the changes, or the points have no tetrahedra before or after it, it lists the points
 * that it leaves and builds of them what takes the old one's place. */
#include "brio/dynamic.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/versioned.h"
#include "dynamic/live.h"
#include "order/order.h"
#include <string.h>

/* What a change costs a point, compared with building a point by one thread: measured, docs/decisions/019. */
static const double INSERT_COST = 3, REMOVE_COST = 5, REPLACE_COST = 10;

brio_status brio_dynamic_new(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                             int weighted, brio_dynamic **out) {
    BRIO_DOOR;
    brio_dynamic *d = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_REQUIRE(ctx, weighted || !weights, BRIO_ERR_ARGUMENT, "weights, but weighted is 0");
    BRIO_TRY(brio_live_new(ctx, weighted != 0, &d));
    BRIO_TRY(brio_dynamic_insert(d, points, weights, num_points, NULL));
    d->anew = 0;
    *out = d;
    d = NULL;
done:
    brio_dynamic_free(d);
    return status;
}

void brio_dynamic_free(brio_dynamic *d) {
    if (!d) return;
    brio_live_clear(d);
    brio_release(d->ctx, d);
}

/* Returns how many changes of a cost take as long as building a triangulation of `left` points, which all threads
 * share, as they share the changes. */
static size_t most_changes(double cost, size_t left) {
    enum { FEW = 32 };
    return FEW + (size_t)((double)left / cost);
}

/* Returns whether making `count` changes takes longer than building a triangulation of `left` points. */
static bool anew_is_faster(const brio_dynamic *d, size_t count, double cost, size_t left) {
    return d->dimension < 3 || left < 8 || count > most_changes(cost, left);
}

enum { SORTED = 8 }; /* changes in a call that are worth an order */

/* Lists places 0 to n - 1 of `indices` by the points' rows, so that near points follow each other. */
static brio_status order_by_row(brio_dynamic *d, const uint32_t *indices, size_t n, uint32_t **place) {
    brio_status status = BRIO_OK;
    uint64_t *key = NULL;
    BRIO_TRY(BRIO_ALLOC(d->ctx, *place, n));
    BRIO_TRY(BRIO_ALLOC(d->ctx, key, n));
    for (size_t i = 0; i < n; i++) key[i] = (uint64_t)d->row_of[indices[i]] << 32 | i;
    if (n >= SORTED) BRIO_TRY(brio_sort_many_keys(d->ctx, key, n));
    for (size_t i = 0; i < n; i++) (*place)[i] = (uint32_t)(key[i] & UINT32_MAX);
done:
    brio_release(d->ctx, key);
    return status;
}

/* --- insert --- */

static brio_status check_points(brio_dynamic *d, const double *points, const double *weights, size_t n) {
    BRIO_EXPECT(d->ctx, d->weighted || !weights, BRIO_ERR_ARGUMENT, "weights for a triangulation without weights");
    BRIO_FORWARD(brio_refuse_many(d->ctx, n));
    return brio_refuse_not_finite(d->ctx, points, weights, n, NULL);
}

/* Writes the record of point i of a caller's arrays. */
static void read_record(double record[4], const double *points, const double *weights, size_t i) {
    for (int c = 0; c < 3; c++) record[c] = points[3 * i + (size_t)c] + 0.0;
    record[3] = weights ? weights[i] + 0.0 : 0;
}

/* Appends points that are inserted to a list, which has room. */
static void append_points(const brio_dynamic *d, brio_live_points *list, const double *points, const double *weights,
                          size_t n) {
    for (size_t i = 0; i < n; i++) {
        double record[4];
        read_record(record, points, weights, i);
        memcpy(list->point + 3 * list->count, record, 3 * sizeof *record);
        if (list->weight) list->weight[list->count] = record[3];
        list->name[list->count++] = (uint32_t)(d->num_names + i);
    }
}

static brio_status insert_anew(brio_dynamic *d, const double *points, const double *weights, size_t n) {
    brio_live_points list;
    brio_status status = brio_live_list(d->ctx, d, n, &list);
    if (status != BRIO_OK) return status;
    append_points(d, &list, points, weights, n);
    status = brio_live_build(d, &list, d->num_names + n, true);
    brio_live_list_free(d->ctx, &list);
    return status;
}

/* Adds loose rows for points, in the order of the curve. Lists their names. */
static brio_status add_rows(brio_dynamic *d, const double *points, const double *weights, size_t n, uint32_t *name) {
    uint32_t first = (uint32_t)d->num_names;
    BRIO_FORWARD(brio_live_reserve_rows(d, n));
    BRIO_FORWARD(brio_live_reserve_names(d, n));
    BRIO_FORWARD(brio_journal_reserve(d, 0, n));
    for (size_t i = 0; i < n; i++) name[i] = (uint32_t)i;
    if (n >= SORTED) {
        brio_delaunay_options options = {.seed = 1};
        BRIO_FORWARD(brio_order_points(d->ctx, &(brio_input){points, weights, n}, &options, name, NULL, NULL, NULL));
    }
    d->num_names += n;
    for (size_t i = 0; i < n; i++) d->row_of[first + i] = BRIO_NONE;
    for (size_t i = 0; i < n; i++) {
        size_t at = name[i];
        double record[4];
        read_record(record, points, weights, at);
        BRIO_EXPECT(d->ctx, brio_all_finite(record, 4), BRIO_ERR_NOT_FINITE, "point %zu is not finite", at);
        brio_live_admit(d, record);
        name[i] = first + (uint32_t)at;
        brio_live_rank(d, brio_live_add_row(d, record, name[i]));
    }
    return BRIO_OK;
}

static brio_status insert_each(brio_dynamic *d, const double *points, const double *weights, size_t n) {
    brio_status status = BRIO_OK;
    uint32_t *name = NULL;
    BRIO_TRY(BRIO_ALLOC(d->ctx, name, n));
    BRIO_TRY(add_rows(d, points, weights, n, name));
    status = brio_live_together(d, &(brio_batch){.kind = BRIO_BATCH_INSERT, .name = name, .count = n, .most = n});
done:
    brio_release(d->ctx, name);
    return status;
}

brio_status brio_dynamic_insert(brio_dynamic *d, const double *points, const double *weights, size_t num_points,
                                uint32_t *first) {
    BRIO_DOOR;
    uint32_t begin = (uint32_t)d->num_names;
    brio_status status = check_points(d, points, weights, num_points);
    if (status != BRIO_OK) return status;
    if (num_points == 0) {
        if (first) *first = begin;
        return BRIO_OK;
    }
    if (anew_is_faster(d, num_points, INSERT_COST, d->counts.alive + num_points)) {
        status = insert_anew(d, points, weights, num_points);
    } else {
        BRIO_FORWARD(brio_live_refresh_hints(d));
        brio_live_begin(d);
        status = brio_live_end(d, insert_each(d, points, weights, num_points));
    }
    if (status == BRIO_OK && first) *first = begin;
    return status;
}

/* --- remove --- */

brio_status brio_live_check_indices(brio_context *ctx, const uint32_t *indices, size_t n, size_t num_names,
                                    bool (*there)(const void *user, uint32_t index), const void *user) {
    uint64_t *seen = NULL;
    brio_status status = BRIO_OK;
    if (n > 1) BRIO_TRY(BRIO_ALLOC_ZERO(ctx, seen, num_names / 64 + 1));
    for (size_t i = 0; i < n; i++) {
        BRIO_REQUIRE(ctx, indices[i] < num_names && there(user, indices[i]), BRIO_ERR_ARGUMENT,
                     "index %zu: there is no point %u", i, indices[i]);
        if (!seen) continue;
        uint64_t bit = UINT64_C(1) << indices[i] % 64, *word = &seen[indices[i] / 64];
        BRIO_REQUIRE(ctx, !(*word & bit), BRIO_ERR_ARGUMENT, "index %zu: point %u is there twice", i, indices[i]);
        *word |= bit;
    }
done:
    brio_release(ctx, seen);
    return status;
}

static bool is_there(const void *user, uint32_t index) {
    const brio_dynamic *d = user;
    return d->row_of[index] != BRIO_NONE;
}

static brio_status check_indices(brio_dynamic *d, const uint32_t *indices, size_t n) {
    return brio_live_check_indices(d->ctx, indices, n, d->num_names, is_there, d);
}

static brio_status remove_anew(brio_dynamic *d, const uint32_t *indices, size_t n) {
    brio_live_points list;
    uint8_t *gone = NULL;
    size_t kept = 0;
    brio_status status = brio_live_list(d->ctx, d, 0, &list);
    if (status != BRIO_OK) return status;
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, gone, d->num_names));
    for (size_t i = 0; i < n; i++) gone[indices[i]] = 1;
    for (size_t i = 0; i < list.count; i++) {
        if (gone[list.name[i]]) continue;
        memmove(list.point + 3 * kept, list.point + 3 * i, 3 * sizeof *list.point);
        if (list.weight) list.weight[kept] = list.weight[i];
        list.name[kept++] = list.name[i];
    }
    list.count = kept;
    status = brio_live_build(d, &list, d->num_names, true);
done:
    brio_release(d->ctx, gone);
    brio_live_list_free(d->ctx, &list);
    return status;
}

static brio_status remove_each(brio_dynamic *d, const uint32_t *indices, size_t n) {
    brio_status status = BRIO_OK;
    uint32_t *name = NULL;
    BRIO_TRY(order_by_row(d, indices, n, &name));
    for (size_t i = 0; i < n; i++) name[i] = indices[name[i]];
    BRIO_TRY(brio_live_together(d, &(brio_batch){.kind = BRIO_BATCH_REMOVE, .name = name, .count = n, .most = n}));
    for (size_t i = 0; i < n; i++) BRIO_TRY(brio_live_drop_row(d, d->row_of[name[i]]));
done:
    brio_release(d->ctx, name);
    return status;
}

brio_status brio_dynamic_remove(brio_dynamic *d, const uint32_t *indices, size_t num_indices) {
    BRIO_DOOR;
    brio_status status = check_indices(d, indices, num_indices);
    if (status != BRIO_OK || num_indices == 0) return status;
    d->needs_anew = anew_is_faster(d, num_indices, REMOVE_COST, d->counts.alive - num_indices);
    if (!d->needs_anew) {
        brio_live_begin(d);
        status = brio_live_end(d, remove_each(d, indices, num_indices));
    }
    return d->needs_anew ? remove_anew(d, indices, num_indices) : status;
}

/* --- move --- */

static brio_status move_anew(brio_dynamic *d, const brio_moves *m) {
    brio_live_points list;
    uint32_t *place = NULL;
    brio_status status = brio_live_list(d->ctx, d, 0, &list);
    if (status != BRIO_OK) return status;
    BRIO_TRY(BRIO_ALLOC(d->ctx, place, d->num_names));
    for (size_t i = 0; i < list.count; i++) place[list.name[i]] = (uint32_t)i;
    for (size_t i = 0; i < m->count; i++) {
        size_t at = m->indices ? place[m->indices[i]] : i;
        double record[4];
        BRIO_TRY(brio_new_record(d, m, i, list.name[at], record));
        memcpy(list.point + 3 * at, record, 3 * sizeof *record);
        if (list.weight) list.weight[at] = record[3];
    }
    status = brio_live_build(d, &list, d->num_names, false);
done:
    brio_release(d->ctx, place);
    brio_live_list_free(d->ctx, &list);
    return status;
}

/* Lists the names of all points. */
static brio_status list_names(const brio_dynamic *d, uint32_t **name) {
    size_t n = 0;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, *name, d->counts.alive));
    for (size_t i = 0; i < d->num_names; i++)
        if (d->row_of[i] != BRIO_NONE) (*name)[n++] = (uint32_t)i;
    return BRIO_OK;
}

/* Gives rows the rank of what is near them now. */
static void rank_moved(brio_dynamic *d, const uint32_t *name, size_t n) {
    for (size_t i = 0; i < n; i++) brio_live_rank(d, d->row_of[name[i]]);
}

/* Moves point by point. Asks for building anew where that is faster than to take out all that have to be. */
static brio_status move_each(brio_dynamic *d, const brio_moves *m) {
    brio_status status = BRIO_OK;
    uint32_t *all = NULL, *at = NULL, *name = NULL;
    if (!m->indices) BRIO_TRY(list_names(d, &all));
    const uint32_t *indices = m->indices ? m->indices : all;
    BRIO_TRY(order_by_row(d, indices, m->count, &at));
    BRIO_TRY(BRIO_ALLOC(d->ctx, name, m->count));
    for (size_t i = 0; i < m->count; i++) {
        double record[4];
        name[i] = indices[at[i]];
        BRIO_TRY(brio_new_record(d, m, at[i], name[i], record));
        brio_live_admit(d, record);
    }
    BRIO_TRY(brio_live_together(d, &(brio_batch){.kind = BRIO_BATCH_MOVE,
                                                 .name = name,
                                                 .at = at,
                                                 .moves = m,
                                                 .count = m->count,
                                                 .most = most_changes(REPLACE_COST, d->counts.alive)}));
    rank_moved(d, name, m->count);
done:
    brio_release(d->ctx, all);
    brio_release(d->ctx, at);
    brio_release(d->ctx, name);
    return status;
}

/* Returns whether the tetrahedra are to be tested together after all moves, not star by star: then all points are
 * vertices, and many move. */
static bool are_many(const brio_dynamic *d, const brio_moves *m) {
    enum { MANY = 1024 };
    return d->counts.alive >= MANY && d->counts.alive == d->counts.vertices && m->count > d->counts.alive / 8;
}

/* Returns how many rows may be taken out and put in again, by one thread, before building anew by all is faster. */
static size_t most_repairs(const brio_dynamic *d) {
    int threads = brio_context_threads(d->ctx);
    double speed = 0.35 + 0.65 * (threads > 1 && d->counts.alive > 4096 ? threads : 1); /* of building, by threads */
    return most_changes(speed * REPLACE_COST, d->counts.alive);
}

static brio_status move_together(brio_dynamic *d, const brio_moves *m) {
    brio_paths paths;
    brio_status status = brio_paths_new(d, m, &paths);
    if (status != BRIO_OK) return status;
    status = brio_live_move_many(d, &paths, most_repairs(d));
    brio_paths_free(d->ctx, &paths);
    return status;
}

static brio_status move_points(brio_dynamic *d, const brio_moves *m) {
    brio_status status = BRIO_OK;
    uint64_t in_place = d->in_place, replaced = d->replaced;
    if (m->indices) {
        BRIO_FORWARD(check_indices(d, m->indices, m->count));
    } else {
        BRIO_EXPECT(d->ctx, m->count == d->counts.alive, BRIO_ERR_ARGUMENT, "%zu positions for %zu points", m->count,
                    d->counts.alive);
    }
    if (m->count == 0) return BRIO_OK;
    BRIO_EXPECT(d->ctx, d->weighted || !m->weights, BRIO_ERR_ARGUMENT, "weights for a triangulation without weights");
    bool many = are_many(d, m); /* then whoever writes the records looks at them */
    if (m->points && !many) BRIO_FORWARD(brio_refuse_not_finite(d->ctx, m->points, m->weights, m->count, NULL));
    d->needs_anew = d->dimension < 3;
    if (!d->needs_anew) {
        brio_live_begin(d);
        status = brio_live_end(d, many ? move_together(d, m) : move_each(d, m));
    }
    if (status != BRIO_OK) d->in_place = in_place, d->replaced = replaced;
    return d->needs_anew ? move_anew(d, m) : status;
}

brio_status brio_dynamic_move(brio_dynamic *d, const uint32_t *indices, const double *points, const double *weights,
                              size_t num_indices) {
    BRIO_DOOR;
    return move_points(d, &(brio_moves){indices, points, weights, num_indices});
}

brio_status brio_dynamic_reweight(brio_dynamic *d, const uint32_t *indices, const double *weights, size_t num_indices) {
    BRIO_DOOR;
    return move_points(d, &(brio_moves){indices, NULL, weights, num_indices});
}

/* --- several kinds at once --- */

/* Lists the points that the changes leave. */
static brio_status list_changed(brio_dynamic *d, const brio_live_changes *c, brio_live_points *list) {
    enum { GONE = UINT32_MAX };
    uint32_t *place = NULL;
    size_t kept = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(d->ctx, place, d->num_names));
    for (size_t i = 0; i < list->count; i++) place[list->name[i]] = (uint32_t)i;
    for (size_t i = 0; i < c->moved.count; i++) {
        double record[4];
        size_t at = place[c->moved.indices[i]];
        BRIO_TRY(brio_new_record(d, &c->moved, i, list->name[at], record));
        memcpy(list->point + 3 * at, record, 3 * sizeof *record);
        if (list->weight) list->weight[at] = record[3];
    }
    for (size_t i = 0; i < c->num_removed; i++) place[c->removed[i]] = GONE;
    for (size_t i = 0; i < list->count; i++) {
        if (place[list->name[i]] == GONE) continue;
        memmove(list->point + 3 * kept, list->point + 3 * i, 3 * sizeof *list->point);
        if (list->weight) list->weight[kept] = list->weight[i];
        list->name[kept++] = list->name[i];
    }
    list->count = kept;
    append_points(d, list, c->points, c->weights, c->num_inserted);
done:
    brio_release(d->ctx, place);
    return status;
}

static brio_status change_anew(brio_dynamic *d, const brio_live_changes *c) {
    brio_live_points list;
    brio_status status = brio_live_list(d->ctx, d, c->num_inserted, &list);
    if (status != BRIO_OK) return status;
    bool sorted = c->moved.count < d->counts.alive / 2;
    status = list_changed(d, c, &list);
    if (status == BRIO_OK) status = brio_live_build(d, &list, d->num_names + c->num_inserted, sorted);
    brio_live_list_free(d->ctx, &list);
    return status;
}

/* Makes the changes one kind after the other.
 *  paths  receives what all rows were, where they move together; the caller puts that back if a later step fails. */
static brio_status change_each(brio_dynamic *d, const brio_live_changes *c, brio_paths *paths) {
    if (c->moved.count && are_many(d, &c->moved)) {
        BRIO_FORWARD(brio_paths_new(d, &c->moved, paths));
        brio_status status = brio_live_move_many(d, paths, most_repairs(d));
        if (status != BRIO_OK) brio_paths_free(d->ctx, paths); /* it has taken all back */
        BRIO_FORWARD(status);
    } else if (c->moved.count) {
        BRIO_FORWARD(move_each(d, &c->moved));
    }
    if (c->num_removed) BRIO_FORWARD(remove_each(d, c->removed, c->num_removed));
    return c->num_inserted ? insert_each(d, c->points, c->weights, c->num_inserted) : BRIO_OK;
}

brio_status brio_live_change(brio_dynamic *d, const brio_live_changes *c) {
    size_t left = d->counts.alive - c->num_removed + c->num_inserted;
    uint64_t in_place = d->in_place, replaced = d->replaced;
    double cost = REMOVE_COST * (double)c->num_removed + INSERT_COST * (double)c->num_inserted;
    brio_paths paths = {0};
    brio_status status = BRIO_OK;
    assert(c->moved.indices || c->moved.count == 0);
    BRIO_EXPECT(d->ctx, d->num_names + c->num_inserted < UINT32_MAX - 16, BRIO_ERR_TOO_LARGE,
                "more than 2^32 - 17 points");
    d->needs_anew =
        d->dimension < 3 || left < 8 || d->counts.alive == c->num_removed || cost > (double)most_changes(1, left);
    if (!d->needs_anew) {
        if (c->num_inserted) BRIO_FORWARD(brio_live_refresh_hints(d));
        brio_live_begin(d);
        status = brio_live_end(d, change_each(d, c, &paths));
        if (status != BRIO_OK && paths.record) {
            memcpy(d->record, paths.record, d->num_rows * sizeof *d->record);
            brio_slack_end_all(d);
        }
        brio_paths_free(d->ctx, &paths);
    }
    if (status != BRIO_OK) d->in_place = in_place, d->replaced = replaced;
    return d->needs_anew ? change_anew(d, c) : status;
}

void brio_live_renumber(brio_dynamic *d, uint32_t *now) {
    uint32_t count = 0;
    for (size_t i = 0; i < d->num_names; i++) {
        uint32_t row = d->row_of[i];
        now[i] = row == BRIO_NONE ? BRIO_NONE : count;
        if (row == BRIO_NONE) continue;
        d->row[row].name = count;
        d->row_of[count++] = row;
    }
    d->num_names = count;
}
