/* A living triangulation and what its points are, beside it. The oracle: after any sequence of changes the snapshot is the
 * result of brio_delaunay of the points that are left, equal in every byte. */
#ifndef BRIO_TESTS_LIVING_WORLD_H
#define BRIO_TESTS_LIVING_WORLD_H

#include "harness.h"

#include "base/context.h"
#include "dynamic/live.h"
#include <math.h>
#include <string.h>

typedef enum { UNIFORM, GRID, SPHERE, CLUSTERS, SCAN, MIXED, NUM_SHAPES } shape;
enum { AT_ONCE = 512 }; /* points that one change draws */
static const char *const SHAPE[] = {"uniform", "grid", "sphere", "clusters", "scan", "mixed"};

static uint64_t state = 1;

static inline double draw(void) {
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) * 0x1p-53;
}

static inline size_t draw_below(size_t n) {
    return (size_t)(draw() * (double)n);
}

/* A point whose coordinates have exact ties: on a small grid, or on a sphere of integers. */
static inline void draw_point(shape s, double p[3]) {
    static const double ON_SPHERE[][3] = {{15, 0, 0}, {9, 12, 0}, {5, 10, 10}, {2, 5, 14}, {2, 10, 11}, {14, 5, 2}};
    if (s == MIXED) s = (shape)draw_below(MIXED);
    for (int c = 0; c < 3; c++) p[c] = draw();
    if (s == GRID)
        for (int c = 0; c < 3; c++) p[c] = floor(p[c] * 6) / 8;
    if (s == SCAN) { /* lines of a scanner over a surface, with a little noise */
        p[1] = floor(40 * p[1]) / 40;
        p[2] = 0.3 * p[0] * p[0] - 0.2 * p[1] * p[0] + 1e-4 * p[2];
    }
    if (s == CLUSTERS) {
        double corner = floor(draw() * 4);
        for (int c = 0; c < 3; c++) p[c] = corner / 4 + p[c] * p[c] * p[c] * 1e-3;
    }
    if (s == SPHERE) {
        const double *q = ON_SPHERE[draw_below(sizeof ON_SPHERE / sizeof *ON_SPHERE)];
        size_t turn = draw_below(3);
        for (size_t c = 0; c < 3; c++) p[c] = q[(c + turn) % 3] * (draw() < 0.5 ? -1 : 1) / 16;
    }
}

static inline double draw_weight(shape s) {
    return s == GRID ? floor(draw() * 4) / 64 : draw() < 0.5 ? 0 : draw() * 0.02;
}

/* What the points are, beside the triangulation. */
typedef struct {
    brio_context *ctx;
    brio_dynamic *d;
    shape shape;
    int weighted;
    double *point, *weight; /* by index */
    uint8_t *alive;
    uint32_t *index; /* of those that are there, in any order */
    size_t num_indices, num_points;
    size_t looks; /* until a call is told to stop; 0: never */
} world;

static inline world world_new(shape s, int weighted, size_t most) {
    world w = {.shape = s, .weighted = weighted};
    EXPECT(brio_context_new(NULL, &w.ctx) == BRIO_OK);
    brio_context_set_threads(w.ctx, 1);
    w.point = malloc(3 * most * sizeof *w.point);
    w.weight = malloc(most * sizeof *w.weight);
    w.alive = calloc(most, 1);
    w.index = malloc(most * sizeof *w.index);
    return w;
}

static inline void world_free(world *w) {
    brio_dynamic_free(w->d);
    EXPECT(brio_context_memory(w->ctx) == 0, "%zu bytes are left", brio_context_memory(w->ctx));
    brio_context_free(w->ctx);
    free(w->point), free(w->weight), free(w->alive), free(w->index);
}

/* The points that are there, by ascending index. */
typedef struct {
    double *point, *weight;
    size_t count;
} points_left;

static inline points_left left_of(const world *w) {
    points_left l = {malloc((3 * w->num_points + 1) * sizeof(double)), malloc((w->num_points + 1) * sizeof(double)), 0};
    for (size_t i = 0; i < w->num_indices; i++) {
        if (!w->alive[i]) continue;
        memcpy(l.point + 3 * l.count, w->point + 3 * i, 3 * sizeof(double));
        l.weight[l.count++] = w->weight[i];
    }
    return l;
}

/* Whether the snapshot is what brio_delaunay makes of the points that are left. */
static inline int is_as_built(world *w) {
    points_left l = left_of(w);
    brio_triangulation *snapshot = NULL, *built = NULL;
    int same = 0;
    EXPECT(l.count == w->num_points);
    EXPECT(brio_dynamic_snapshot(w->ctx, w->d, &snapshot) == BRIO_OK, "%s", brio_message(w->ctx));
    EXPECT(brio_delaunay(w->ctx, l.point, w->weighted ? l.weight : NULL, l.count, NULL, &built) == BRIO_OK);
    if (snapshot && built) {
        const brio_delaunay_stats *s = brio_triangulation_stats(snapshot), *b = brio_triangulation_stats(built);
        same = s->points == b->points && s->vertices == b->vertices && s->duplicates == b->duplicates &&
               s->hidden == b->hidden && s->dimension == b->dimension && s->tetrahedra == b->tetrahedra &&
               s->hull_facets == b->hull_facets;
        size_t count = b->tetrahedra + b->hull_facets;
        same = same && memcmp(brio_triangulation_tetrahedra(snapshot), brio_triangulation_tetrahedra(built),
                              count * sizeof(brio_tetrahedron)) == 0;
        same = same && memcmp(brio_triangulation_representatives(snapshot), brio_triangulation_representatives(built),
                              l.count * sizeof(uint32_t)) == 0;
        same = same && brio_triangulation_points_hash(snapshot) == brio_triangulation_points_hash(built);
    }
    brio_triangulation_free(snapshot);
    brio_triangulation_free(built);
    free(l.point), free(l.weight);
    return same;
}

