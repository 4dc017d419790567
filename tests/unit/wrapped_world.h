/* A living triangulation in space that repeats, and what its points are, beside it. The oracle: after any sequence of
 * changes the snapshot has the checksum of a fresh build of the points that are left, on the same grid. */
#ifndef BRIO_TESTS_WRAPPED_WORLD_H
#define BRIO_TESTS_WRAPPED_WORLD_H

#include "living_world.h"

#include "living/living.h"

typedef struct {
    brio_context *ctx;
    brio_dynamic_periodic *d;
    brio_periodic_options options;
    double cell[9];
    shape shape; /* UNIFORM, GRID or CLUSTERS */
    int weighted;
    double *point; /* #indices by 4: as given, with the weight */
    uint8_t *alive;
    size_t num_indices, num_points, most;
} wrapped;

enum { WRAPPED_CELLS = 3 };
static const double WRAPPED_CELL[WRAPPED_CELLS][9] = {
    {1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 0, 0, 0.5, 0.75, 0, 0.25, -0.5, 1.25}, {1, 0, 0, 3, 0.5, 0, -2, 1, 0.5}};

/*  directions  bits of those that are open. */
static inline wrapped wrapped_new(shape s, int weighted, int cell, int open, size_t most) {
    wrapped w = {.shape = s, .weighted = weighted, .most = most};
    EXPECT(brio_context_new(NULL, &w.ctx) == BRIO_OK);
    brio_context_set_threads(w.ctx, 1);
    memcpy(w.cell, WRAPPED_CELL[cell], sizeof w.cell);
    w.options = (brio_periodic_options){.size = sizeof w.options};
    for (int k = 0; k < 3; k++) w.options.open[k] = open >> k & 1;
    w.point = calloc(4 * most, sizeof *w.point);
    w.alive = calloc(most, 1);
    return w;
}

static inline void wrapped_start(wrapped *w) {
    w->options.cell = w->cell;
    w->options.weighted = w->weighted;
    EXPECT(brio_dynamic_periodic_new(w->ctx, NULL, NULL, 0, &w->options, &w->d) == BRIO_OK, "%s", brio_message(w->ctx));
}

static inline void wrapped_free(wrapped *w) {
    brio_dynamic_periodic_free(w->d);
    EXPECT(brio_context_memory(w->ctx) == 0, "%zu bytes are left", brio_context_memory(w->ctx));
    brio_context_free(w->ctx);
    free(w->point), free(w->alive);
}

/* A point in one of some cells. */
static inline void draw_wrapped(const wrapped *w, double p[4]) {
    double share[3];
    for (int k = 0; k < 3; k++) share[k] = draw();
    if (w->shape == GRID)
        for (int k = 0; k < 3; k++) share[k] = floor(4 * share[k]) / 4;
    if (w->shape == CLUSTERS)
        for (int k = 0; k < 3; k++) share[k] = (share[0] < 0.5 ? 0.02 : 0.6) + 0.02 * share[k];
    for (int k = 0; k < 3; k++) share[k] += w->options.open[k] ? 0 : floor(3 * draw()) - 1;
    for (int c = 0; c < 3; c++) {
        p[c] = 0;
        for (int k = 0; k < 3; k++) p[c] += share[k] * w->cell[3 * k + c];
    }
    p[3] = w->weighted ? draw_weight(w->shape) : 0;
}

/* What a change is to be: points in rows of 3, weights, indices. */
typedef struct {
    int kind; /* 0 insert, 1 remove, 2 move, 3 reweight */
    size_t count;
    double point[3 * AT_ONCE], weight[AT_ONCE];
    uint32_t index[AT_ONCE];
} wish;

static inline void draw_wish(const wrapped *w, int kind, size_t n, double step, wish *out) {
    *out = (wish){.kind = kind, .count = n};
    if (kind > 0) out->count = draw_alive(w->alive, w->num_points, w->num_indices, n, out->index);
    for (size_t i = 0; i < out->count; i++) {
        double p[4];
        draw_wrapped(w, p);
        if (kind == 2 && step < 1)
            for (size_t c = 0; c < 3; c++)
                p[c] =
                    w->point[4 * out->index[i] + c] + step * (w->shape == GRID ? floor(3 * draw()) - 1 : draw() - 0.5);
        memcpy(out->point + 3 * i, p, 3 * sizeof *p);
        out->weight[i] = p[3];
    }
}

