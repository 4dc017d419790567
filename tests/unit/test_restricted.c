/* Restricted Delaunay triangulations: signs that agree with each other however they are asked for, one answer for any order,
 * the right topology wherever it is certified, clean ends. The numbers are judged by tests/cli/test_restricted.py. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "predicates/bisectors.h"

enum { GRID = 3, TRIES = 3000 };

static void place(brio_rng *rng, double p[3]) {
    for (int k = 0; k < 3; k++) p[k] = brio_rng_below(rng, GRID);
}

static bool same(const double *p, const double *q) {
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* On a small grid most calls are ties. An exchange of two samples, or of two corners, turns the sign. */
static void exchanges_turn_signs(void) {
    brio_bisector_counts n = {0, 0};
    brio_rng rng = brio_rng_new(1);
    int zeros = 0, sides = 0;
    for (int i = 0; i < TRIES; i++) {
        double s[4][3], p[3][3];
        for (int k = 0; k < 4; k++) place(&rng, s[k]);
        for (int k = 0; k < 3; k++) place(&rng, p[k]);
        bool apart = true;
        for (int k = 0; k < 4; k++)
            for (int j = 0; j < k; j++) apart &= !same(s[j], s[k]);
        if (!apart) continue;
        EXPECT(brio_nearer_sample(&n, s[0], s[1], p[0]) == -brio_nearer_sample(&n, s[1], s[0], p[0]));
        int order = brio_bisector_order(&n, s[0], s[1], s[2], p[0], p[1]);
        EXPECT(order == -brio_bisector_order(&n, s[0], s[2], s[1], p[0], p[1]));
        EXPECT(order == -brio_bisector_order(&n, s[0], s[1], s[2], p[1], p[0]));
        EXPECT(order ==
               brio_bisector_order(&n, s[1], s[2], s[0], p[0], p[1])); /* the same point, from another sample */
        zeros += order == 0;
        const double *a[4] = {s[0], s[1], s[2], s[3]}, *b[4] = {s[0], s[2], s[1], s[3]},
                     *c[4] = {s[1], s[0], s[2], s[3]};
        const double *at[3] = {p[0], p[1], p[2]}, *turned[3] = {p[1], p[0], p[2]};
        int side = brio_bisector_side(&n, a, at);
        EXPECT(side == -brio_bisector_side(&n, b, at) && side == -brio_bisector_side(&n, c, at));
        EXPECT(side == -brio_bisector_side(&n, a, turned));
        sides += side != 0;
    }
    EXPECT(n.ties > TRIES && n.exact >= n.ties && zeros < TRIES / 2 && sides > TRIES / 4, "%d ties, %d zeros, %d sides",
           (int)n.ties, zeros, sides);
}

/* Far from ties the signs are those of plain arithmetic, at any scale. */
static void scales_do_not_turn_signs(void) {
    static double p[3 * 7 * 100];
    brio_bisector_counts n = {0, 0};
    uniform_points(5, 700, p);
    for (int i = 0; i < 100; i++) {
        int expected[3];
        for (int scale = 0; scale < 3; scale++) {
            const double factor[3] = {1, 0x1p-600, 0x1p500};
            double q[21];
            for (int k = 0; k < 21; k++) q[k] = factor[scale] * p[21 * i + k];
            const double *s[4] = {q, q + 3, q + 6, q + 9}, *at[3] = {q + 12, q + 15, q + 18};
            int found[3] = {brio_nearer_sample(&n, q, q + 3, q + 12),
                            brio_bisector_order(&n, q, q + 3, q + 6, q + 12, q + 15), brio_bisector_side(&n, s, at)};
            for (int k = 0; k < 3; k++) {
                if (scale == 0) expected[k] = found[k];
                EXPECT(found[k] == expected[k] && found[k] != 0, "set %d, sign %d, scale %d", i, k, scale);
            }
        }
    }
    EXPECT(n.exact > 0 && n.ties == 0);
}

/* --- surfaces --- */

