/* Cuts space into tiles, see cuts.h.
 *
 * Based on: Bentley. Multidimensional binary search trees used for associative searching. CACM 1975. */
#include "tiles/cuts.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include <math.h>
#include <string.h>

enum { MOST_SAMPLE = 1 << 17 /* points. Chosen */ };

/* --- the sample --- */

brio_status brio_tile_cuts_begin(brio_context *ctx, brio_tile_cuts *c) {
    if (!c->sample) BRIO_FORWARD(BRIO_ALLOC(ctx, c->sample, MOST_SAMPLE));
    if (!c->hash) BRIO_FORWARD(BRIO_ALLOC(ctx, c->hash, MOST_SAMPLE));
    c->num_sample = 0;
    c->most_hash = UINT64_MAX;
    return BRIO_OK;
}

static void halve_sample(brio_tile_cuts *c) {
    size_t n = 0;
    c->most_hash /= 2;
    for (size_t i = 0; i < c->num_sample; i++) {
        if (c->hash[i] > c->most_hash) continue;
        memmove(c->sample[n], c->sample[i], sizeof *c->sample);
        c->hash[n++] = c->hash[i];
    }
    c->num_sample = n;
}

void brio_tile_cuts_sample(brio_tile_cuts *c, const double point[3], uint64_t index) {
    uint64_t hash = brio_hash(BRIO_SEED, index);
    if (hash > c->most_hash) return;
    while (c->num_sample == MOST_SAMPLE) halve_sample(c);
    if (hash > c->most_hash) return;
    for (int k = 0; k < 3; k++) c->sample[c->num_sample][k] = point[k] + 0.0;
    c->hash[c->num_sample++] = hash;
}

void brio_tile_cuts_drop_sample(brio_context *ctx, brio_tile_cuts *c) {
    brio_release(ctx, c->sample);
    brio_release(ctx, c->hash);
    c->sample = NULL, c->hash = NULL;
    c->num_sample = 0;
}

double brio_tile_cuts_bytes(uint32_t num_tiles) {
    enum { OF_SAMPLE = 3 * sizeof(double) + 2 * sizeof(uint64_t) /* position, hash, key */ };
    return (double)MOST_SAMPLE * OF_SAMPLE + num_tiles * (double)sizeof(brio_tile_cut);
}

/* --- cuts --- */

/* A part of space: its tiles and its points of the sample. */
typedef struct {
    uint32_t first_tile, num_tiles;
    size_t begin, end;
    brio_tile_home home;
} part;

/* Finds where to cut along an axis so that `share` of the points are below. Returns false if all have one
 * coordinate. */
static bool find_cut(const brio_tile_cuts *c, const part *p, int axis, uint64_t *key, double share, double *at) {
    size_t n = p->end - p->begin, rank = (size_t)(share * (double)n);
    for (size_t i = 0; i < n; i++) key[i] = brio_double_key(c->sample[p->begin + i][axis]);
    brio_sort_keys(key, n);
    while (rank < n && key[rank] == key[0]) rank++;
    if (rank >= n) return false;
    for (size_t i = p->begin; i < p->end; i++)
        if (brio_double_key(c->sample[i][axis]) == key[rank]) *at = c->sample[i][axis] + 0.0;
    return true;
}

/* Chooses the longest side that can be cut. Returns false if all points of the sample coincide. */
static bool choose_cut(const brio_tile_cuts *c, const part *p, uint64_t *key, brio_tile_cut *cut) {
    double low[3], high[3], share = (double)(p->num_tiles / 2) / p->num_tiles;
    bool tried[3] = {false, false, false};
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t i = p->begin; i < p->end; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], c->sample[i][k]);
            high[k] = fmax(high[k], c->sample[i][k]);
        }
    for (int attempt = 0; attempt < 3; attempt++) {
        int axis = -1;
        for (int k = 0; k < 3; k++)
            if (!tried[k] && (axis < 0 || high[k] / 2 - low[k] / 2 > high[axis] / 2 - low[axis] / 2)) axis = k;
        tried[axis] = true;
        cut->axis = axis;
        if (find_cut(c, p, axis, key, share, &cut->at)) return true;
    }
    return false;
}

/* Brings the points of the sample below a cut to the front. Returns where the others begin. */
static size_t partition(brio_tile_cuts *c, const part *p, const brio_tile_cut *cut) {
    size_t n = p->begin;
    for (size_t i = p->begin; i < p->end; i++) {
        if (!(c->sample[i][cut->axis] < cut->at)) continue;
        double swap[3];
        memcpy(swap, c->sample[n], sizeof swap);
        memcpy(c->sample[n++], c->sample[i], sizeof swap);
        memcpy(c->sample[i], swap, sizeof swap);
    }
    return n;
}

/* Cuts a part, and appends its cuts. Returns what names it in a cut. */
static int32_t cut_part(brio_tile_cuts *c, const part *p, uint64_t *key, brio_tile_home *home) {
    brio_tile_cut cut = {.at = -INFINITY}; /* all points above: what coincides is in one tile */
    if (p->num_tiles == 1) {
        if (home) home[p->first_tile] = p->home;
        return -1 - (int32_t)p->first_tile;
    }
    part below = *p, above = *p;
    bool is_cut = choose_cut(c, p, key, &cut);
    below.num_tiles = p->num_tiles / 2;
    above.first_tile += below.num_tiles;
    above.num_tiles -= below.num_tiles;
    below.end = above.begin = partition(c, p, &cut);
    if (is_cut) below.home.high[cut.axis] = above.home.low[cut.axis] = cut.at; /* else above is the whole */
    int32_t at = (int32_t)c->num_cuts++;
    cut.below = cut_part(c, &below, key, home);
    cut.above = cut_part(c, &above, key, home);
    c->cut[at] = cut;
    return at;
}

brio_status brio_tile_cuts_make(brio_context *ctx, brio_tile_cuts *c, uint32_t num_tiles, brio_tile_home *home) {
    uint64_t *key = NULL;
    part whole = {0, num_tiles, 0, c->num_sample, {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}}};
    BRIO_FORWARD(BRIO_ALLOC(ctx, c->cut, num_tiles));
    BRIO_FORWARD(BRIO_ALLOC(ctx, key, c->num_sample + 1));
    c->num_cuts = 0;
    cut_part(c, &whole, key, home);
    brio_release(ctx, key);
    return BRIO_OK;
}

uint32_t brio_tile_cuts_find(const brio_tile_cuts *c, const double point[3]) {
    int32_t at = c->num_cuts ? 0 : -1;
    while (at >= 0) at = point[c->cut[at].axis] < c->cut[at].at ? c->cut[at].below : c->cut[at].above;
    return (uint32_t)(-1 - at);
}

void brio_tile_cuts_free(brio_context *ctx, brio_tile_cuts *c) {
    brio_tile_cuts_drop_sample(ctx, c);
    brio_release(ctx, c->cut);
    c->cut = NULL;
    c->num_cuts = 0;
}