static inline brio_status make_wish(const wrapped *w, const wish *v) {
    const double *weight = w->weighted ? v->weight : NULL;
    if (v->kind == 0) return brio_dynamic_periodic_insert(w->d, v->point, weight, v->count, NULL);
    if (v->kind == 1) return brio_dynamic_periodic_remove(w->d, v->index, v->count);
    if (v->kind == 2) return brio_dynamic_periodic_move(w->d, v->index, v->point, weight, v->count);
    return brio_dynamic_periodic_reweight(w->d, v->index, v->weight, v->count);
}

/* Notes that a wish came true. */
static inline void note_wish(wrapped *w, const wish *v) {
    for (size_t i = 0; i < v->count; i++) {
        size_t at = v->kind == 0 ? w->num_indices++ : v->index[i];
        double *p = w->point + 4 * at;
        if (v->kind == 0 || v->kind == 2) memcpy(p, v->point + 3 * i, 3 * sizeof *p);
        if (v->kind != 1) p[3] = v->weight[i];
        w->num_points += (v->kind == 0) - (size_t)(v->kind == 1);
        w->alive[at] = v->kind != 1;
    }
}

static inline void change_wrapped(wrapped *w, size_t usual, size_t n) {
    static const double STEP[] = {1e-9, 1e-3, 0.125, 1};
    static wish v;
    double more = w->num_points < usual ? 0.35 : 0.15, what = draw();
    int kind = what < more ? 0 : what < 0.5 ? 1 : what < 0.8 || !w->weighted ? 2 : 3;
    draw_wish(w, kind, n, w->shape == GRID ? 0.125 : STEP[draw_below(4)], &v);
    EXPECT(make_wish(w, &v) == BRIO_OK, "%s", brio_message(w->ctx));
    note_wish(w, &v);
}

/* Returns a fresh build of the points that are there, or NULL. */
static inline brio_periodic *build_fresh(wrapped *w) {
    brio_dynamic_periodic_stats s = {.size = sizeof s};
    brio_periodic *t = NULL;
    EXPECT(brio_dynamic_periodic_facts(w->d, &s) == BRIO_OK && s.points == w->num_points &&
           s.indices == w->num_indices);
    double *p = malloc((3 * s.points + 1) * sizeof *p), *weight = malloc((s.points + 1) * sizeof *weight);
    brio_periodic_options o = w->options;
    o.reach = s.reach;
    brio_dynamic_periodic_points(w->d, NULL, p, weight);
    EXPECT(brio_delaunay_periodic(w->ctx, p, w->weighted ? weight : NULL, s.points, &o, &t) == BRIO_OK, "%s",
           brio_message(w->ctx));
    free(p), free(weight);
    return t;
}

/* Whether the snapshot is what a fresh build makes of the points that are left. */
static inline int is_as_fresh(wrapped *w) {
    brio_periodic *t = NULL, *fresh = build_fresh(w);
    uint64_t own = 0, other = 1;
    int same = 0;
    EXPECT(brio_dynamic_periodic_snapshot(w->ctx, w->d, &t) == BRIO_OK, "%s", brio_message(w->ctx));
    if (t && fresh) {
        const brio_periodic_stats *a = brio_periodic_facts(t), *b = brio_periodic_facts(fresh);
        same = a->points == b->points && a->vertices == b->vertices && a->duplicates == b->duplicates &&
               a->hidden == b->hidden && a->dimension == b->dimension && a->tetrahedra == b->tetrahedra &&
               a->hull_facets == b->hull_facets;
        EXPECT(brio_periodic_checksum(w->ctx, t, &own) == BRIO_OK);
        EXPECT(brio_periodic_checksum(w->ctx, fresh, &other) == BRIO_OK);
        same = same && own == other;
        same = same && memcmp(brio_periodic_representatives(t), brio_periodic_representatives(fresh),
                              a->points * sizeof(brio_image)) == 0;
    }
    brio_periodic_free(t);
    brio_periodic_free(fresh);
    return same;
}

/* Whether the points are where they were put, up to the grid. */
static inline int are_in_place(const wrapped *w) {
    for (uint32_t i = 0; i < w->num_indices; i++) {
        double r[4];
        if (brio_dynamic_periodic_point(w->d, i, r) != w->alive[i]) return 0;
        for (int c = 0; c < 4 && w->alive[i]; c++)
            if (!(fabs(r[c] - w->point[4 * i + (size_t)c]) < 1e-13)) return 0;
    }
    return 1;
}

#endif
