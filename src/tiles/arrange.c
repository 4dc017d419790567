/* The points of each tile come to their places: those that stand for their position, along a Hilbert curve, in
 * blocks. Extreme points and a basis are found on the way. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/order.h"
#include "tiles/work.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { POINTS_A_THREAD = 1 << 14, KEY_BITS = 33 /* three digits of the sort. Chosen */ };

/* --- one point for each position --- */

/* Orders by position, then the point that stands for it first. */
static int compare_rows(uint32_t i, uint32_t j, const void *user) {
    const brio_set_point *p = (const brio_set_point *)user + i, *q = (const brio_set_point *)user + j;
    int sign = brio_lexicographic(p->record, q->record);
    if (sign) return sign;
    if (p->record[3] != q->record[3]) return p->record[3] > q->record[3] ? -1 : 1;
    return p->name < q->name ? -1 : p->name > q->name;
}

typedef struct {
    const brio_set_point *points;
    uint64_t *key;
    uint32_t *row;
} keys;

/* Sets keys that are equal at equal positions, and seldom at others. */
static void set_keys(void *user, size_t begin, size_t end, int thread) {
    const keys *k = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        uint64_t x[3];
        memcpy(x, k->points[i].record, sizeof x);
        k->key[i] = brio_mix(x[0] ^ brio_mix(x[1] ^ brio_mix(x[2]))) >> (64 - KEY_BITS);
        k->row[i] = (uint32_t)i;
    }
}

/* Marks the points of a run of equal keys that do not stand for their position. */
static brio_status mark_twins(brio_tiles *t, const brio_set_point *points, uint32_t *row, size_t n, uint8_t *gone) {
    BRIO_FORWARD(brio_sort_many_indices(t->ctx, row, n, compare_rows, points));
    for (size_t i = 1; i < n; i++) {
        gone[row[i]] = brio_same_position(points[row[i - 1]].record, points[row[i]].record);
        t->stats.duplicates += gone[row[i]];
    }
    return BRIO_OK;
}

/* Drops the points that do not stand for their position. */
static brio_status drop_twins(brio_tiles *t, brio_set_point *points, size_t *count) {
    uint8_t *gone = NULL;
    brio_status status = BRIO_OK;
    size_t n = *count, left = 0;
    keys k = {.points = points};
    BRIO_TRY(BRIO_ALLOC(t->ctx, k.key, n + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, k.row, n + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, gone, n + 1));
    BRIO_TRY(brio_for(t->ctx, brio_threads(t->ctx, n, POINTS_A_THREAD), n, set_keys, &k));
    BRIO_TRY(brio_radix_sort(t->ctx, k.key, k.row, n, KEY_BITS));
    for (size_t begin = 0, end; begin < n; begin = end) {
        for (end = begin + 1; end < n && k.key[end] == k.key[begin];) end++;
        if (end - begin > 1) BRIO_TRY(mark_twins(t, points, k.row + begin, end - begin, gone));
        BRIO_TRY(brio_look(t->ctx, end - begin));
    }
    for (size_t i = 0; i < n; i++) {
        if (gone[i]) continue;
        if (left < i) points[left] = points[i];
        left++;
    }
    *count = left;
done:
    brio_release(t->ctx, k.key);
    brio_release(t->ctx, k.row);
    brio_release(t->ctx, gone);
    return status;
}

/* --- places --- */

typedef struct {
    const brio_set_point *from;
    brio_set_point *to;
    double *positions;
    const uint32_t *order;
} copying;

static void copy_positions(void *user, size_t begin, size_t end, int thread) {
    const copying *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) memcpy(c->positions + 3 * i, c->from[i].record, 3 * sizeof *c->positions);
}

static void copy_in_order(void *user, size_t begin, size_t end, int thread) {
    const copying *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) c->to[i] = c->from[c->order[i]];
}

/* Brings points into the order of a Hilbert curve. */
static brio_status follow_curve(brio_tiles *t, brio_set_point **points, size_t n) {
    uint32_t *order = NULL;
    copying c = {.from = *points};
    brio_status status = BRIO_OK;
    brio_delaunay_options o = {.size = sizeof o, .order = BRIO_ORDER_HILBERT, .seed = BRIO_SEED};
    int threads = brio_threads(t->ctx, n, POINTS_A_THREAD);
    BRIO_TRY(BRIO_ALLOC(t->ctx, c.positions, 3 * n + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, order, n + 1));
    c.order = order;
    BRIO_TRY(brio_for(t->ctx, threads, n, copy_positions, &c));
    BRIO_TRY(brio_order_points(t->ctx, &(brio_input){c.positions, NULL, n}, &o, order, NULL, NULL, NULL));
    BRIO_TRY(BRIO_ALLOC(t->ctx, c.to, n + 1));
    BRIO_TRY(brio_for(t->ctx, threads, n, copy_in_order, &c));
    brio_release(t->ctx, *points);
    *points = c.to;
    c.to = NULL;
done:
    brio_release(t->ctx, c.positions);
    brio_release(t->ctx, order);
    brio_release(t->ctx, c.to);
    return status;
}

/* --- extreme points, and points that span space --- */

/* Returns the sign of a direction along an axis: 26 of the 27 triples, for (0, 0, 0) is none. */
static int sign_along(int direction, int axis) {
    static const int POWER[3] = {1, 3, 9};
    return (direction < 13 ? direction : direction + 1) / POWER[axis] % 3 - 1;
}

