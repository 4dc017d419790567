/* The noise of samples: measuring and reducing it.
 *
 * Measuring. At some samples, surfaces are fitted to few and to more nearest points. On a smooth or edged surface the
 * larger fit is the worse one, because the surface bends. Where points scatter about a surface, they scatter as much
 * about a large piece as about a small one. So a deviation that does not grow with the size of the piece is noise,
 * unless the points are on two sheets, one close behind the other (two_layers.c): two clean layers, as walls have, and
 * not those of scans that do not fit together.
 *
 * Reducing. Every sample moves along the normal of the surface fitted to its nearest points onto that surface, PASSES
 * times. The nearest points are found once, before the first pass. Noise shrinks with the square root of the number of
 * nearest points. The fit preserves shape up to the second order; edges become as round as a piece is wide.
 *
 * Based on: Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva. Computing and rendering point set surfaces. TVCG 2003.
 *           Mederos, Velho, de Figueiredo. Smooth surface reconstruction from noisy clouds. JBCS 2004 (samples are
 *           moved onto local polynomials before the surface is made). */
#include "reconstruct/noise/sample_noise.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/vector.h"
#include "query/point_boxes.h"
#include "reconstruct/noise/local_surface.h"
#include "reconstruct/noise/two_layers.h"
#include <math.h>
#include <string.h>

/* FLAT: points that a plane is fitted to. FEW, MORE: points of the small and the large piece. NEAREST: distances in the
 * mean that is the spacing. LOOKS, LEAST_LOOKS: about how many samples are measured, and the fewest that count. PASSES:
 * of smoothing. BLOCK: samples between two calls of the progress callback. All chosen, with the shared models in view
 * (docs/decisions/007-noise-is-smoothed.md). */
enum {
    FLAT = 9,
    FEW = 24,
    MORE = 48,
    NEAREST = 6,
    LOOKS = 1000,
    LEAST_LOOKS = 100,
    PASSES = 2,
    BLOCK = 1 << 20,
    RUN = 256,
    LOOKS_A_THREAD = 16,
    SAMPLES_A_THREAD = 1 << 13
};
/* In spacings. Below LEAST_LEVEL a crust through the samples is as good; above MOST_LEVEL no surface is visible. Chosen
 * on the shared models (docs/decisions/007-noise-is-smoothed.md). */
static const double LEAST_LEVEL = 0.1, MOST_LEVEL = 0.5;

/* Points that are split in two layers. If the layers explain more than LAYERED of the variance, they are two sheets: of
 * one sheet with Gaussian noise, fewer than 2 in 100 are taken for two. */
enum { SPLITS = 3 };
static const size_t SPLIT[SPLITS] = {16, 24, MORE};
static const double LAYERED[SPLITS] = {0.88, 0.85, 0.85};

/* If over half of the samples have points over APART spacings from their plane, and of these points less than EMPTY are
 * near the plane, two sheets are most of what there is. The shared models reach 0.186 where they are one sheet, uniform
 * noise
 * 0.17; models with walls of one and two spacings 0.137, and 0.083. */
static const double APART = 0.25, EMPTY = 0.16;

/* A layer is clean if it scatters by under CLEAN of what both layers do together. Layers of scans that do not fit
 * together are not: each has its scanner's noise, and they are one sheet. Chosen. */
static const double CLEAN = 0.15;

/* --- how much --- */

/* The samples that are measured, and the results as the bits of doubles: bits of doubles that are not negative sort as
 * the doubles do. */
typedef struct {
    uint64_t *hash; /* hash of the sample's position */
    uint32_t *sample;
    size_t count, hash_capacity, capacity;
    uint64_t *few, *more;     /* standard deviations from the small and the large piece, in spacings */
    uint64_t *flat;           /* standard deviations of FLAT points from a plane, in spacings */
    uint64_t *layer;          /* the same of points of one layer, where there are two; else as flat */
    float *scatter;           /* of a layer by that of both; -1 where there is one */
    float (*central)[SPLITS]; /* the share of points near their plane; 1 where all are */
} looks;

static uint64_t hash_of(const double *p) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) hash = brio_hash(hash, brio_double_key(p[k]));
    return hash;
}

typedef struct {
    const double *points;
    size_t count;
    uint8_t *chosen; /* of each point: whether it is measured */
} choosing;

static void choose_part(void *user, size_t begin, size_t end, int thread) {
    const choosing *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) c->chosen[i] = hash_of(c->points + 3 * i) % c->count < LOOKS;
}