static inline void enter(world *w, size_t index, const double *p, double weight) {
    memcpy(w->point + 3 * index, p, 3 * sizeof *p);
    w->weight[index] = weight;
    w->num_points += !w->alive[index];
    w->alive[index] = 1;
}

static inline void insert_some(world *w, size_t n) {
    double p[3 * AT_ONCE] = {0}, weight[AT_ONCE] = {0};
    uint32_t first = 0;
    for (size_t i = 0; i < n; i++) {
        draw_point(w->shape, p + 3 * i);
        weight[i] = w->weighted ? draw_weight(w->shape) : 0;
    }
    EXPECT(brio_dynamic_insert(w->d, p, w->weighted ? weight : NULL, n, &first) == BRIO_OK, "%s", brio_message(w->ctx));
    EXPECT(first == w->num_indices);
    for (size_t i = 0; i < n; i++) enter(w, w->num_indices++, p + 3 * i, weight[i]);
}

/* Draws n different indices of points that are alive, where there are as many; returns how many. */
static inline size_t draw_alive(const uint8_t *alive, size_t num_points, size_t num_indices, size_t n,
                                uint32_t *index) {
    size_t count = 0;
    for (size_t tries = 0; tries < 40 * n && count < n && num_points > 0; tries++) {
        uint32_t i = (uint32_t)draw_below(num_indices);
        int twice = !alive[i];
        for (size_t k = 0; k < count; k++) twice |= index[k] == i;
        if (!twice) index[count++] = i;
    }
    return count;
}

static inline size_t draw_indices(const world *w, size_t n, uint32_t *index) {
    return draw_alive(w->alive, w->num_points, w->num_indices, n, index);
}

static inline void remove_some(world *w, size_t n) {
    uint32_t index[AT_ONCE] = {0};
    n = draw_indices(w, n, index);
    EXPECT(brio_dynamic_remove(w->d, index, n) == BRIO_OK, "%s", brio_message(w->ctx));
    for (size_t i = 0; i < n; i++) w->alive[index[i]] = 0, w->num_points--;
}

static inline void move_some(world *w, size_t n, double step) {
    uint32_t index[AT_ONCE] = {0};
    double p[3 * AT_ONCE] = {0}, weight[AT_ONCE] = {0};
    n = draw_indices(w, n, index);
    for (size_t i = 0; i < n; i++) {
        draw_point(w->shape, p + 3 * i);
        for (size_t c = 0; c < 3 && step < 1; c++)
            p[3 * i + c] =
                w->point[3 * index[i] + c] + step * (w->shape == GRID ? floor(3 * draw()) - 1 : draw() - 0.5);
        weight[i] = w->weighted ? draw_weight(w->shape) : 0;
    }
    EXPECT(brio_dynamic_move(w->d, index, p, w->weighted ? weight : NULL, n) == BRIO_OK, "%s", brio_message(w->ctx));
    for (size_t i = 0; i < n; i++) enter(w, index[i], p + 3 * i, weight[i]);
}

static inline void reweight_some(world *w, size_t n) {
    uint32_t index[AT_ONCE] = {0};
    double weight[AT_ONCE] = {0};
    if (!w->weighted) return;
    n = draw_indices(w, n, index);
    for (size_t i = 0; i < n; i++) weight[i] = draw_weight(w->shape);
    EXPECT(brio_dynamic_reweight(w->d, index, weight, n) == BRIO_OK, "%s", brio_message(w->ctx));
    for (size_t i = 0; i < n; i++) w->weight[index[i]] = weight[i];
}

/* A callback of progress that asks to stop when it is called the n-th time; 0: never. */
static inline int stop_at(const char *stage, double fraction, void *user) {
    size_t *left = user;
    (void)stage, (void)fraction;
    return *left > 0 && --*left == 0;
}

/* Inserts many points in one call. */
static inline void insert_many(world *w, size_t n) {
    double *p = calloc(3 * n, sizeof *p);
    uint32_t first;
    for (size_t i = 0; i < n; i++) draw_point(w->shape, p + 3 * i);
    EXPECT(brio_dynamic_insert(w->d, p, NULL, n, &first) == BRIO_OK, "%s", brio_message(w->ctx));
    for (size_t i = 0; i < n; i++) enter(w, w->num_indices++, p + 3 * i, 0);
    free(p);
}

#endif