static double along(int direction, const double *x) {
    return sign_along(direction, 0) * x[0] + sign_along(direction, 1) * x[1] + sign_along(direction, 2) * x[2];
}

static bool spans_more(const brio_tiles *t, brio_filter *f, const double *p) {
    const brio_set_point *b = t->basis;
    switch (t->num_basis) {
    case 0:
        return true;
    case 1:
        return !brio_same_position(b[0].record, p);
    case 2:
        return !brio_collinear(b[0].record, b[1].record, p);
    case 3:
        return brio_orient3d_sign(f, b[0].record, b[1].record, b[2].record, p) != 0;
    default:
        return false;
    }
}

void brio_tiles_note(brio_tiles *t, brio_filter *f, const brio_set_point *p) {
    bool first = t->num_basis == 0;
    for (int d = 0; d < TILE_DIRECTIONS; d++)
        if (first || along(d, p->record) > along(d, t->extreme[d].record)) t->extreme[d] = *p;
    if (spans_more(t, f, p->record)) t->basis[t->num_basis++] = *p;
}

/* Notes the extreme ones of the points of a block. In most directions its box tells that it has none: the sums are
 * monotone, also as they are rounded. The point at the first place of this process is compared with none. */
static void note_extremes(brio_tiles *t, const brio_set_point *points, const brio_tile_node *block) {
    uint64_t place = block->place;
    for (int d = 0; d < TILE_DIRECTIONS; d++) {
        double corner[3];
        for (int k = 0; k < 3; k++) corner[k] = sign_along(d, k) < 0 ? block->box.low[k] : block->box.high[k];
        if (place > t->first_place && !(along(d, corner) > along(d, t->extreme[d].record))) continue;
        for (size_t i = 0; i < block->points; i++)
            if (place + i == t->first_place || along(d, points[i].record) > along(d, t->extreme[d].record)) {
                t->extreme[d] = points[i];
                t->extreme[d].name = place + i;
            }
    }
}

/* Notes the points of a tile.   first_node  of its blocks. */
static void note_points(brio_tiles *t, const brio_tile *tile, const brio_set_point *points, size_t first_node) {
    brio_filter f;
    brio_tiles_filter(t, &f);
    for (size_t i = 0; i < tile->points; i += TILE_BLOCK)
        note_extremes(t, points + i, &t->node[first_node + i / TILE_BLOCK]);
    for (size_t i = 0; i < tile->points && t->num_basis < 4; i++) {
        if (!spans_more(t, &f, points[i].record)) continue;
        t->basis[t->num_basis] = points[i];
        t->basis[t->num_basis++].name = tile->place + i;
    }
}

/* --- tiles --- */

static brio_status read_divided(brio_tiles *t, uint32_t tile, brio_set_point **points) {
    brio_store_file file = {.file = -1};
    brio_status status = BRIO_OK;
    char name[32];
    size_t n = t->tile[tile].raw;
    snprintf(name, sizeof name, "divided-%u", tile);
    BRIO_REQUIRE(t->ctx, n < (UINT32_C(1) << 31) - 16, BRIO_ERR_TOO_LARGE,
                 "tile %u has %zu points; at most 2^31 - 17: take more tiles", tile, n);
    BRIO_TRY(BRIO_ALLOC(t->ctx, *points, n + 1));
    BRIO_TRY(brio_store_open(&t->folder, name, &file));
    BRIO_TRY(brio_store_read(&file, 0, *points, n * sizeof **points));
    brio_store_close(&file);
    brio_store_remove(&t->folder, name);
done:
    brio_store_close(&file);
    return status;
}

static brio_status arrange_tile(brio_tiles *t, uint32_t tile, brio_store_file *out, uint64_t *place) {
    brio_set_point *points = NULL;
    brio_status status = BRIO_OK;
    brio_tile *facts = &t->tile[tile];
    size_t n = facts->raw, first_node = t->num_nodes;
    BRIO_TRY(read_divided(t, tile, &points));
    BRIO_TRY(drop_twins(t, points, &n));
    BRIO_TRY(follow_curve(t, &points, n));
    facts->place = *place;
    facts->points = (uint32_t)n;
    BRIO_TRY(brio_tile_tree_add(t, tile, points));
    note_points(t, facts, points, first_node);
    BRIO_TRY(brio_store_append(out, points, n * sizeof *points));
    t->stats.tiles += n > 0;
    *place += n;
done:
    brio_release(t->ctx, points);
    return status;
}

brio_status brio_tiles_arrange(brio_tiles *t) {
    brio_store_file out = {.file = -1};
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(t->ctx);
    uint64_t place = t->first_place;
    BRIO_TRY(brio_store_create(&t->folder, "points.new", &out));
    out.hashes = t->key != 0;
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        brio_progress_part(t->ctx, bar, (double)i / t->num_tiles, (i + 1.0) / t->num_tiles);
        BRIO_TRY(brio_progress(t->ctx, "arrange", 0));
        BRIO_TRY(arrange_tile(t, i, &out, &place));
    }
    t->stats.dimension = t->num_basis - 1;
    BRIO_TRY(brio_tile_tree_close(t));
    t->points_hash = out.hash;
    status = brio_store_publish(&out, "points");
done:
    brio_store_close(&out);
    brio_progress_part(t->ctx, bar, 0, 1);
    return status;
}
