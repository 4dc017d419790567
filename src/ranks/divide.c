/* Points go to the ranks of their tiles, and all ranks come to know the upper nodes of all tiles.
 *
 * The sample by which space is cut is of the points whose index has a small hash: neither the number of ranks nor how
 * points came to them has any part in it. Its size is chosen below what each rank keeps, so all ranks cut alike. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "ranks/work.h"
#include <string.h>

enum { SAMPLE = 60000 }; /* points of all ranks together. Chosen: below half of what a rank keeps */

/* --- what there is --- */

typedef struct {
    uint64_t points, weighted, most_hash;
    brio_ball_box all;
    double lightest;
} head;

static brio_status add_heads(brio_ranks *r, uint64_t *points, uint64_t *most_hash) {
    brio_tiles *t = r->t;
    head mine = {t->stats.points, t->weighted, t->cuts.most_hash, t->all, t->lightest};
    BRIO_FORWARD(brio_exchange_all(&r->x, &mine, sizeof mine));
    *points = 0;
    *most_hash = UINT64_MAX;
    for (int k = 0; k < 3; k++) t->all.low[k] = INFINITY, t->all.high[k] = -INFINITY;
    t->all.weight = -INFINITY, t->lightest = INFINITY;
    int with = -1, without = -1;
    for (int i = 0; i < r->ranks; i++) {
        head h;
        memcpy(&h, r->x.from[i]->bytes, sizeof h);
        if (h.most_hash < *most_hash) *most_hash = h.most_hash;
        if (!h.points) continue;
        *points += h.points;
        if (h.weighted)
            with = i;
        else
            without = i;
        for (int k = 0; k < 3; k++) {
            t->all.low[k] = fmin(t->all.low[k], h.all.low[k]);
            t->all.high[k] = fmax(t->all.high[k], h.all.high[k]);
        }
        t->all.weight = fmax(t->all.weight, h.all.weight);
        t->lightest = fmin(t->lightest, h.lightest);
    }
    if (!*points) t->all.weight = t->lightest = 0;
    BRIO_EXPECT(r->ctx, with < 0 || without < 0, BRIO_ERR_ARGUMENT,
                "the points of rank %d have weights, and those of rank %d have none", with, without);
    t->weighted = with >= 0;
    return BRIO_OK;
}

/* --- the sample and the cuts --- */

static brio_status gather_sample(brio_ranks *r, uint64_t points, uint64_t most_hash) {
    brio_tiles *t = r->t;
    size_t n = 0;
    if (points > SAMPLE) {
        uint64_t share = UINT64_MAX / points * SAMPLE;
        if (share < most_hash) most_hash = share;
    }
    for (size_t i = 0; i < t->cuts.num_sample; i++)
        if (t->cuts.hash[i] <= most_hash) memmove(t->cuts.sample[n++], t->cuts.sample[i], sizeof *t->cuts.sample);
    BRIO_FORWARD(brio_exchange_all(&r->x, t->cuts.sample, n * sizeof *t->cuts.sample));
    n = 0;
    for (int i = 0; i < r->ranks; i++) n += r->x.from[i]->size;
    brio_release(r->ctx, t->cuts.sample);
    BRIO_FORWARD(BRIO_ALLOC(r->ctx, t->cuts.sample, n / sizeof *t->cuts.sample + 1));
    t->cuts.num_sample = 0;
    for (int i = 0; i < r->ranks; i++) {
        const brio_letter *m = r->x.from[i];
        if (m->size) memcpy(t->cuts.sample + t->cuts.num_sample, m->bytes, m->size);
        t->cuts.num_sample += m->size / sizeof *t->cuts.sample;
    }
    return BRIO_OK;
}

