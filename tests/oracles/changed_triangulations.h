/* Triangulations of points that are changed in a way of which the effect is known.
 *
 * The same set of simplices, degenerate or not: points in another order, more duplicates, scaled by powers of two (weights by
 * their squares), moved by whole numbers without rounding, three threads. Simplices of a set are simplices of every subset
 * that has their vertices. Where axes are exchanged or reflected, ties may be broken in another way: then the set passes the
 * check of the other points, with the same numbers of vertices, hidden points, duplicates and hull facets; it is the other
 * result if the check calls it canonical, and it must be if no tie is seen. */
#ifndef BRIO_TESTS_CHANGED_TRIANGULATIONS_H
#define BRIO_TESTS_CHANGED_TRIANGULATIONS_H

#include "oracle.h"

enum { MOST_SET = 400, MOST_CHANGED = 2 * MOST_SET, MOST_CELLS = 40 * MOST_SET };

typedef enum { SHUFFLE, DUPLICATE, SCALE, MOVE, THREADS, SUBSET, EXCHANGE_AXES, NEGATE, CHANGES } change;

static const char *const CHANGE_NAMES[CHANGES] = {"other order",   "more duplicates", "powers of two",  "moved",
                                                  "three threads", "subset",          "axes exchanged", "negated"};

/* Points; from: of each the index of the point of the first set that it is. */
typedef struct {
    size_t n, dimension;
    bool weighted, integers;
    double x[3 * MOST_CHANGED], w[MOST_CHANGED];
    uint32_t from[MOST_CHANGED];
} changed_set;

/* What a triangulation of either dimension says. Simplices by positions of the first set, sorted. */
typedef struct {
    size_t vertices, duplicates, hidden, hull, count;
    int dimension;
    uint32_t simplex[MOST_CELLS][4], index[MOST_CELLS][4];
} answer;

/* --- points --- */

static inline void draw_point(dice *d, int kind, size_t dimension, double *p) {
    for (size_t k = 0; k < dimension; k++) {
        double u = (double)(roll(d) >> 11) * 0x1p-53;
        p[k] = kind == 0 ? u : kind == 1 ? (double)below(d, 4) : kind == 2 ? (double)below(d, 1000) : u * u * u;
    }
    if (kind == 4) { /* on a sphere or a circle, as far as doubles go */
        double norm = 0;
        for (size_t k = 0; k < dimension; k++) p[k] = p[k] - 0.5, norm += p[k] * p[k];
        for (size_t k = 0; k < dimension; k++) p[k] /= sqrt(norm + 1e-300);
    }
}

static inline void draw_set(dice *d, changed_set *s) {
    int kind = (int)below(d, 5);
    uint32_t most = one_in(d, 8) ? MOST_SET - 4 : one_in(d, 2) ? 60 : 16;
    s->dimension = one_in(d, 3) ? 2 : 3, s->n = 4 + below(d, most);
    s->weighted = one_in(d, 2), s->integers = kind == 1 || kind == 2;
    for (size_t i = 0; i < s->n; i++) {
        draw_point(d, kind, s->dimension, s->x + s->dimension * i);
        if (i && one_in(d, 20)) memmove(s->x + s->dimension * i, s->x, s->dimension * sizeof *s->x);
        double w = kind == 2     ? (double)below(d, 20000)
                   : s->integers ? (double)below(d, 3)
                                 : (double)below(d, 64) / 1024;
        s->w[i] = w, s->from[i] = (uint32_t)i;
    }
}

static inline void copy_point(const changed_set *s, size_t from, changed_set *t, size_t to) {
    memcpy(t->x + s->dimension * to, s->x + s->dimension * from, s->dimension * sizeof *s->x);
    t->w[to] = s->w[from], t->from[to] = (uint32_t)from;
}

static inline void shuffle(dice *d, const changed_set *s, changed_set *t) {
    uint32_t order[MOST_CHANGED];
    for (uint32_t i = 0; i < s->n; i++) order[i] = i;
    for (uint32_t i = (uint32_t)s->n; i > 1; i--) {
        uint32_t j = below(d, i), swap = order[i - 1];
        order[i - 1] = order[j], order[j] = swap;
    }
    for (size_t i = 0; i < s->n; i++) copy_point(s, order[i], t, i);
}

