/* Curves of points in a plane and spanning trees: one answer for any order, scale and plane; no crossings, no branches; the tree
 * of least length; clean ends. Whether curves are the right ones is judged by tests/cli/test_curve.py. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "predicates/lengths.h"
#include <math.h>
#include <string.h>

enum { MOST = 400 };

/* Points of two circles, one in the other, and an open line, in a plane with these axes. */
static size_t scene(double scale, const double u[3], const double v[3], double *out) {
    size_t n = 0;
    double p[MOST][2];
    for (int i = 0; i < 90; i++, n++) p[n][0] = cos(0.07 * i), p[n][1] = sin(0.07 * i);
    for (int i = 0; i < 40; i++, n++) p[n][0] = 0.6 * cos(0.16 * i), p[n][1] = 0.6 * sin(0.16 * i);
    for (int i = 0; i < 30; i++, n++) p[n][0] = 2 + 0.01 * i * i / 9, p[n][1] = 0.08 * i;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++) out[3 * i + k] = scale * (p[i][0] * u[k] + p[i][1] * v[k]);
    return n;
}

static const double X[3] = {1, 0, 0}, Y[3] = {0, 1, 0}, TILTED_X[3] = {0.48, 0.6, 0.64}, TILTED_Y[3] = {0.8, -0.6, 0};

static bool has_edge(const brio_mesh *mesh, uint32_t a, uint32_t b) {
    const uint32_t *sample = brio_mesh_property(mesh, "sample")->data;
    for (size_t e = 0; e < mesh->num_edges; e++) {
        uint32_t p = sample[mesh->edges[2 * e]], q = sample[mesh->edges[2 * e + 1]];
        if ((p == a && q == b) || (p == b && q == a)) return true;
    }
    return false;
}

static void expect_scene(const brio_mesh *mesh, const brio_curve_stats *s, const uint32_t *from, const char *what) {
    EXPECT(s->curves == 3 && s->closed == 2 && s->ends == 2 && s->corners == 0 && s->isolated == 0,
           "%s: %zu curves, %zu closed, %zu ends, %zu corners", what, s->curves, s->closed, s->ends, s->corners);
    EXPECT(mesh->num_edges == 159 && s->edges == 159);
    for (uint32_t i = 0; i < 159; i++) {
        uint32_t next = i == 89 ? 0 : i == 129 ? 90 : i + 1;
        EXPECT(has_edge(mesh, from ? from[i] : i, from ? from[next] : next), "%s: no edge from %u to %u", what, i,
               next);
    }
}

static void curves_do_not_depend_on_scale_plane_or_order(void) {
    brio_context *ctx = new_context();
    const double scales[3] = {1, 0x1p-900, 0x1p1000};
    double p[3 * MOST], q[3 * MOST];
    uint32_t place[MOST];
    for (int tilted = 0; tilted < 2; tilted++)
        for (int i = 0; i < 3; i++) {
            brio_mesh *mesh = NULL;
            brio_curve_stats s = {0};
            size_t n = scene(scales[i], tilted ? TILTED_X : X, tilted ? TILTED_Y : Y, p);
            EXPECT(brio_curve(ctx, p, n, NULL, &mesh, &s) == BRIO_OK, "%s", brio_message(ctx));
            if (mesh) expect_scene(mesh, &s, NULL, "as it is");
            brio_mesh_free(mesh);
            for (uint32_t k = 0; k < n; k++) {
                place[k] = (k * 53 + 7) % (uint32_t)n; /* 53 and 160 have no common divisor */
                memcpy(q + 3 * (size_t)place[k], p + 3 * (size_t)k, 3 * sizeof *p);
            }
            EXPECT(brio_curve(ctx, q, n, NULL, &mesh, &s) == BRIO_OK);
            if (mesh) expect_scene(mesh, &s, place, "in another order");
            brio_mesh_free(mesh);
        }
    brio_context_free(ctx);
}