static brio_status list_chosen(brio_context *ctx, const choosing *c, looks *l) {
    brio_status status = BRIO_OK;
    for (size_t i = 0; i < c->count; i++) {
        if (!c->chosen[i]) continue;
        BRIO_TRY(BRIO_RESERVE(ctx, l->hash, l->hash_capacity, l->count + 1));
        BRIO_TRY(BRIO_RESERVE(ctx, l->sample, l->capacity, l->count + 1));
        l->hash[l->count] = hash_of(c->points + 3 * i);
        l->sample[l->count++] = (uint32_t)i;
    }
done:
    return status;
}

/* Chooses about LOOKS positions by their hash, so that the order of the samples does not matter. Each position is
 * chosen once. */
static brio_status choose_samples(brio_context *ctx, const double *points, size_t n, looks *l) {
    brio_status status = BRIO_OK;
    choosing c = {.points = points, .count = n};
    BRIO_TRY(BRIO_ALLOC(ctx, c.chosen, n));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, n, SAMPLES_A_THREAD), n, choose_part, &c));
    BRIO_TRY(list_chosen(ctx, &c, l));
    if (l->count == 0) goto done;
    BRIO_TRY(brio_radix_sort(ctx, l->hash, l->sample, l->count, 64));
    size_t kept = 1;
    for (size_t i = 1; i < l->count; i++)
        if (l->hash[i] != l->hash[i - 1]) l->sample[kept++] = l->sample[i];
    l->count = kept;
done:
    brio_release(ctx, c.chosen);
    return status;
}

static double mean_spacing(const brio_near_point *near, size_t count) {
    double sum = 0;
    int apart = 0;
    for (size_t i = 0; i < count && apart < NEAREST; i++)
        if (near[i].square > 0) sum += sqrt(near[i].square), apart++;
    return apart ? sum / apart : 0;
}

static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Copies the first `count` points of a list, relative to p. */
static void see_from(const double *p, const brio_point_boxes *boxes, const brio_near_point *near, size_t count,
                     brio_neighbourhood *n) {
    n->count = 0;
    for (size_t i = 0; i < count; i++) brio_add_neighbour(n, p, boxes->point[near[i].place]);
}

static bool spread_about(const double *p, const brio_point_boxes *boxes, const brio_near_point *near, size_t count,
                         double *spread) {
    brio_neighbourhood n;
    brio_local_surface surface;
    bool fitted;
    see_from(p, boxes, near, count, &n);
    brio_fit_local_surfaces(&n, 1, &surface, &fitted);
    if (fitted) *spread = brio_local_spread(&n, &surface);
    return fitted;
}

/* Splits the points near p in layers, and copies FLAT of the layer that p is in. Writes the share of points near the
 * planes of more. Returns the standard deviation of both layers together; 0 if there is one. */
static double split_layers(const double *p, const brio_point_boxes *boxes, const brio_near_point *near, double spacing,
                           float *central, brio_neighbourhood *own) {
    brio_neighbourhood n;
    brio_two_layers layers;
    double both = 0;
    own->count = 0;
    for (int s = 0; s < SPLITS; s++) {
        see_from(p, boxes, near, SPLIT[s], &n);
        bool split = brio_split_layers(&n, &layers);
        central[s] = split && layers.spread > APART * spacing ? (float)layers.central : 1;
        if (own->count > 0 || !split || layers.share < LAYERED[s]) continue;
        both = layers.spread;
        for (size_t i = 0; i < n.count && own->count < FLAT; i++)
            if ((layers.height[i] > layers.cut) == (layers.height[0] > layers.cut))
                brio_add_neighbour(own, p, boxes->point[near[i].place]);
    }
    return both;
}

/* Measures how flat the points near the i-th sample are, all of them, and those of its layer. */
static void look_flat(const double *p, const brio_point_boxes *boxes, const brio_near_point *near, double spacing,
                      const looks *l, size_t i) {
    brio_neighbourhood n;
    double both = split_layers(p, boxes, near, spacing, l->central[i], &n), spread = INFINITY;
    if (both > 0) {
        if (n.count == FLAT) spread = brio_plane_spread(&n);
        l->layer[i] = bits_of(spread / spacing);
        l->scatter[i] = n.count == FLAT ? (float)(spread / both) : -1;
    }
    see_from(p, boxes, near, FLAT, &n);
    l->flat[i] = bits_of(brio_plane_spread(&n) / spacing);
    if (both == 0) l->layer[i] = l->flat[i];
}