static inline void change_coordinates(dice *d, change how, changed_set *t) {
    int e = (int)below(d, 400) - 200, turn = 1 + (int)below(d, 2);
    double move[3] = {(double)below(d, 1 << 20), -(double)below(d, 1 << 20), (double)below(d, 1 << 20)};
    for (size_t i = 0; i < t->n; i++) {
        double *p = t->x + t->dimension * i, old[3];
        memcpy(old, p, t->dimension * sizeof *p);
        for (size_t k = 0; k < t->dimension; k++) {
            if (how == SCALE) p[k] = ldexp(p[k], e);
            if (how == MOVE) p[k] += move[k];
            if (how == NEGATE) p[k] = -p[k];
            if (how == EXCHANGE_AXES) p[k] = old[(k + (size_t)turn) % t->dimension];
        }
        if (how == SCALE) t->w[i] = ldexp(t->w[i], 2 * e);
    }
}

/** Makes the changed set; false where the change cannot be made exactly. */
static inline bool make_change(dice *d, change how, const changed_set *s, changed_set *t) {
    *t = *s;
    if (how == MOVE && !s->integers) return false;
    if (how == SHUFFLE || how == THREADS) shuffle(d, s, t);
    if (how == SUBSET) {
        t->n = 0;
        for (size_t i = 0; i < s->n; i++)
            if (below(d, 4)) copy_point(s, i, t, t->n++);
    }
    if (how == DUPLICATE)
        for (uint32_t left = 1 + below(d, (uint32_t)s->n); left > 0; left--)
            copy_point(s, below(d, (uint32_t)s->n), t, t->n++);
    change_coordinates(d, how, t);
    return true;
}

/* --- answers --- */

/* The first point of the first set at the same position: coincident points are the same vertex. */
static inline void find_firsts(const changed_set *s, uint32_t *first) {
    for (size_t i = 0; i < s->n; i++) {
        first[i] = (uint32_t)i;
        for (size_t j = 0; j < i; j++) {
            bool same = true;
            for (size_t k = 0; k < s->dimension; k++)
                if (s->x[s->dimension * i + k] - s->x[s->dimension * j + k] != 0) same = false;
            if (same) first[i] = (uint32_t)j;
            if (same) break;
        }
    }
}

static inline int compare_simplices(const void *a, const void *b) {
    return memcmp(a, b, 4 * sizeof(uint32_t));
}

static inline void take_simplex(const changed_set *t, const uint32_t *first, const uint32_t *v, answer *a) {
    uint32_t *out = a->simplex[a->count];
    memset(out, 0, sizeof *a->simplex);
    memcpy(a->index[a->count++], v, (t->dimension + 1) * sizeof *v);
    for (size_t i = 0; i <= t->dimension; i++) {
        uint32_t p = first[t->from[v[i]]];
        size_t j = i;
        for (; j > 0 && out[j - 1] > p; j--) out[j] = out[j - 1];
        out[j] = p;
    }
}

static inline bool answer_in_space(brio_context *ctx, const changed_set *t, const uint32_t *first, answer *a) {
    brio_triangulation *r;
    if (brio_delaunay(ctx, t->x, t->weighted ? t->w : NULL, t->n, NULL, &r)) return false;
    const brio_delaunay_stats *f = brio_triangulation_stats(r);
    a->vertices = f->vertices, a->duplicates = f->duplicates, a->hidden = f->hidden, a->hull = f->hull_facets;
    a->dimension = f->dimension, a->count = 0;
    for (size_t i = 0; i < f->tetrahedra && a->count < MOST_CELLS; i++)
        take_simplex(t, first, brio_triangulation_tetrahedra(r)[i].vertex, a);
    brio_triangulation_free(r);
    return true;
}

static inline bool answer_in_plane(brio_context *ctx, const changed_set *t, const uint32_t *first, answer *a) {
    brio_triangulation2 *r;
    if (brio_delaunay2(ctx, t->x, t->weighted ? t->w : NULL, t->n, NULL, &r)) return false;
    const brio_delaunay2_stats *f = brio_triangulation2_stats(r);
    a->vertices = f->vertices, a->duplicates = f->duplicates, a->hidden = f->hidden, a->hull = f->hull_edges;
    a->dimension = f->dimension, a->count = 0;
    for (size_t i = 0; i < f->triangles && a->count < MOST_CELLS; i++)
        take_simplex(t, first, brio_triangulation2_triangles(r)[i].vertex, a);
    brio_triangulation2_free(r);
    return true;
}

static inline bool find_answer(brio_context *ctx, const changed_set *t, const uint32_t *first, answer *a) {
    bool done = t->dimension == 3 ? answer_in_space(ctx, t, first, a) : answer_in_plane(ctx, t, first, a);
    return done;
}