static brio_mesh *torus_of(brio_context *ctx, size_t side) {
    brio_mesh *mesh = NULL;
    size_t n = side * side;
    double *p = malloc(3 * n * sizeof *p);
    uint32_t *v = malloc(6 * n * sizeof *v);
    uint64_t *offsets = malloc((2 * n + 1) * sizeof *offsets);
    for (size_t i = 0; i < n; i++) {
        double a = 6.283185307179586 * (double)(i / side) / (double)side,
               b = 6.283185307179586 * (double)(i % side) / (double)side;
        double r = 1 + 0.4 * cos(b);
        p[3 * i] = r * cos(a), p[3 * i + 1] = r * sin(a), p[3 * i + 2] = 0.4 * sin(b);
        uint32_t w[4] = {(uint32_t)i, (uint32_t)((i + side) % n),
                         (uint32_t)((i / side + 1) % side * side + (i + 1) % side),
                         (uint32_t)(i / side * side + (i + 1) % side)};
        const int corner[6] = {0, 1, 2, 0, 2, 3};
        for (int k = 0; k < 6; k++) v[6 * i + (size_t)k] = w[corner[k]];
        offsets[2 * i] = 6 * i, offsets[2 * i + 1] = 6 * i + 3;
    }
    offsets[2 * n] = 6 * n;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, p, n) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, v, 2 * n) == BRIO_OK);
    free(p), free(v), free(offsets);
    return mesh;
}

static brio_restricted_stats run(brio_context *ctx, const double *points, size_t n, const brio_mesh *surface,
                                 brio_mesh **out) {
    brio_restricted_stats s = {0};
    EXPECT(brio_restricted_delaunay(ctx, points, n, surface, out, &s) == BRIO_OK, "%s", brio_message(ctx));
    return s;
}

/* Samples of every density on a torus: where the closed-ball property holds, the triangles are a torus; it holds for the dense
 * ones and not for the sparse ones. */
static void certified_triangulations_are_right(void) {
    brio_context *ctx = new_context();
    brio_mesh *surface = torus_of(ctx, 60);
    int certified = 0, refused = 0;
    for (size_t step = 1; step < 400; step = step * (BRIEF_TESTS ? 6 : 5) / 4 + 1) {
        double samples[3 * 3600];
        size_t n = 0;
        for (size_t i = 0; i < surface->num_vertices; i += step, n++)
            memcpy(samples + 3 * n, surface->vertices + 3 * i, 24);
        brio_mesh *out;
        brio_certificate c = {0};
        brio_restricted_stats s = run(ctx, samples, n, surface, &out);
        EXPECT(brio_mesh_certificate(ctx, out, &c) == BRIO_OK && s.edges == out->num_faces && s.crossings >= s.edges);
        if (s.closed_ball) {
            certified++;
            EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 1, "step %zu", step);
            EXPECT(s.cells + s.edges == s.facets, "Euler, step %zu", step);
            EXPECT(c.volume > 0);
        } else
            refused++;
        EXPECT(s.closed_ball == (s.bad_cells + s.bad_facets + s.bad_edges == 0));
        EXPECT(step > 3 || s.closed_ball, "step %zu", step);
        EXPECT(step < 200 || !s.closed_ball, "step %zu", step);
        brio_certificate_free(&c);
        brio_mesh_free(out);
    }
    EXPECT(certified >= 3 && refused >= 3, "%d certified, %d refused", certified, refused);
    brio_mesh_free(surface);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* The triangles are the same for samples in another order, and for other numbers of threads. */