/* Computes the standard deviations of the points near the i-th sample that is measured; infinite where a fit fails. */
static void look(const brio_point_boxes *boxes, const looks *l, size_t i) {
    brio_near_point near[BRIO_NEAR_ROOM];
    const double *p = boxes->point[l->sample[i]];
    uint64_t *few = l->few + i, *more = l->more + i;
    double small, large;
    size_t count = brio_nearest_in_boxes(boxes, l->sample[i], MORE, near);
    double spacing = mean_spacing(near, count);
    *few = *more = l->flat[i] = l->layer[i] = bits_of(INFINITY);
    l->scatter[i] = -1;
    for (int s = 0; s < SPLITS; s++) l->central[i][s] = 1;
    if (count < MORE || !(spacing > 0)) return;
    look_flat(p, boxes, near, spacing, l, i);
    if (!spread_about(p, boxes, near, FEW, &small) || !spread_about(p, boxes, near, MORE, &large)) return;
    *few = bits_of(small / spacing);
    *more = bits_of(large / spacing);
}

typedef struct {
    const brio_point_boxes *boxes;
    const looks *looks;
} looking;

static void look_at_some(void *user, size_t begin, size_t end, int thread) {
    const looking *a = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) look(a->boxes, a->looks, i);
}

/* Measures about LOOKS samples. l->count is 0 if there are too few.   l  freed with free_looks, on failure too. */
static brio_status look_around(brio_context *ctx, const double *points, size_t count, looks *l) {
    brio_status status = BRIO_OK;
    brio_point_boxes boxes = {0};
    BRIO_TRY(choose_samples(ctx, points, count, l));
    if (l->count < LEAST_LOOKS) l->count = 0;
    if (l->count == 0) goto done;
    BRIO_TRY(BRIO_ALLOC(ctx, l->few, l->count));
    BRIO_TRY(BRIO_ALLOC(ctx, l->more, l->count));
    BRIO_TRY(BRIO_ALLOC(ctx, l->flat, l->count));
    BRIO_TRY(BRIO_ALLOC(ctx, l->layer, l->count));
    BRIO_TRY(BRIO_ALLOC(ctx, l->scatter, l->count));
    BRIO_TRY(BRIO_ALLOC(ctx, l->central, l->count));
    BRIO_TRY(brio_point_boxes_new(ctx, points, count, &boxes));
    looking all = {&boxes, l};
    BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, l->count, LOOKS_A_THREAD), l->count, LOOKS_A_THREAD, look_at_some,
                             &all));
done:
    brio_point_boxes_free(ctx, &boxes);
    return status;
}

static void free_looks(brio_context *ctx, looks *l) {
    brio_release(ctx, l->hash);
    brio_release(ctx, l->sample);
    brio_release(ctx, l->few);
    brio_release(ctx, l->more);
    brio_release(ctx, l->flat);
    brio_release(ctx, l->layer);
    brio_release(ctx, l->scatter);
    brio_release(ctx, l->central);
}

/* Returns the value that a share of all values are below. */
static double quantile(uint64_t *bits, size_t count, double share) {
    double x;
    brio_sort_keys(bits, count);
    memcpy(&x, bits + (size_t)((double)count * share), sizeof x);
    return x;
}

/* Returns whether most of the points are on two sheets, one close behind the other. */
static bool is_layered(const looks *l) {
    for (int s = 0; s < SPLITS; s++) {
        double sum = 0;
        size_t apart = 0;
        for (size_t i = 0; i < l->count; i++)
            if (l->central[i][s] < 1) sum += (double)l->central[i][s], apart++;
        if (2 * apart > l->count && sum < EMPTY * (double)apart) return true;
    }
    return false;
}

/* Returns whether most layers are clean, so that they are sheets. */
static bool are_clean(const looks *l) {
    size_t clean = 0, all = 0;
    for (size_t i = 0; i < l->count; i++) {
        all += l->scatter[i] >= 0;
        clean += l->scatter[i] >= 0 && (double)l->scatter[i] < CLEAN;
    }
    return 2 * clean > all;
}

brio_status brio_noise_level(brio_context *ctx, const double *points, size_t count, double *level) {
    brio_status status = BRIO_OK;
    looks l = {0};
    *level = 0;
    BRIO_TRY(look_around(ctx, points, count, &l));
    if (l.count == 0 || is_layered(&l)) goto done;
    double small = quantile(l.few, l.count, 0.5), large = quantile(l.more, l.count, 0.5);
    if (large >= LEAST_LEVEL && large <= MOST_LEVEL && large <= small) *level = large;
done:
    free_looks(ctx, &l);
    return status;
}

brio_status brio_least_noise(brio_context *ctx, const double *points, size_t count, brio_least_scatter *out) {
    brio_status status = BRIO_OK;
    looks l = {0};
    *out = (brio_least_scatter){0};
    BRIO_TRY(look_around(ctx, points, count, &l));
    if (l.count == 0) goto done;
    bool layered = is_layered(&l);
    uint64_t *spread = layered || are_clean(&l) ? l.layer : l.flat;
    *out = (brio_least_scatter){.level = quantile(spread, l.count, 0.1), .layered = layered};
done:
    free_looks(ctx, &l);
    return status;
}

