/* The polar balls of an r-sample of a surface whose local feature size is known. */
#ifndef BRIO_TESTS_KNOWN_BALLS_H
#define BRIO_TESTS_KNOWN_BALLS_H

#include "harness.h"
#include "known_surfaces.h"
#include "points.h"
#include "reconstruct/labels/labeling.h"

enum { BOUNDING_POINTS = 8 };
static const double BOUND = 15;

/* The polar balls of one r-sample, with their true labels. */
typedef struct {
    brio_context *ctx;
    const known_surface *surface;
    double r;
    double *points; /* the samples; eight bounding points follow */
    size_t n;
    brio_triangulation *power;
    brio_poles poles;
    uint8_t *truth;
} theory;

static inline void add_bounding_points(theory *x) {
    x->points = realloc(x->points, sizeof *x->points * 3 * (x->n + BOUNDING_POINTS));
    for (size_t i = 0; i < BOUNDING_POINTS; i++)
        for (size_t k = 0; k < 3; k++) x->points[3 * (x->n + i) + k] = i >> k & 1 ? BOUND : -BOUND;
}

static inline theory theory_new(const known_surface *surface, double r) {
    theory x = {.ctx = new_context(), .surface = surface, .r = r};
    brio_pole_filter keep_all = {0};
    brio_triangulation *t;
    brio_context_set_threads(x.ctx, 1);
    x.points = surface->sample(r, 11, &x.n);
    add_bounding_points(&x);
    EXPECT(brio_delaunay(x.ctx, x.points, NULL, x.n + BOUNDING_POINTS, NULL, &t) == BRIO_OK);
    EXPECT(brio_poles_find(x.ctx, t, x.points, x.n, &keep_all, &x.poles) == BRIO_OK);
    EXPECT(brio_delaunay(x.ctx, x.poles.centre, x.poles.square, x.poles.count, NULL, &x.power) == BRIO_OK);
    x.truth = malloc(x.poles.count);
    for (size_t p = 0; p < x.poles.count; p++)
        x.truth[p] = surface->value(x.poles.centre + 3 * p) < 0 ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    brio_triangulation_free(t);
    return x;
}

static inline void theory_free(theory *x) {
    brio_triangulation_free(x->power);
    brio_poles_free(x->ctx, &x->poles);
    EXPECT(brio_context_memory(x->ctx) == 0);
    brio_context_free(x->ctx);
    free(x->points);
    free(x->truth);
}

static inline double square_between(const double *a, const double *b) {
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

typedef struct {
    double from, to;
} interval;

static inline int compare_intervals(const void *a, const void *b) {
    const interval *x = a, *y = b;
    return x->from < y->from ? -1 : x->from > y->from;
}

/* The balls of a label along the line from s with the given direction: *count intervals, by where they begin. */
static inline interval *cut_line(const theory *x, uint8_t label, const double *s, const double *way, size_t *count) {
    interval *cut = malloc((x->poles.count + 1) * sizeof *cut);
    *count = 0;
    for (size_t p = 0; p < x->poles.count; p++) {
        const double *c = x->poles.centre + 3 * p;
        double along = 0, far = square_between(c, s);
        for (int k = 0; k < 3; k++) along += (c[k] - s[k]) * way[k];
        double half = x->poles.square[p] - (far - along * along);
        if (x->truth[p] != label || half < 0) continue;
        cut[(*count)++] = (interval){along - sqrt(half), along + sqrt(half)};
    }
    qsort(cut, *count, sizeof *cut, compare_intervals);
    return cut;
}

#endif
