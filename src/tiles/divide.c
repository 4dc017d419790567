/* Points are taken, sampled, and divided into tiles.
 *
 * The sample is of the points whose index has a small hash: which they are does not depend on the blocks in which the
 * points came. Cuts go through the sample's longest side, so that the tiles get about as many points; points at one
 * position are on one side of every cut.
 *
 * Based on: Bentley. Multidimensional binary search trees used for associative searching. CACM 1975. */
#include "base/finite.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "tiles/work.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { MOST_SAMPLE = 1 << 17, MOST_SOME = 1 << 15 };
enum { BUFFER = 1 << 10, LEAST_BUFFER = 1 << 4, ALL_BUFFERS = 1 << 20 }; /* points. Chosen */

/* --- taking --- */

static void halve_sample(brio_tiles *t) {
    size_t n = 0;
    t->most_hash /= 2;
    for (size_t i = 0; i < t->num_sample; i++) {
        if (t->sample_hash[i] > t->most_hash) continue;
        memmove(t->sample[n], t->sample[i], sizeof *t->sample);
        t->sample_hash[n++] = t->sample_hash[i];
    }
    t->num_sample = n;
}

static void sample_point(brio_tiles *t, const brio_set_point *p) {
    uint64_t hash = brio_hash(BRIO_SEED, p->name);
    if (hash > t->most_hash) return;
    while (t->num_sample == MOST_SAMPLE) halve_sample(t);
    if (hash > t->most_hash) return;
    memcpy(t->sample[t->num_sample], p->record, sizeof *t->sample);
    t->sample_hash[t->num_sample++] = hash;
}

static brio_status flush_raw(brio_tiles *t) {
    brio_status status = brio_store_append(&t->raw, t->some, t->num_some * sizeof *t->some);
    t->num_some = 0;
    return status;
}

static void extend(brio_ball_box *box, const double *record) {
    for (int k = 0; k < 3; k++) {
        if (record[k] < box->low[k]) box->low[k] = record[k];
        if (record[k] > box->high[k]) box->high[k] = record[k];
    }
    if (record[3] > box->weight) box->weight = record[3];
}

static brio_status begin_taking(brio_tiles *t) {
    if (t->some) return BRIO_OK; /* what an earlier call made before it failed is not made again */
    if (t->raw.file < 0) BRIO_FORWARD(brio_store_create(&t->folder, "raw", &t->raw));
    if (!t->sample) BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->sample, MOST_SAMPLE));
    if (!t->sample_hash) BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->sample_hash, MOST_SAMPLE));
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->some, MOST_SOME));
    t->most_hash = UINT64_MAX;
    for (int k = 0; k < 3; k++) t->all.low[k] = INFINITY, t->all.high[k] = -INFINITY;
    t->all.weight = t->weighted ? -INFINITY : 0;
    t->lightest = t->weighted ? INFINITY : 0;
    return BRIO_OK;
}

brio_status brio_tiles_take(brio_tiles *t, const double *points, const double *weights, size_t num_points,
                            uint64_t first) {
    BRIO_FORWARD(begin_taking(t));
    for (size_t i = 0; i < num_points; i++) {
        brio_set_point *p = &t->some[t->num_some];
        for (size_t k = 0; k < 3; k++) p->record[k] = points[3 * i + k] + 0.0;
        p->record[3] = weights ? weights[i] + 0.0 : 0.0;
        p->name = first + i;
        static const char *const NAME[4] = {"x", "y", "z", "the weight"};
        for (int k = 0; k < 4; k++)
            BRIO_EXPECT(t->ctx, isfinite(p->record[k]), BRIO_ERR_NOT_FINITE, "point %llu: %s is %s",
                        (unsigned long long)p->name, NAME[k], isnan(p->record[k]) ? "NaN" : "infinite");
        t->stats.points++;
        extend(&t->all, p->record);
        if (p->record[3] < t->lightest) t->lightest = p->record[3];
        sample_point(t, p);
        if (++t->num_some == MOST_SOME) BRIO_FORWARD(flush_raw(t));
        BRIO_FORWARD(brio_look(t->ctx, 1));
    }
    return BRIO_OK;
}

brio_status brio_tiles_end_taking(brio_tiles *t) {
    BRIO_FORWARD(begin_taking(t));
    return flush_raw(t);
}

