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

/* Returns how many changes of a cost, one by one, take as long as building a triangulation of `left` points. */
static size_t most_changes(const brio_dynamic *d, double cost, size_t left) {
    enum { FEW = 32 };
    int threads = brio_context_threads(d->ctx);
    double speed = 0.35 + 0.65 * (threads > 1 && left > 4096 ? threads : 1); /* of building, by threads */
    return FEW + (size_t)((double)left / (speed * cost));
}

/* Returns whether changing `count` points one by one takes longer than building a triangulation of `left` points. */
static bool anew_is_faster(const brio_dynamic *d, size_t count, double cost, size_t left) {
    return d->dimension < 3 || left < 8 || count > most_changes(d, cost, left);
}

enum { SORTED = 8 }; /* changes in a call that are worth an order */

/* Lists points by their rows, so that near ones follow each other: the places in `indices` are the low halves. NULL for
 * few. */
static brio_status order_by_row(brio_dynamic *d, const uint32_t *indices, size_t n, uint64_t **order) {
    if (n < SORTED || !indices) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, *order, n));
    for (size_t i = 0; i < n; i++) (*order)[i] = (uint64_t)d->row_of[indices[i]] << 32 | i;
    return brio_sort_many_keys(d->ctx, *order, n);
}

static size_t at_place(const uint64_t *order, size_t i) {
    return order ? (size_t)(order[i] & UINT32_MAX) : i;
}

/* --- insert --- */

static brio_status check_points(brio_dynamic *d, const double *points, const double *weights, size_t n) {
    BRIO_EXPECT(d->ctx, d->weighted || !weights, BRIO_ERR_ARGUMENT, "weights for a triangulation without weights");
    BRIO_EXPECT(d->ctx, n < UINT32_MAX - 16, BRIO_ERR_TOO_LARGE, "%zu points; at most 2^32 - 17", n);
    return brio_refuse_not_finite(d->ctx, points, weights, n, NULL);
}

/* Writes the record of point i of a caller's arrays. */
static void read_record(double record[4], const double *points, const double *weights, size_t i) {
    for (int c = 0; c < 3; c++) record[c] = points[3 * i + (size_t)c] + 0.0;
    record[3] = weights ? weights[i] + 0.0 : 0;
}

static brio_status insert_anew(brio_dynamic *d, const double *points, const double *weights, size_t n) {
    brio_live_points list;
    brio_status status = brio_live_list(d->ctx, d, n, &list);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) {
        double record[4];
        read_record(record, points, weights, i);
        memcpy(list.point + 3 * list.count, record, 3 * sizeof *record);
        if (list.weight) list.weight[list.count] = record[3];
        list.name[list.count++] = (uint32_t)(d->num_names + i);
    }
    status = brio_live_build(d, &list, d->num_names + n);
    brio_live_list_free(d->ctx, &list);
    return status;
}

/* Inserts in the order of the curve. */
static brio_status insert_each(brio_dynamic *d, const double *points, const double *weights, size_t n) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL, first = (uint32_t)d->num_names;
    BRIO_TRY(brio_live_reserve_rows(d, n));
    BRIO_TRY(brio_live_reserve_names(d, n));
    BRIO_TRY(brio_journal_reserve(d, 0, n));
    if (n >= SORTED) {
        brio_delaunay_options options = {.seed = 1};
        BRIO_TRY(BRIO_ALLOC(d->ctx, order, n));
        BRIO_TRY(brio_order_points(d->ctx, &(brio_input){points, weights, n}, &options, order, NULL, NULL, NULL));
    }
    d->num_names += n;
    for (size_t i = 0; i < n; i++) d->row_of[first + i] = BRIO_NONE;
    for (size_t i = 0; i < n; i++) {
        size_t at = order ? order[i] : i;
        double record[4];
        read_record(record, points, weights, at);
        BRIO_REQUIRE(d->ctx, brio_all_finite(record, 4), BRIO_ERR_NOT_FINITE, "point %zu is not finite", at);
        brio_live_admit(d, record);
        BRIO_TRY(brio_journal_reserve(d, 0, 1));
        BRIO_TRY(brio_live_place(d, brio_live_add_row(d, record, first + (uint32_t)at)));
        BRIO_TRY(brio_look(d->ctx, 4));
    }