static brio_status cut(brio_ranks *r) {
    brio_tiles *t = r->t;
    uint32_t all = (uint32_t)r->ranks * t->num_tiles, first = (uint32_t)r->rank * t->num_tiles;
    brio_ball_box *home = NULL;
    BRIO_FORWARD(BRIO_ALLOC(r->ctx, home, all));
    brio_status status = brio_tiles_cut(t, all, home);
    for (uint32_t i = 0; status == BRIO_OK && i < t->num_tiles; i++) t->tile[i].home = home[first + i];
    brio_release(r->ctx, home);
    return status;
}

/* --- points on their way --- */

static brio_status take_points(brio_ranks *r, brio_tile_tray *trays) {
    for (int i = 0; i < r->ranks; i++) {
        const brio_letter *m = &r->x.received[i];
        const brio_set_point *p = m->bytes;
        for (size_t k = 0; k < m->size / sizeof *p; k++) {
            uint32_t tile = brio_tile_cuts_find(&r->t->cuts, p[k].record) % r->t->num_tiles;
            BRIO_FORWARD(brio_tile_trays_put(r->t, trays, tile, &p[k]));
        }
    }
    return BRIO_OK;
}

/* Sends the raw points, some at a time, until no rank has any left. */
static brio_status send_points(brio_ranks *r, brio_tile_tray *trays) {
    brio_tiles *t = r->t;
    uint64_t done = 0;
    do {
        size_t some;
        BRIO_FORWARD(brio_progress(r->ctx, "divide", (double)done / ((double)t->stats.points + 1)));
        BRIO_FORWARD(brio_tiles_read_raw(t, done, &some));
        for (size_t i = 0; i < some; i++) {
            int to = (int)(brio_tile_cuts_find(&t->cuts, t->some[i].record) / t->num_tiles);
            BRIO_FORWARD(brio_exchange_put(&r->x, to, &t->some[i], sizeof t->some[i]));
        }
        done += some;
        BRIO_FORWARD(brio_exchange_now(&r->x, done < t->stats.points));
        BRIO_FORWARD(take_points(r, trays));
    } while (r->x.any);
    return brio_tile_trays_end(t, trays);
}

brio_status brio_ranks_divide(brio_ranks *r) {
    brio_tile_tray *trays = NULL;
    brio_status status = BRIO_OK;
    uint64_t points, most_hash;
    BRIO_TRY(brio_tiles_end_taking(r->t));
    BRIO_TRY(add_heads(r, &points, &most_hash));
    BRIO_TRY(brio_tiles_require_disk(r->t, (double)points / r->ranks));
    BRIO_TRY(gather_sample(r, points, most_hash));
    BRIO_TRY(cut(r));
    BRIO_TRY(brio_tile_trays_new(r->t, &trays));
    BRIO_TRY(send_points(r, trays));
    brio_tiles_drop_raw(r->t);
done:
    brio_tile_trays_free(r->t, trays);
    return status;
}

/* --- joining --- */

typedef struct {
    uint64_t points, duplicates, num_basis;
    brio_set_point basis[4], extreme[TILE_DIRECTIONS];
} ends;

/* Makes the extreme points and the basis those of all ranks. */
static brio_status join_ends(brio_ranks *r) {
    brio_tiles *t = r->t;
    brio_filter f;
    ends e = {t->stats.points, t->stats.duplicates, (uint64_t)t->num_basis, {{{0}, 0}}, {{{0}, 0}}};
    memcpy(e.basis, t->basis, sizeof e.basis);
    memcpy(e.extreme, t->extreme, sizeof e.extreme);
    BRIO_FORWARD(brio_exchange_all(&r->x, &e, sizeof e));
    r->facts.points = r->facts.duplicates = 0;
    t->num_basis = 0;
    brio_tiles_filter(t, &f);
    for (int i = 0; i < r->ranks; i++) {
        memcpy(&e, r->x.from[i]->bytes, sizeof e);
        r->facts.points += e.points;
        r->facts.duplicates += e.duplicates;
        for (uint64_t k = 0; k < e.num_basis; k++) brio_tiles_note(t, &f, &e.basis[k]);
        for (int d = 0; e.num_basis && d < TILE_DIRECTIONS; d++) brio_tiles_note(t, &f, &e.extreme[d]);
    }
    t->stats.dimension = r->facts.dimension = t->num_basis - 1;
    return BRIO_OK;
}