static void order_and_threads_do_not_matter(void) {
    enum { N = 400 };
    double points[3 * N], shuffled[3 * N];
    size_t to[N];
    brio_context *ctx = new_context();
    brio_mesh *surface = torus_of(ctx, 24), *a, *b;
    torus_points(3, N, points);
    shuffle_points(1, N, points, shuffled, to);
    brio_restricted_stats s = run(ctx, points, N, surface, &a);
    brio_context_set_threads(ctx, 3);
    brio_restricted_stats t = run(ctx, shuffled, N, surface, &b);
    EXPECT(s.cells == t.cells && s.facets == t.facets && s.edges == t.edges && s.crossings == t.crossings);
    EXPECT(s.bad_cells == t.bad_cells && s.bad_facets == t.bad_facets && s.bad_edges == t.bad_edges &&
           s.ties == t.ties);
    uint64_t sum[2] = {0, 0};
    for (size_t f = 0; f < a->num_faces; f++)
        for (int which = 0; which < 2; which++) {
            uint64_t key = 0;
            const uint32_t *v = (which ? b : a)->face_vertices + 3 * f;
            for (int k = 0; k < 3; k++) key += brio_mix(which ? v[k] : to[v[k]]);
            sum[which] += brio_mix(key);
        }
    EXPECT(a->num_faces == b->num_faces && sum[0] == sum[1]);
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_mesh_free(surface);
    brio_context_free(ctx);
}

static void bad_samples_are_told(void) {
    brio_context *ctx = new_context();
    brio_mesh *surface = torus_of(ctx, 20), *out;
    double samples[3 * 401];
    memcpy(samples, surface->vertices, sizeof(double[3 * 400]));
    double centre[3] = {1, 0, 0}; /* in the tube: its cell meets the surface in bands, or not at all */
    memcpy(samples + 3 * 400, centre, sizeof centre);
    for (size_t n = 400; n <= 401; n++) {
        brio_restricted_stats s = run(ctx, samples, n, surface, &out);
        const brio_property *p = out->properties;
        size_t bad = 0;
        for (size_t i = 0; i < n; i++) bad += !((const uint8_t *)p->data)[i];
        EXPECT(!strcmp(p->name, "closed_ball") && (bad > 0) == !s.closed_ball, "%zu bad of %zu", bad, n);
        brio_mesh_free(out);
    }
    brio_mesh_free(surface);
    brio_context_free(ctx);
}

static void wrong_surfaces_are_refused(void) {
    brio_context *ctx = new_context();
    brio_mesh *surface = torus_of(ctx, 12), *out;
    double flat[3 * 5] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 3, 0};
    EXPECT(brio_restricted_delaunay(ctx, flat, 5, surface, &out, NULL) == BRIO_ERR_NO_ANSWER && !out);
    EXPECT(strstr(brio_message(ctx), "dimension 2"), "%s", brio_message(ctx));
    surface->vertices[4] = NAN;
    EXPECT(brio_restricted_delaunay(ctx, flat, 5, surface, &out, NULL) == BRIO_ERR_NOT_FINITE && !out);
    surface->vertices[4] = 0;
    surface->num_faces--;
    EXPECT(brio_restricted_delaunay(ctx, flat, 5, surface, &out, NULL) == BRIO_ERR_ARGUMENT && !out);
    EXPECT(strstr(brio_message(ctx), "no closed manifold"), "%s", brio_message(ctx));
    brio_mesh_free(surface);
    brio_context_free(ctx);
}

static brio_status small_run(brio_context *ctx) {
    static const double octahedron[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    static const uint32_t v[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    static const uint64_t offsets[9] = {0, 3, 6, 9, 12, 15, 18, 21, 24};
    double points[3 * 30];
    brio_mesh *surface = NULL, *out = NULL;
    uniform_points(2, 30, points);
    brio_status status = brio_mesh_new(ctx, &surface);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(surface, octahedron, 6);
    if (status == BRIO_OK) status = brio_mesh_set_faces(surface, offsets, v, 8);
    if (status == BRIO_OK) status = brio_restricted_delaunay(ctx, points, 30, surface, &out, NULL);
    brio_mesh_free(surface);
    brio_mesh_free(out);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_run);
}

SUITE(test_restricted) {
    RUN(exchanges_turn_signs);
    RUN(scales_do_not_turn_signs);
    RUN(certified_triangulations_are_right);
    RUN(order_and_threads_do_not_matter);
    RUN(bad_samples_are_told);
    RUN(wrong_surfaces_are_refused);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