done:
    brio_release(d->ctx, order);
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

/* Checks that each index is that of a point that is there, and none is twice. */
static brio_status check_indices(brio_dynamic *d, const uint32_t *indices, size_t n) {
    uint64_t *seen = NULL;
    brio_status status = BRIO_OK;
    if (n > 1) BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, seen, d->num_names / 64 + 1));
    for (size_t i = 0; i < n; i++) {
        BRIO_REQUIRE(d->ctx, indices[i] < d->num_names && d->row_of[indices[i]] != BRIO_NONE, BRIO_ERR_ARGUMENT,
                     "index %zu: there is no point %u", i, indices[i]);
        if (!seen) continue;
        uint64_t bit = UINT64_C(1) << indices[i] % 64, *word = &seen[indices[i] / 64];
        BRIO_REQUIRE(d->ctx, !(*word & bit), BRIO_ERR_ARGUMENT, "index %zu: point %u is there twice", i, indices[i]);
        *word |= bit;
    }
done:
    brio_release(d->ctx, seen);
    return status;
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
    status = brio_live_build(d, &list, d->num_names);
done:
    brio_release(d->ctx, gone);
    brio_live_list_free(d->ctx, &list);
    return status;
}

static brio_status remove_each(brio_dynamic *d, const uint32_t *indices, size_t n) {
    brio_status status = BRIO_OK;
    uint64_t *order = NULL;
    BRIO_TRY(order_by_row(d, indices, n, &order));
    for (size_t i = 0; i < n; i++) {
        uint32_t row = d->row_of[indices[at_place(order, i)]];
        BRIO_TRY(brio_live_take(d, &row));
        BRIO_TRY(brio_live_drop_row(d, row));
        BRIO_TRY(brio_look(d->ctx, 4));
    }
done:
    brio_release(d->ctx, order);
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
    status = brio_live_build(d, &list, d->num_names);
done:
    brio_release(d->ctx, place);
    brio_live_list_free(d->ctx, &list);
    return status;
}

/* Moves one by one. Asks for building anew where that is faster than to take out all that have to be. */
static brio_status move_each(brio_dynamic *d, const brio_moves *m) {
    uint64_t before = d->replaced, *order = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(order_by_row(d, m->indices, m->count, &order));
    for (size_t i = 0, name = 0; i < m->count; i++, name++) {
        size_t at = at_place(order, i);
        double record[4];
        if (m->indices)
            name = m->indices[at];
        else
            while (d->row_of[name] == BRIO_NONE) name++;
        BRIO_TRY(brio_new_record(d, m, at, (uint32_t)name, record));
        BRIO_TRY(brio_live_move(d, (uint32_t)name, record));
        BRIO_TRY(brio_look(d->ctx, 4));
        if (i % 256 != 255) continue;
        if (!anew_is_faster(d, (size_t)(d->replaced - before), REPLACE_COST, d->counts.alive)) continue;
        d->needs_anew = true;
        status = BRIO_ERR_INTERNAL; /* the caller takes the change back and builds anew */
        goto done;
    }
done:
    brio_release(d->ctx, order);
    return status;
}

/* Returns whether the tetrahedra are to be tested together after all moves, not star by star: then all points are
 * vertices, and many move. */
static bool are_many(const brio_dynamic *d, const brio_moves *m) {
    enum { MANY = 1024 };
    return d->counts.alive >= MANY && d->counts.alive == d->counts.vertices && m->count > d->counts.alive / 8;
}

static brio_status move_together(brio_dynamic *d, const brio_moves *m) {
    brio_paths paths;
    brio_status status = brio_paths_new(d, m, &paths);
    if (status != BRIO_OK) return status;
    status = brio_live_move_many(d, &paths, most_changes(d, REPLACE_COST, d->counts.alive));
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
    if (m->points) BRIO_FORWARD(brio_refuse_not_finite(d->ctx, m->points, m->weights, m->count, NULL));
    d->needs_anew = d->dimension < 3;
    if (!d->needs_anew) {
        brio_live_begin(d);
        status = brio_live_end(d, are_many(d, m) ? move_together(d, m) : move_each(d, m));
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