static int side(const double *a, const double *b, const double *c) {
    double p[3][2] = {{a[0], a[1]}, {b[0], b[1]}, {c[0], c[1]}};
    return brio_orient2d(p[0], p[1], p[2]);
}

/* Points at random, thinned to a band along two lines that cross: nothing that curves are made for. */
static void curves_never_cross_or_branch(void) {
    brio_context *ctx = new_context();
    brio_rng rng = brio_rng_new(3);
    for (int round = 0; round < 20; round++) {
        double p[3 * MOST];
        brio_mesh *mesh = NULL;
        brio_curve_certificate c = {0};
        for (size_t i = 0; i < 200; i++) {
            double t = 2 * brio_rng_double(&rng) - 1, wide = 0.002 * brio_rng_double(&rng);
            p[3 * i] = t, p[3 * i + 1] = (i & 1 ? t : -t) * 0.9 + wide, p[3 * i + 2] = 0;
        }
        brio_status status = brio_curve(ctx, p, 200, NULL, &mesh, NULL);
        EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_ANSWER);
        if (status != BRIO_OK) continue;
        EXPECT(brio_mesh_curve_certificate(ctx, mesh, &c) == BRIO_OK);
        EXPECT(c.branches == 0 && c.manifold);
        for (size_t e = 0; e < mesh->num_edges; e++)
            for (size_t f = 0; f < e; f++) {
                const uint32_t *a = mesh->edges + 2 * e, *b = mesh->edges + 2 * f;
                const double *v[4] = {mesh->vertices + 3 * (size_t)a[0], mesh->vertices + 3 * (size_t)a[1],
                                      mesh->vertices + 3 * (size_t)b[0], mesh->vertices + 3 * (size_t)b[1]};
                bool cross = side(v[0], v[1], v[2]) * side(v[0], v[1], v[3]) < 0 &&
                             side(v[2], v[3], v[0]) * side(v[2], v[3], v[1]) < 0;
                EXPECT(!cross, "edges %zu and %zu", e, f);
            }
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

static void few_and_equal_points(void) {
    brio_context *ctx = new_context();
    const double p[] = {0, 0, 0, 1, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 9, 0, 0, 10, 0, 0, 11, 0, 0};
    brio_mesh *mesh = NULL;
    brio_curve_stats s = {0};
    brio_curve_options o = {0};
    EXPECT(brio_curve(ctx, p, 0, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(brio_curve(ctx, p, 1, NULL, &mesh, &s) == BRIO_OK && s.isolated == 1 && s.edges == 0);
    brio_mesh_free(mesh);
    EXPECT(brio_curve(ctx, p + 3, 2, NULL, &mesh, &s) == BRIO_OK && s.samples == 1 && s.isolated == 1);
    brio_mesh_free(mesh);
    EXPECT(brio_curve(ctx, p, 8, NULL, &mesh, &s) == BRIO_OK);
    EXPECT(s.samples == 7 && s.curves == 2 && s.ends == 4 && s.gaps == 1, "%zu curves, %zu gaps", s.curves, s.gaps);
    EXPECT(((const uint32_t *)brio_mesh_property(mesh, "sample")->data)[2] == 3);
    brio_mesh_free(mesh);
    o.open = 7;
    EXPECT(brio_curve(ctx, p, 8, &o, &mesh, &s) == BRIO_OK && s.curves == 1 && s.gaps == 0);
    brio_mesh_free(mesh);
    o.open = 0.5;
    EXPECT(brio_curve(ctx, p, 8, &o, &mesh, &s) == BRIO_ERR_ARGUMENT && !mesh);
    brio_context_free(ctx);
}

static void planes_and_areas_are_told_apart(void) {
    brio_context *ctx = new_context();
    static double p[3 * 900];
    brio_mesh *mesh = NULL;
    for (int i = 0; i < 900; i++) p[3 * i] = i % 30, p[3 * i + 1] = i / 30, p[3 * i + 2] = 0;
    EXPECT(brio_curve(ctx, p, 900, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && strstr(brio_message(ctx), "on an area"));
    uniform_points(5, 900, p);
    EXPECT(brio_curve(ctx, p, 900, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER &&
           strstr(brio_message(ctx), "not in a plane"));
    for (int i = 0; i < 900; i++) p[3 * i + 2] = 4;
    EXPECT(brio_curve(ctx, p, 900, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && strstr(brio_message(ctx), "on an area"));
    brio_context_free(ctx);
}

/* Even points along a circle of which one is missing stay closed, of which five are missing end there. */
static void ends_are_where_points_are_missing(void) {
    brio_context *ctx = new_context();
    for (int missing = 0; missing < 6; missing++) {
        double p[3 * MOST] = {0};
        brio_mesh *mesh = NULL;
        brio_curve_stats s = {0};
        size_t n = 100 - (size_t)missing;
        for (size_t i = 0; i < n; i++)
            p[3 * i] = cos(0.0628318530717958647 * (double)i), p[3 * i + 1] = sin(0.0628318530717958647 * (double)i);
        EXPECT(brio_curve(ctx, p, n, NULL, &mesh, &s) == BRIO_OK);
        EXPECT(s.ends == (missing < 2 ? 0u : 2u) && s.curves == 1, "%d missing: %zu ends", missing, s.ends);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

/* --- trees --- */

/* The length of the tree that Prim's algorithm finds among all pairs. */
static double length_by_brute_force(const double *p, size_t n) {
    double near[MOST], sum = 0;
    bool in[MOST] = {false};
    for (size_t i = 0; i < n; i++) near[i] = INFINITY;
    for (size_t at = 0, step = 1; step < n; step++) {
        size_t next = n;
        in[at] = true;
        for (size_t i = 0; i < n; i++) {
            double d[3] = {p[3 * i] - p[3 * at], p[3 * i + 1] - p[3 * at + 1], p[3 * i + 2] - p[3 * at + 2]};
            if (!in[i]) near[i] = fmin(near[i], sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
            if (!in[i] && (next == n || near[i] < near[next])) next = i;
        }
        sum += near[next];
        at = next;
    }
    return sum;
}

static void trees_are_of_least_length(void) {
    brio_context *ctx = new_context();
    for (int kind = 0; kind < 6; kind++) {
        double p[3 * MOST];
        brio_mesh *tree = NULL;
        brio_spanning_tree_stats s = {0};
        brio_curve_certificate c = {0};
        uniform_points((uint64_t)kind, MOST, p);
        for (size_t i = 0; i < 3 * MOST; i++) {
            if (kind & 1) p[i] = floor(7 * p[i]); /* ties and duplicates */
            if (kind / 2 == 1 && i % 3 == 2) p[i] = 2;
            if (kind / 2 == 2) p[i] = p[i - i % 3]; /* a line */
        }
        EXPECT(brio_spanning_tree(ctx, p, MOST, &tree, &s) == BRIO_OK, "%s", brio_message(ctx));
        if (!tree) continue;
        EXPECT(brio_mesh_curve_certificate(ctx, tree, &c) == BRIO_OK);
        EXPECT(c.components == 1 && tree->num_edges == tree->num_vertices - 1 && c.isolated == 0);
        EXPECT(fabs(s.length - length_by_brute_force(p, MOST)) <= 1e-9 * s.length && fabs(s.length - c.length) < 1e-9,
               "kind %d: %g, not %g", kind, s.length, length_by_brute_force(p, MOST));
        EXPECT(s.dimension == 3 - kind / 2 && s.vertices == tree->num_vertices && s.edges == tree->num_edges);
        brio_mesh_free(tree);
    }
    brio_context_free(ctx);
}

/* On a grid all edges of the tree have one length: which of them are taken is the same for every order of the points. */
static void trees_of_ties_do_not_depend_on_the_order(void) {
    brio_context *ctx = new_context();
    enum { N = 343 };
    double p[3 * N], q[3 * N];
    brio_mesh *a = NULL, *b = NULL;
    for (int flat = 0; flat < 2; flat++) {
        size_t n = flat ? 49 : N;
        for (size_t i = 0; i < n; i++) {
            p[3 * i] = (double)(i % 7) * 0.1, p[3 * i + 1] = (double)(i / 7 % 7) * 0.1, p[3 * i + 2] = (double)(i / 49);
            memcpy(q + 3 * (i * 29 % n), p + 3 * i, 3 * sizeof *p);
        }
        EXPECT(brio_spanning_tree(ctx, p, n, &a, NULL) == BRIO_OK &&
               brio_spanning_tree(ctx, q, n, &b, NULL) == BRIO_OK);
        EXPECT(a->num_edges == b->num_edges && a->num_edges == n - 1);
        for (size_t i = 0; i < 2 * a->num_edges; i++)
            EXPECT(!memcmp(a->vertices + 3 * (size_t)a->edges[i], b->vertices + 3 * (size_t)b->edges[i],
                           3 * sizeof(double)),
                   "end %zu", i);
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
    brio_context_free(ctx);
}

static void lengths_are_compared_exactly(void) {
    const double o[3] = {0, 0, 0}, a[3] = {3, 4, 0}, b[3] = {0, 0, 5}, c[3] = {0, 0x1p-40, 5}, d[3] = {0x1p1000, 0, 0};
    const double tiny[3] = {0x1p-1000, 0, 0}, small[3] = {0, 0x1p-1000, 0x1p-1050};
    uint64_t exact = 0;
    EXPECT(brio_compare_lengths(o, a, o, b, &exact) == 0 && exact == 1);
    EXPECT(brio_compare_lengths(o, a, o, c, &exact) == -1 && exact == 2);
    EXPECT(brio_compare_lengths(c, o, b, o, &exact) == 1);
    EXPECT(brio_compare_lengths(o, d, a, d, &exact) == 1 && brio_compare_lengths(d, o, o, d, &exact) == 0);
    EXPECT(brio_compare_lengths(o, tiny, o, small, &exact) == -1 && brio_compare_lengths(o, o, b, b, &exact) == 0);
}

static brio_status curve_and_tree(brio_context *ctx) {
    double p[3 * MOST];
    size_t n = scene(1, TILTED_X, TILTED_Y, p);
    brio_mesh *curve = NULL, *tree = NULL;
    brio_status status = brio_curve(ctx, p, n, NULL, &curve, NULL);
    if (status == BRIO_OK) status = brio_spanning_tree(ctx, p, n, &tree, NULL);
    EXPECT((status == BRIO_OK) == (tree != NULL));
    brio_mesh_free(curve);
    brio_mesh_free(tree);
    return status;
}

static void failures_leave_nothing(void) {
    expect_clean_failures(curve_and_tree);
}

static void memory_is_as_documented(void) {
    enum { N = 100000 };
    brio_context *ctx = new_context();
    double *p = calloc(3 * N, sizeof *p);
    brio_mesh *mesh = NULL;
    for (size_t i = 0; i < N; i++) p[3 * i] = cos(6.28e-5 * (double)i), p[3 * i + 1] = sin(6.28e-5 * (double)i);
    EXPECT(brio_curve(ctx, p, N, NULL, &mesh, NULL) == BRIO_OK);
    double bytes = (double)brio_context_memory_peak(ctx) / N;
    EXPECT(bytes > 125 && bytes < 250, "%g bytes a point", bytes);
    brio_mesh_free(mesh);
    free(p);
    brio_context_free(ctx);
}

SUITE(test_curve) {
    RUN(curves_do_not_depend_on_scale_plane_or_order);
    RUN(curves_never_cross_or_branch);
    RUN(few_and_equal_points);
    RUN(planes_and_areas_are_told_apart);
    RUN(ends_are_where_points_are_missing);
    RUN(trees_are_of_least_length);
    RUN(trees_of_ties_do_not_depend_on_the_order);
    RUN(lengths_are_compared_exactly);
    RUN(failures_leave_nothing);
    RUN(memory_is_as_documented);
    return harness_end();
}