brio_status brio_tiles_read_raw(brio_tiles *t, uint64_t from, size_t *count) {
    uint64_t left = t->stats.points - from;
    *count = left < MOST_SOME ? (size_t)left : MOST_SOME;
    return brio_store_read(&t->raw, from * sizeof *t->some, t->some, *count * sizeof *t->some);
}

void brio_tiles_drop_raw(brio_tiles *t) {
    brio_store_close(&t->raw);
    brio_store_remove(&t->folder, "raw");
    brio_release(t->ctx, t->some);
    brio_release(t->ctx, t->sample);
    brio_release(t->ctx, t->sample_hash);
    t->some = NULL, t->sample = NULL, t->sample_hash = NULL;
}

/* --- cuts --- */

/* A part of space: its tiles and its points of the sample. */
typedef struct {
    uint32_t first_tile, num_tiles;
    size_t begin, end;
    brio_ball_box home;
} part;

/* Finds where to cut along an axis so that `share` of the points are below. Returns false if all have one coordinate.
 * */
static bool find_cut(const brio_tiles *t, const part *p, int axis, uint64_t *key, double share, double *at) {
    size_t n = p->end - p->begin, rank = (size_t)(share * (double)n);
    for (size_t i = 0; i < n; i++) key[i] = brio_double_key(t->sample[p->begin + i][axis]);
    brio_sort_keys(key, n);
    while (rank < n && key[rank] == key[0]) rank++;
    if (rank >= n) return false;
    for (size_t i = p->begin; i < p->end; i++)
        if (brio_double_key(t->sample[i][axis]) == key[rank]) *at = t->sample[i][axis] + 0.0;
    return true;
}

/* Chooses the longest side that can be cut. Returns false if all points of the sample coincide. */
static bool choose_cut(const brio_tiles *t, const part *p, uint64_t *key, brio_tile_cut *cut) {
    double low[3], high[3], share = (double)(p->num_tiles / 2) / p->num_tiles;
    bool tried[3] = {false, false, false};
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t i = p->begin; i < p->end; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], t->sample[i][k]);
            high[k] = fmax(high[k], t->sample[i][k]);
        }
    for (int attempt = 0; attempt < 3; attempt++) {
        int axis = -1;
        for (int k = 0; k < 3; k++)
            if (!tried[k] && (axis < 0 || high[k] / 2 - low[k] / 2 > high[axis] / 2 - low[axis] / 2)) axis = k;
        tried[axis] = true;
        cut->axis = axis;
        if (find_cut(t, p, axis, key, share, &cut->at)) return true;
    }
    return false;
}

/* Brings the points of the sample below a cut to the front. Returns where the others begin. */
static size_t partition(brio_tiles *t, const part *p, const brio_tile_cut *cut) {
    size_t n = p->begin;
    for (size_t i = p->begin; i < p->end; i++) {
        if (!(t->sample[i][cut->axis] < cut->at)) continue;
        double swap[3];
        memcpy(swap, t->sample[n], sizeof swap);
        memcpy(t->sample[n++], t->sample[i], sizeof swap);
        memcpy(t->sample[i], swap, sizeof swap);
    }
    return n;
}

/* Cuts a part, and appends its cuts. Returns what names it in a cut. */
static int32_t cut_part(brio_tiles *t, const part *p, uint64_t *key, brio_ball_box *home) {
    brio_tile_cut cut = {.at = -INFINITY}; /* all points above: what coincides is in one tile */
    if (p->num_tiles == 1) {
        home[p->first_tile] = p->home;
        return -1 - (int32_t)p->first_tile;
    }
    part below = *p, above = *p;
    bool is_cut = choose_cut(t, p, key, &cut);
    below.num_tiles = p->num_tiles / 2;
    above.first_tile += below.num_tiles;
    above.num_tiles -= below.num_tiles;
    below.end = above.begin = partition(t, p, &cut);
    if (is_cut) below.home.high[cut.axis] = above.home.low[cut.axis] = cut.at; /* else above is the whole */
    int32_t at = (int32_t)t->num_cuts++;
    cut.below = cut_part(t, &below, key, home);
    cut.above = cut_part(t, &above, key, home);
    t->cut[at] = cut;
    return at;
}

