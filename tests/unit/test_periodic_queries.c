/* Alpha complexes and locations in space that repeats, against many copies and all translates. */
#include "base/rng.h"
#include "harness.h"
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { POINTS = 12, COPIES = 3, SIDE = 2 * COPIES + 1, MOST = POINTS * SIDE * SIDE * SIDE };

static brio_context *ctx;

/* Points whose translates are all exact: sixteenths (which tie) or 2^-20ths of a cell. */
typedef struct {
    double points[3 * POINTS], weights[POINTS];
    const double *cell;
    int open[3];
    bool weighted;
    brio_periodic *t;
} sample;

static const double CUBE[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, TILTED[9] = {1, 0, 0, 0.5, 1, 0, 0.25, 0.5, 1};

static sample make(uint64_t seed, const double *cell, const char *directions, int grid, bool weighted) {
    sample s = {.cell = cell, .weighted = weighted};
    brio_rng rng = brio_rng_new(seed);
    for (size_t p = 0; p < POINTS; p++) {
        double share[3];
        for (int k = 0; k < 3; k++) share[k] = (double)brio_rng_below(&rng, (uint32_t)grid) / grid;
        for (size_t k = 0; k < 3; k++)
            s.points[3 * p + k] = share[0] * cell[k] + share[1] * cell[3 + k] + share[2] * cell[6 + k];
        s.weights[p] = brio_rng_below(&rng, 5) / 64.0;
    }
    brio_periodic_options o = {.size = sizeof o, .cell = cell};
    for (int k = 0; k < 3; k++) o.open[k] = s.open[k] = !strchr(directions, "xyz"[k]);
    EXPECT(brio_delaunay_periodic(ctx, s.points, weighted ? s.weights : NULL, POINTS, &o, &s.t) == BRIO_OK, "%s",
           brio_message(ctx));
    return s;
}

static void place_of(const sample *s, size_t point, const int32_t *shift, double *x) {
    for (size_t k = 0; k < 3; k++)
        x[k] = s->points[3 * point + k] + shift[0] * s->cell[k] + shift[1] * s->cell[3 + k] + shift[2] * s->cell[6 + k];
}

/* --- alpha --- */

static double copies[3 * MOST], copies_weights[MOST];
static bool in_the_middle[MOST];

static size_t copy_all(const sample *s) {
    size_t n = 0;
    int32_t c[3];
    for (c[0] = -COPIES; c[0] <= COPIES; c[0]++)
        for (c[1] = -COPIES; c[1] <= COPIES; c[1]++)
            for (c[2] = -COPIES; c[2] <= COPIES; c[2]++) {
                if ((c[0] && s->open[0]) || (c[1] && s->open[1]) || (c[2] && s->open[2])) continue;
                for (size_t p = 0; p < POINTS; p++, n++) {
                    place_of(s, p, c, copies + 3 * n);
                    copies_weights[n] = s->weights[p];
                    in_the_middle[n] = !c[0] && !c[1] && !c[2];
                }
            }
    return n;
}

static int before(const double *a, const double *b) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts values, and expects them to be equal but for rounding. */
static void same_values(double *a, size_t na, double *b, size_t nb, size_t k, uint64_t seed) {
    EXPECT(na == nb, "%d: dimension %zu: %zu simplices, not %zu", (int)seed, k, na, nb);
    qsort(a, na, sizeof *a, compare), qsort(b, nb, sizeof *b, compare);
    for (size_t i = 0; i < na && i < nb; i++)
        if (!(fabs(a[i] - b[i]) <= 1e-13)) {
            EXPECT(false, "%d: dimension %zu: %.17g, not %.17g", (int)seed, k, a[i], b[i]);
            break;
        }
}

/* Expects that every face of a simplex that is in the list has no greater value. */
static void grows(const brio_periodic_alpha *a) {
    const brio_alpha_complex *c = a->complex;
    for (size_t k = 1; k < 4; k++)
        for (size_t n = 0; n < c->counts[k]; n++)
            for (size_t m = 0; m < c->counts[k - 1]; m++) {
                size_t shared = 0;
                for (size_t i = 0; i < k; i++)
                    for (size_t j = 0; j <= k; j++)
                        shared += c->simplices[k - 1][m * k + i] == c->simplices[k][n * (k + 1) + j];
                EXPECT(shared < k || c->values[k - 1][m] <= c->values[k][n]);
            }
}

static void compare_with_copies(uint64_t seed, sample s) {
    static double mine[1 << 16], theirs[1 << 16];
    brio_periodic_alpha *a = NULL;
    brio_triangulation *t = NULL;
    brio_alpha_complex c = {.size = sizeof c};
    size_t n = copy_all(&s);
    const double *weights = s.weighted ? copies_weights : NULL;
    EXPECT(brio_periodic_alpha_values(ctx, s.t, &a) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_delaunay(ctx, copies, weights, n, NULL, &t) == BRIO_OK);
    EXPECT(brio_alpha_values(ctx, t, copies, weights, n, &c) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t k = 0; a && k < 4; k++) {
        size_t found = 0;
        for (size_t i = 0; i < c.counts[k]; i++) {
            const uint32_t *v = c.simplices[k] + i * (k + 1);
            uint32_t least = v[0];
            for (size_t j = 1; j <= k; j++)
                if (before(copies + 3 * (size_t)v[j], copies + 3 * (size_t)least) < 0) least = v[j];
            if (in_the_middle[least] && found < 1 << 16) theirs[found++] = c.values[k][i];
        }
        memcpy(mine, a->complex->values[k], a->complex->counts[k] * sizeof *mine);
        same_values(mine, a->complex->counts[k], theirs, found, k, seed);
    }
    const size_t *counts = a->complex->counts;
    EXPECT(counts[0] + counts[2] == counts[1] + counts[3], "the Euler characteristic");
    EXPECT(counts[3] == brio_periodic_facts(s.t)->tetrahedra);
    grows(a);
    brio_periodic_alpha_free(a);
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
    brio_periodic_free(s.t);
}

static void alpha_is_that_of_many_copies(void) {
    compare_with_copies(1, make(1, CUBE, "xyz", 1 << 20, false));
    compare_with_copies(2, make(2, TILTED, "xyz", 1 << 20, true));
    compare_with_copies(3, make(3, CUBE, "xyz", 4, false));
    compare_with_copies(4, make(4, TILTED, "xy", 1 << 20, false));
    compare_with_copies(5, make(5, CUBE, "y", 8, true));
}

static void flat_points_have_no_alpha_complex(void) {
    brio_periodic_options o = {.size = sizeof o, .cell = CUBE, .open = {0, 0, 1}};
    const double point[3] = {0, 0, 0};
    brio_periodic *t = NULL;
    brio_periodic_alpha *a = NULL;
    EXPECT(brio_delaunay_periodic(ctx, point, NULL, 1, &o, &t) == BRIO_OK);
    EXPECT(brio_periodic_alpha_values(ctx, t, &a) == BRIO_ERR_NO_ANSWER && !a);
    brio_periodic_free(t);
}

/* --- locations --- */

static double power(const sample *s, size_t p, const int32_t *shift, const double *q) {
    double x[3], sum = s->weighted ? -s->weights[p] : 0;
    place_of(s, p, shift, x);
    for (int k = 0; k < 3; k++) sum += (x[k] - q[k]) * (x[k] - q[k]);
    return sum;
}

static double volume(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = d[k] - a[k];
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* Expects that the translate of a tetrahedron holds q. */
static void holds(const sample *s, const brio_image *at, const double *q) {
    double x[4][3];
    const brio_tetrahedron *tet = &brio_periodic_tetrahedra(s->t)[at->point];
    for (int i = 0; i < 4; i++)
        for (size_t k = 0; k < 3; k++) {
            x[i][k] = brio_periodic_positions(s->t)[3 * (size_t)tet->vertex[i] + k];
            for (size_t a = 0; a < 3; a++) x[i][k] += at->shift[a] * s->cell[3 * a + k];
        }
    EXPECT(volume(q, x[1], x[2], x[3]) >= -1e-12 && volume(x[0], q, x[2], x[3]) >= -1e-12 &&
           volume(x[0], x[1], q, x[3]) >= -1e-12 && volume(x[0], x[1], x[2], q) >= -1e-12);
}

static void nearest_is(const sample *s, const brio_image *found, const double *q) {
    double least = INFINITY;
    int32_t from[3], c[3];
    for (int k = 0; k < 3; k++) from[k] = s->open[k] ? 0 : found->shift[k];
    for (size_t p = 0; p < POINTS; p++)
        for (c[0] = from[0] - 2 * !s->open[0]; c[0] <= from[0] + 2 * !s->open[0]; c[0]++)
            for (c[1] = from[1] - 2 * !s->open[1]; c[1] <= from[1] + 2 * !s->open[1]; c[1]++)
                for (c[2] = from[2] - 2 * !s->open[2]; c[2] <= from[2] + 2 * !s->open[2]; c[2]++)
                    least = fmin(least, power(s, p, c, q));
    EXPECT(power(s, found->point, found->shift, q) <= least + 1e-12, "%g, not %g",
           power(s, found->point, found->shift, q), least);
}

/* Asks about places in many cells. Where all directions repeat, all are inside. */
static void locate_in(uint64_t seed, sample s, bool all_inside) {
    enum { QUERIES = 600 };
    static double q[3 * QUERIES];
    static brio_image tets[QUERIES], vertices[QUERIES];
    brio_periodic_locator *l = NULL;
    brio_rng rng = brio_rng_new(seed);
    size_t inside = 0;
    for (size_t i = 0; i < 3 * QUERIES; i++) q[i] = brio_rng_below(&rng, 1 << 20) * 0x1p-17 - 3;
    EXPECT(brio_periodic_locator_new(ctx, s.t, &l) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_periodic_locator_tetrahedra(ctx, l, q, QUERIES, tets) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_periodic_locator_least_power(ctx, l, q, QUERIES, vertices) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < QUERIES; i++) {
        nearest_is(&s, &vertices[i], q + 3 * i);
        inside += tets[i].point != BRIO_INFINITE;
        if (tets[i].point != BRIO_INFINITE) holds(&s, &tets[i], q + 3 * i);
    }
    EXPECT(all_inside ? inside == QUERIES : inside > 0 && inside < QUERIES, "%zu of %d inside", inside, (int)QUERIES);
    q[4] = NAN;
    EXPECT(brio_periodic_locator_tetrahedra(ctx, l, q, QUERIES, tets) == BRIO_ERR_NOT_FINITE);
    q[4] = 1e300;
    EXPECT(all_inside ? brio_periodic_locator_tetrahedra(ctx, l, q, QUERIES, tets) == BRIO_ERR_ARGUMENT : true);
    brio_periodic_locator_free(l);
    brio_periodic_free(s.t);
}

static void places_are_in_their_tetrahedra(void) {
    locate_in(1, make(11, CUBE, "xyz", 1 << 20, false), true);
    locate_in(2, make(12, TILTED, "xyz", 1 << 20, true), true);
    locate_in(3, make(13, CUBE, "xyz", 4, false), true);
    locate_in(4, make(14, TILTED, "xy", 1 << 20, false), false);
    locate_in(5, make(15, CUBE, "z", 16, true), false);
}

SUITE(test_periodic_queries) {
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
    RUN(alpha_is_that_of_many_copies);
    RUN(flat_points_have_no_alpha_complex);
    RUN(places_are_in_their_tetrahedra);
    brio_context_free(ctx);
    return harness_end();
}