static int compare_positions(uint32_t i, uint32_t j, const void *user) {
    const double(*x)[3] = user;
    return brio_lexicographic(x[i], x[j]);
}

/* Chooses the splitters among the samples of all upper nodes. */
static brio_status choose_splitters(brio_ranks *r) {
    size_t n = 0, count = 0;
    double(*sample)[3] = NULL;
    uint32_t *row = NULL;
    brio_status status = BRIO_OK;
    for (int i = 0; i < r->ranks; i++) count += r->x.from[i]->size / sizeof(brio_tile_node);
    BRIO_TRY(BRIO_ALLOC(r->ctx, sample, count + 1));
    BRIO_TRY(BRIO_ALLOC(r->ctx, row, count + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, r->splitter, r->ranks));
    for (int i = 0; i < r->ranks; i++) {
        const brio_tile_node *node = r->x.from[i]->bytes;
        for (size_t k = 0; k < r->x.from[i]->size / sizeof *node; k++)
            if (!node[k].children) memcpy(sample[n++], node[k].sample.record, sizeof *sample);
    }
    for (size_t i = 0; i < n; i++) row[i] = (uint32_t)i;
    if (n) BRIO_TRY(brio_sort_rows(r->ctx, &(brio_row_order){*sample, 3, compare_positions, sample}, row, n));
    for (int i = 1; n && i < r->ranks; i++)
        memcpy(r->splitter[i - 1], sample[row[n * (size_t)i / (size_t)r->ranks]], sizeof *sample);
done:
    brio_release(r->ctx, sample);
    brio_release(r->ctx, row);
    return status;
}

/* Appends the upper nodes of other ranks, and nodes over all. */
static brio_status append_far(brio_ranks *r, brio_tile_roots *roots) {
    brio_tiles *t = r->t;
    for (int i = 0; i < r->ranks; i++) {
        const brio_letter *m = r->x.from[i];
        if (i != r->rank) BRIO_FORWARD(brio_tile_tree_far(t, m->bytes, m->size / sizeof *t->node, i, roots));
        for (uint32_t k = 0; i == r->rank && k < t->num_tiles; k++)
            if (t->tile[k].points) BRIO_FORWARD(brio_tile_roots_add(t, roots, t->tile[k].root));
    }
    return roots->count ? brio_tile_tree_join(t, roots) : BRIO_OK;
}

/* Forgets the nodes of other ranks, and those over all, that a run before appended, which failed later. */
static void leave_far(brio_ranks *r) {
    brio_tiles *t = r->t;
    if (!r->joined) r->own_nodes = t->num_nodes;
    r->joined = true;
    r->own_root = r->own_nodes ? (uint32_t)r->own_nodes - 1 : TILE_NONE;
    t->num_nodes = r->own_nodes;
    for (size_t i = 0; i < t->num_nodes; i++)
        if (t->node[i].tile != TILE_NONE) t->tile[t->node[i].tile].root = (uint32_t)i;
    brio_release(r->ctx, r->splitter);
    r->splitter = NULL;
}

brio_status brio_ranks_join(brio_ranks *r) {
    brio_tiles *t = r->t;
    brio_tile_node *upper = NULL;
    brio_tile_roots roots = {.count = 0};
    size_t count = 0;
    brio_status status = BRIO_OK;
    leave_far(r);
    BRIO_TRY(join_ends(r));
    BRIO_TRY(brio_tile_tree_upper(t, &upper, &count));
    BRIO_TRY(brio_exchange_all(&r->x, upper, count * sizeof *upper));
    BRIO_TRY(choose_splitters(r));
    status = append_far(r, &roots);
done:
    brio_release(r->ctx, upper);
    brio_release(r->ctx, roots.node);
    return status;
}