brio_status brio_tiles_cut(brio_tiles *t, uint32_t num_tiles, brio_ball_box *home) {
    uint64_t *key = NULL;
    part whole = {0,
                  num_tiles,
                  0,
                  t->num_sample,
                  {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}, t->all.weight}};
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->cut, num_tiles));
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, key, t->num_sample + 1));
    t->num_cuts = 0;
    cut_part(t, &whole, key, home);
    brio_release(t->ctx, key);
    return BRIO_OK;
}

static brio_status cut_space(brio_tiles *t) {
    brio_ball_box *home = NULL;
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, home, t->num_tiles));
    brio_status status = brio_tiles_cut(t, t->num_tiles, home);
    for (uint32_t i = 0; status == BRIO_OK && i < t->num_tiles; i++) t->tile[i].home = home[i];
    brio_release(t->ctx, home);
    return status;
}

uint32_t brio_tiles_tile_of(const brio_tiles *t, const double *record) {
    int32_t at = t->num_cuts ? 0 : -1;
    while (at >= 0) at = record[t->cut[at].axis] < t->cut[at].at ? t->cut[at].below : t->cut[at].above;
    return (uint32_t)(-1 - at);
}

/* --- distribution --- */

struct brio_tile_tray {
    brio_store_file file;
    brio_set_point *buffer;
    size_t count, room;
};

typedef brio_tile_tray tray;

/* Returns how many points wait for each tile's file: few if there are many tiles, so that all together fit. */
static size_t room_of_tray(const brio_tiles *t) {
    size_t share = ALL_BUFFERS / t->num_tiles;
    return share < LEAST_BUFFER ? LEAST_BUFFER : share < BUFFER ? share : BUFFER;
}

brio_status brio_tile_trays_new(brio_tiles *t, brio_tile_tray **out) {
    char name[32];
    BRIO_FORWARD(BRIO_ALLOC_ZERO(t->ctx, *out, t->num_tiles));
    tray *trays = *out;
    for (uint32_t i = 0; i < t->num_tiles; i++) trays[i].file.file = -1;
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        snprintf(name, sizeof name, "divided-%u", i);
        BRIO_FORWARD(brio_store_create(&t->folder, name, &trays[i].file));
        brio_store_shut(&trays[i].file);
        trays[i].room = room_of_tray(t);
        BRIO_FORWARD(BRIO_ALLOC(t->ctx, trays[i].buffer, trays[i].room));
    }
    return BRIO_OK;
}

brio_status brio_tile_trays_put(brio_tiles *t, brio_tile_tray *trays, uint32_t tile, const brio_set_point *p) {
    tray *tr = &trays[tile];
    t->tile[tile].raw++;
    tr->buffer[tr->count++] = *p;
    if (tr->count < tr->room) return BRIO_OK;
    tr->count = 0;
    return brio_store_append(&tr->file, tr->buffer, tr->room * sizeof *p);
}

brio_status brio_tile_trays_end(brio_tiles *t, brio_tile_tray *trays) {
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_FORWARD(brio_store_append(&trays[i].file, trays[i].buffer, trays[i].count * sizeof(brio_set_point)));
        trays[i].count = 0;
    }
    return BRIO_OK;
}

void brio_tile_trays_free(brio_tiles *t, brio_tile_tray *trays) {
    for (uint32_t i = 0; trays && i < t->num_tiles; i++) {
        brio_store_close(&trays[i].file);
        brio_release(t->ctx, trays[i].buffer);
    }
    brio_release(t->ctx, trays);
}

static brio_status distribute(brio_tiles *t, tray *trays) {
    size_t some;
    for (uint64_t done = 0; done < t->stats.points; done += some) {
        BRIO_FORWARD(brio_progress(t->ctx, "divide", (double)done / (double)t->stats.points));
        BRIO_FORWARD(brio_tiles_read_raw(t, done, &some));
        for (size_t i = 0; i < some; i++)
            BRIO_FORWARD(brio_tile_trays_put(t, trays, brio_tiles_tile_of(t, t->some[i].record), &t->some[i]));
    }
    return brio_tile_trays_end(t, trays);
}

brio_status brio_tiles_divide(brio_tiles *t) {
    tray *trays = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_tiles_end_taking(t));
    BRIO_TRY(cut_space(t));
    BRIO_TRY(brio_tile_trays_new(t, &trays));
    BRIO_TRY(distribute(t, trays));
    brio_tiles_drop_raw(t);
done:
    brio_tile_trays_free(t, trays);
    return status;
}
