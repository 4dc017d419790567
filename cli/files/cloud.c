/* Facts of a set of points that need no triangulation.
 *
 * Duplicates are counted with a hash table of point indices, open addressing with linear probing, at most two thirds
 * full: no copy of the coordinates and no sort, also for 100 million points.
 *
 * The spacing is the median over randomly chosen points of the exact distance to the nearest other position, found in
 * one pass over all points. The number of chosen points falls from 1024 to 32 as the file grows, so that the pass costs
 * at most some seconds; with 32 the median is off by a few tenths at worst, which is enough to choose a parameter. */
#include "cli/files/cloud.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ANCHORS = 1024, FEWEST_ANCHORS = 32, INTERRUPT_EVERY = 1 << 16 };
#define ANCHOR_BUDGET ((size_t)1 << 29) /* distances to be computed, as long as there are FEWEST_ANCHORS */

void cli_cloud_box(const double *points, size_t count, double low[3], double high[3]) {
    memcpy(low, points, 3 * sizeof *low);
    memcpy(high, points, 3 * sizeof *high);
    for (size_t i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) {
            double x = points[3 * i + k];
            if (x < low[k]) low[k] = x;
            if (x > high[k]) high[k] = x;
        }
}

/* Mixes bits by SplitMix64's finalizer. */
static uint64_t mix(uint64_t x) {
    x += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

/* Returns the hash of a position. Adding 0.0 turns -0.0 into 0.0, which it equals. */
static uint64_t position_hash(const double p[3], uint64_t seed) {
    uint64_t hash = seed;
    for (int k = 0; k < 3; k++) {
        double x = p[k] + 0.0;
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        hash = mix(hash ^ bits);
    }
    return hash;
}

/* Writes a position in double or in single precision. */
static void get_position(const double *p, bool single, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = single ? (double)(float)p[k] : p[k];
}

static bool same_position(const double *p, const double *q, bool single) {
    double a[3], b[3];
    get_position(p, single, a);
    get_position(q, single, b);
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static brio_status count_duplicates(run *r, const double *points, size_t count, bool single, size_t *duplicates) {
    size_t slots = count + count / 2 + 1;
    uint32_t *table = calloc(slots, sizeof *table); /* index + 1; 0 is free */
    brio_status status = BRIO_OK;
    *duplicates = 0;
    if (!table) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory: a table of %zu points", count);
    for (size_t i = 0; i < count; i++) {
        const double *p = points + 3 * i;
        double at[3];
        get_position(p, single, at);
        size_t slot = (size_t)(position_hash(at, r->common.seed) % slots);
        if (i % INTERRUPT_EVERY == 0) TRY(cli_check_interrupt(r));
        while (table[slot] && !same_position(p, points + 3 * (size_t)(table[slot] - 1), single))
            slot = slot + 1 < slots ? slot + 1 : 0;
        if (table[slot])
            ++*duplicates;
        else
            table[slot] = (uint32_t)(i + 1);
    }
done:
    free(table);
    return status;
}

brio_status cli_cloud_duplicates(run *r, const double *points, size_t count, size_t *duplicates) {
    return count_duplicates(r, points, count, false, duplicates);
}

brio_status cli_cloud_merged(run *r, const double *points, size_t count, size_t *merged) {
    size_t before, after;
    FORWARD(count_duplicates(r, points, count, false, &before));
    FORWARD(count_duplicates(r, points, count, true, &after));
    *merged = after - before;
    return BRIO_OK;
}

typedef struct anchor {
    double p[3], nearest; /* squared distance, both scaled */
} anchor;

/* Returns the exponent of a power of two that brings the coordinates to about 1, so that squares neither overflow nor
 * vanish. */
static int scale_exponent(const double *points, size_t count) {
    double low[3], high[3], most = 0;
    cli_cloud_box(points, count, low, high);
    for (int k = 0; k < 3; k++) most = fmax(most, fmax(fabs(low[k]), fabs(high[k])));
    return most > 0 ? -ilogb(most) : 0;
}

static int compare_nearest(const void *a, const void *b) {
    double x = ((const anchor *)a)->nearest, y = ((const anchor *)b)->nearest;
    return (x > y) - (x < y);
}

static void scale_point(const double *p, double scale, double scaled[3]) {
    for (int k = 0; k < 3; k++) scaled[k] = p[k] * scale;
}

static void approach(anchor *anchors, size_t num_anchors, const double p[3]) {
    for (size_t a = 0; a < num_anchors; a++) {
        double x = p[0] - anchors[a].p[0], y = p[1] - anchors[a].p[1], z = p[2] - anchors[a].p[2];
        double square = x * x + y * y + z * z;
        if (square < anchors[a].nearest && square > 0) anchors[a].nearest = square;
    }
}

static size_t choose_anchors(anchor *anchors, const double *points, size_t count, double scale, uint64_t seed) {
    size_t chosen = ANCHOR_BUDGET / count;
    if (chosen < FEWEST_ANCHORS) chosen = FEWEST_ANCHORS;
    if (chosen > MOST_ANCHORS) chosen = MOST_ANCHORS;
    if (chosen > count) chosen = count;
    for (size_t a = 0; a < chosen; a++) {
        size_t i = chosen == count ? a : (size_t)(mix(seed + a) % count);
        scale_point(points + 3 * i, scale, anchors[a].p);
        anchors[a].nearest = INFINITY;
    }
    return chosen;
}

brio_status cli_cloud_spacing(run *r, const double *points, size_t count, double *spacing) {
    anchor anchors[MOST_ANCHORS];
    *spacing = 0;
    if (count < 2) return BRIO_OK;
    int exponent = scale_exponent(points, count);
    double scale = ldexp(1, exponent > 1000 ? 1000 : exponent), p[3];
    size_t num_anchors = choose_anchors(anchors, points, count, scale, r->common.seed);
    for (size_t i = 0; i < count; i++) {
        if (i % INTERRUPT_EVERY == 0) FORWARD(cli_check_interrupt(r));
        scale_point(points + 3 * i, scale, p);
        approach(anchors, num_anchors, p);
    }
    qsort(anchors, num_anchors, sizeof *anchors, compare_nearest);
    double median = anchors[num_anchors / 2].nearest;
    if (isfinite(median)) *spacing = sqrt(median) / scale;
    return BRIO_OK;
}

/* --- rounding --- */

/* Two units in the last place of each coordinate may be missing: src/base/scale.h has the same for the library. */
static const double TWO_UNITS = 0x1p-50, MOST = 0x1p-14; /* the second is chosen */

double cli_rounding(const brio_mesh *mesh) {
    double greatest = 0;
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) greatest = fmax(greatest, fabs(mesh->vertices[i]));
    return TWO_UNITS * greatest;
}

double cli_up_to(double threshold, double rounding) {
    return threshold + fmin(rounding, MOST * threshold);
}