static inline void sort_answer(answer *a) {
    qsort(a->simplex, a->count, sizeof *a->simplex, compare_simplices);
}

/* --- comparison --- */

static inline bool same_simplices(answer *a, answer *b) {
    sort_answer(a), sort_answer(b);
    return a->count == b->count && !memcmp(a->simplex, b->simplex, a->count * sizeof *a->simplex);
}

/* Whether a simplex of a has no tie with the points s. Quadratic. */
static inline bool has_ties(const changed_set *s, const answer *a, const uint32_t *first) {
    size_t d = s->dimension;
    for (size_t i = 0; i < a->count; i++)
        for (uint32_t e = 0; e < s->n; e++) {
            const double *x[5];
            double w[5];
            bool in = first[e] != e;
            for (size_t k = 0; k <= d; k++) {
                uint32_t v = a->index[i][k];
                x[k] = s->x + d * v, w[k] = s->w[v], in = in || first[v] == e;
            }
            x[d + 1] = s->x + d * e, w[d + 1] = s->w[e];
            const double *weights = s->weighted ? w : NULL;
            if (in) continue;
            int side = d == 3 ? brio_insphere(x[0], x[1], x[2], x[3], x[4], weights)
                              : brio_incircle(x[0], x[1], x[2], x[3], weights);
            if (side == 0) return true;
        }
    return false;
}

/* Simplices of a all of whose vertices are in the subset are simplices of b. */
static inline const char *compare_subset(const changed_set *t, const uint32_t *first, answer *a, answer *b) {
    bool in[MOST_SET] = {false};
    for (size_t i = 0; i < t->n; i++) in[first[t->from[i]]] = true;
    if (t->weighted && a->duplicates) return NULL; /* of coincident points another one may be the heaviest */
    sort_answer(a), sort_answer(b);
    for (size_t i = 0; i < a->count; i++) {
        bool all = true;
        for (size_t k = 0; k <= t->dimension; k++) all = all && in[a->simplex[i][k]];
        if (all && !bsearch(a->simplex[i], b->simplex, b->count, sizeof *b->simplex, compare_simplices))
            return "a simplex of the set is none of the subset";
    }
    return NULL;
}

/* a's simplices, given by the first set's points, hold for the changed points, which have the same order. */
static inline const char *compare_turned(brio_context *ctx, const changed_set *s, const changed_set *t,
                                         const uint32_t *first, answer *a, answer *b) {
    int canonical = 0;
    bool ties = has_ties(s, a, first);
    if (a->hidden != b->hidden || a->hull != b->hull) return "other numbers of hidden points or hull facets";
    if (s->dimension == 2 && a->count != b->count) return "another number of triangles";
    if (s->dimension == 3 && a->dimension == 3 &&
        brio_tetrahedra_check(ctx, t->x, t->weighted ? t->w : NULL, t->n, *a->index, 4, a->count, &canonical))
        return "the check of the changed points refuses the tetrahedra";
    if (same_simplices(a, b) || (ties && !canonical)) return NULL;
    return ties ? "canonical for both, and not the same" : "another set of simplices without a tie";
}

/** Draws a set, changes it in this way, and compares. skipped: it could not be changed exactly. Returns NULL if
 *  all is as it must be, or what is not. */
static inline const char *try_change(brio_context *ctx, dice *d, change how, changed_set *s, bool *skipped) {
    static changed_set t;
    static answer a, b;
    uint32_t first[MOST_SET];
    draw_set(d, s);
    *skipped = !make_change(d, how, s, &t);
    if (*skipped) return NULL;
    find_firsts(s, first);
    if (!find_answer(ctx, s, first, &a)) return brio_message(ctx);
    brio_context_set_threads(ctx, how == THREADS ? 3 : 1);
    bool done = find_answer(ctx, &t, first, &b);
    brio_context_set_threads(ctx, 1);
    if (!done) return brio_message(ctx);
    if (how == SUBSET) return compare_subset(&t, first, &a, &b);
    if (a.vertices != b.vertices || a.dimension != b.dimension) return "another number of vertices";
    if (a.duplicates + t.n - s->n != b.duplicates) return "another number of duplicates";
    if (how == EXCHANGE_AXES || how == NEGATE) return compare_turned(ctx, s, &t, first, &a, &b);
    if (a.hidden != b.hidden || a.hull != b.hull) return "other numbers of hidden points or hull facets";
    return same_simplices(&a, &b) ? NULL : "another set of simplices";
}

#endif