/* --- less --- */

/* The samples in the order of their tree, before and after a pass. */
typedef struct {
    const brio_point_tree *tree;
    uint32_t (*near)[MORE]; /* the nearest points of each sample, found in the first pass */
    double (*from)[3], (*to)[3];
} smoothing;

/* Finds the nearest points of samples begin to end - 1. The radius found at one sample bounds the search at the next
 * sample, which is usually near. */
static void find_near(const smoothing *s, size_t begin, size_t end) {
    static const double ROUNDING = 1 + 1e-9;
    brio_near_point near[BRIO_NEAR_ROOM];
    double radius = INFINITY; /* of the ball about the last sample that holds its MORE nearest points */
    for (size_t i = begin; i < end; i++) {
        double most = 0, reach = i > begin ? radius + sqrt(brio_square_distance(s->from[i], s->from[i - 1])) : INFINITY;
        brio_nearest_points(s->tree, s->from[i], MORE, ROUNDING * reach * reach, near);
        for (int n = 0; n < MORE; n++) {
            s->near[i][n] = near[n].place;
            most = near[n].square > most ? near[n].square : most;
        }
        radius = sqrt(most);
    }
}

/* Moves the samples begin to end - 1, at most BRIO_SURFACE_BATCH. */
static void smooth_batch(const smoothing *s, size_t begin, size_t end) {
    brio_neighbourhood n[BRIO_SURFACE_BATCH];
    brio_local_surface surface[BRIO_SURFACE_BATCH];
    bool fitted[BRIO_SURFACE_BATCH];
    for (size_t i = begin; i < end; i++) {
        n[i - begin].count = 0;
        for (int j = 0; j < MORE; j++) brio_add_neighbour(&n[i - begin], s->from[i], s->from[s->near[i][j]]);
    }
    brio_fit_local_surfaces(n, end - begin, surface, fitted);
    for (size_t i = begin; i < end; i++) {
        memcpy(s->to[i], s->from[i], sizeof s->to[i]);
        if (fitted[i - begin]) brio_move_onto(&surface[i - begin], s->to[i]);
    }
}

typedef struct {
    const smoothing *smoothing;
    size_t first; /* first sample of the block */
    bool finds;   /* whether this pass finds the nearest points */
} smoothing_run;

static void smooth_run(void *user, size_t begin, size_t end, int thread) {
    const smoothing_run *r = user;
    (void)thread;
    if (r->finds) find_near(r->smoothing, r->first + begin, r->first + end);
    for (size_t n = begin; n < end; n += BRIO_SURFACE_BATCH)
        smooth_batch(r->smoothing, r->first + n,
                     r->first + (end - n < BRIO_SURFACE_BATCH ? end : n + BRIO_SURFACE_BATCH));
}

/* Moves all samples once. The first pass also finds the nearest points. */
static brio_status smooth_all(brio_context *ctx, const smoothing *s, int pass) {
    brio_status status = BRIO_OK;
    size_t count = s->tree->count;
    for (size_t begin = 0; begin < count; begin += BLOCK) {
        size_t end = count - begin < BLOCK ? count : begin + BLOCK;
        BRIO_TRY(brio_progress(ctx, "noise", (pass + (double)begin / (double)count) / PASSES));
        smoothing_run run = {s, begin, pass == 0};
        BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, end - begin, RUN), end - begin, RUN, smooth_run, &run));
    }
done:
    return status;
}

brio_status brio_smooth_samples(brio_context *ctx, double *points, size_t count) {
    brio_status status = BRIO_OK;
    brio_point_tree tree = {0};
    smoothing s = {.tree = &tree};
    double(*spare)[3] = NULL;
    if (count < MORE) goto done;
    BRIO_TRY(brio_point_tree_new(ctx, points, count, &tree));
    BRIO_TRY(BRIO_ALLOC(ctx, s.near, count));
    BRIO_TRY(BRIO_ALLOC(ctx, spare, count));
    s.from = tree.point, s.to = spare;
    for (int pass = 0; pass < PASSES; pass++) {
        BRIO_TRY(smooth_all(ctx, &s, pass));
        double(*moved)[3] = s.to;
        s.to = s.from, s.from = moved;
    }
    for (size_t i = 0; i < count; i++) memcpy(points + 3 * (size_t)tree.index[i], s.from[i], sizeof s.from[i]);
done:
    brio_point_tree_free(ctx, &tree);
    brio_release(ctx, s.near);
    brio_release(ctx, spare);
    return status;
}
