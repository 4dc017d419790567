/* The co-cone and the tight co-cone: manifold and oriented on anything, closed where they claim it, and on dense
 * samples of known surfaces all that the theory promises. */
#include "base/memory.h"
#include "failing_allocator.h"
#include "harness.h"
#include "known_surfaces.h"
#include "points.h"
#include "same_faces.h"
#include "surface_calls.h"
#include "reconstruct/cocone/cocone_candidates.h"

static const double PI = 3.141592653589793, THETA = 0.39269908169872414;

/* What threads do is for test_parallel_cocone; here they would only wait for each other. */
static brio_context *serial_context(void) {
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    return ctx;
}

/* --- any input --- */

static int is_certified(brio_context *ctx, const double *p, size_t n, const brio_surface_options *o, uint64_t trial) {
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_surface_stats s = {0};
    brio_status status = make_cocone(ctx, p, n, o, &mesh, &s);
    EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_ANSWER && !mesh), "trial %llu: %s", (unsigned long long)trial,
           brio_message(ctx));
    if (status != BRIO_OK) return 0;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.manifold && c.oriented && (c.closed || o->method != BRIO_SURFACE_TIGHT_COCONE),
           "trial %llu: manifold %d oriented %d closed %d", (unsigned long long)trial, c.manifold, c.oriented,
           c.closed);
    EXPECT(mesh->num_vertices == n && mesh->num_faces > 0 && s.unused < s.samples);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    return 1;
}

/* Small inputs to try. */
enum { TRIALS = BRIEF_TESTS ? 300 : SHORT_TESTS ? 2500 : 10000 };

static void small_inputs_are_manifold_oriented(void) {
    double p[3 * 40];
    int surfaces = 0;
    brio_context *ctx = serial_context();
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        brio_surface_options o = COCONE_OPTIONS;
        size_t n = 4 + trial % 37;
        o.method = trial & 1 ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE;
        o.boundaries = trial >> 1 & 1;
        o.density = trial >> 2 & 1;
        if (trial % 3 == 0)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 3 + (uint32_t)(trial % 3), p);
        surfaces += is_certified(ctx, p, n, &o, trial);
    }
    EXPECT(surfaces > TRIALS / 2, "%d", surfaces);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void large_noise_is_manifold_oriented(void) {
    static double p[3 * 20000];
    brio_context *ctx = serial_context();
    brio_surface_options o = COCONE_OPTIONS;
    for (int tight = 0; tight < 2; tight++) {
        o.method = tight ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE;
        uniform_points(5, 20000, p);
        is_certified(ctx, p, 20000, &o, 0);
        integer_points(6, 20000, 14, p);
        is_certified(ctx, p, 20000, &o, 1);
    }
    brio_context_free(ctx);
}

static void inputs_without_a_surface_say_so(void) {
    const double three[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, flat[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, .5, .5, 0};
    const double bad[9] = {0, 0, 0, 1, NAN, 0, 0, 1, INFINITY};
    brio_context *ctx = serial_context();
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh;
    EXPECT(make_cocone(ctx, NULL, 0, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_cocone(ctx, three, 3, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_cocone(ctx, flat, 5, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_cocone(ctx, bad, 3, NULL, &mesh, NULL) == BRIO_ERR_NOT_FINITE && !mesh);
    o.theta = -1;
    EXPECT(make_cocone(ctx, flat, 5, &o, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    o.theta = NAN;
    EXPECT(make_cocone(ctx, flat, 5, &o, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- known surfaces, from few samples --- */

typedef struct {
    int closed;
    size_t components, loops;
    int64_t genus;
    double volume;
} expectation;

static void expect_surface(const double *p, size_t n, const brio_surface_options *o, expectation e) {
    brio_context *ctx = serial_context();
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_surface_stats s = {0};
    EXPECT(make_cocone(ctx, p, n, o, &mesh, &s) == BRIO_OK, "%s", brio_message(ctx));
    if (mesh) {
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
        EXPECT(c.manifold && c.oriented && c.closed == e.closed && c.components == e.components && c.genus == e.genus,
               "closed %d, genus %lld, %zu components", c.closed, (long long)c.genus, c.components);
        EXPECT(c.boundary_loops == e.loops, "%zu loops", c.boundary_loops);
        EXPECT(e.volume == 0 || fabs(c.volume - e.volume) < 0.03 * e.volume, "volume %g", c.volume);
        EXPECT(s.samples == n && s.unused == 0, "%zu unused", s.unused);
    }
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void closed_surfaces_have_their_genus_and_volume(void) {
    static double p[3 * 6000];
    brio_surface_options o = COCONE_OPTIONS;
    for (int tight = 0; tight < 2; tight++) {
        o.method = tight ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE;
        torus_points(1, 6000, p);
        expect_surface(p, 6000, &o, (expectation){1, 1, 0, 1, 2 * PI * PI * 0.16});
        sphere_points(1, 2000, p);
        expect_surface(p, 2000, &o, (expectation){1, 1, 0, 0, 4.18879});
    }
}

/* The inner sphere bounds a hollow: its faces are seen from within it. */
static void nested_spheres_bound_a_shell(void) {
    static double p[3 * 4000];
    sphere_points(1, 3000, p);
    sphere_points(2, 1000, p + 9000);
    for (size_t i = 9000; i < 12000; i++) p[i] *= 0.5;
    brio_surface_options o = COCONE_OPTIONS;
    expect_surface(p, 4000, &o, (expectation){1, 2, 0, 0, 4.18879 * 0.875});
}

/* The part of a sphere's samples below a height. */
static size_t bowl_points(double height, size_t n, double *p) {
    size_t count = 0;
    sphere_points(3, n, p);
    for (size_t i = 0; i < n; i++)
        if (p[3 * i + 2] < height) memmove(p + 3 * count++, p + 3 * i, 3 * sizeof *p);
    return count;
}

static void a_bowl_is_open_and_the_tight_cocone_closes_it(void) {
    static double p[3 * 4000];
    brio_surface_options o = COCONE_OPTIONS;
    size_t n = bowl_points(0.5, 4000, p);
    o.boundaries = 1;
    expect_surface(p, n, &o, (expectation){0, 1, 1, 0, 0});
    o.boundaries = 0;
    o.method = BRIO_SURFACE_TIGHT_COCONE;
    expect_surface(p, n, &o, (expectation){1, 1, 0, 0, PI * (2.0 / 3 + 0.5 - 0.125 / 3)});
}

static void a_sheet_is_one_open_piece(void) {
    static double p[3 * 2500];
    brio_surface_options o = COCONE_OPTIONS;
    brio_rng rng = brio_rng_new(7);
    for (size_t i = 0; i < 2500; i++) {
        double x = (double)(i % 50) + 0.5 * brio_rng_double(&rng), y = (double)(i / 50) + 0.5 * brio_rng_double(&rng);
        p[3 * i] = x, p[3 * i + 1] = y, p[3 * i + 2] = 2 * sin(0.2 * x) * cos(0.15 * y);
    }
    expect_surface(p, 2500, &o, (expectation){0, 1, 1, 0, 0});
}

/* Samples of the torus of radii 1 and 0.4 that are not in one of `holes` balls round its outer equator. */
static size_t pierced_torus(int holes, double *p) {
    size_t count = 0;
    torus_points(4, 12000, p);
    for (size_t i = 0; i < 12000; i++) {
        double least = 9;
        for (int h = 0; h < holes; h++) {
            double x = p[3 * i] - 1.4 * cos(2 * h), y = p[3 * i + 1] - 1.4 * sin(2 * h), z = p[3 * i + 2];
            least = fmin(least, sqrt(x * x + y * y + z * z));
        }
        if (least > 0.42) memmove(p + 3 * count++, p + 3 * i, 3 * sizeof *p);
    }
    return count;
}

static void holes_cut_into_a_torus_are_loops_and_the_tight_cocone_closes_them(void) {
    static double p[3 * 12000];
    for (int holes = BRIEF_TESTS ? 2 : 0; holes < 4; holes++) {
        brio_surface_options o = COCONE_OPTIONS;
        size_t n = pierced_torus(holes, p);
        o.boundaries = 1;
        expect_surface(p, n, &o, (expectation){holes == 0, 1, (size_t)holes, 1, 0});
        o.boundaries = 0;
        o.method = BRIO_SURFACE_TIGHT_COCONE;
        expect_surface(p, n, &o, (expectation){1, 1, 0, 1, 0});
    }
}

/* Samples of a wavy sheet on a jittered grid, but for those within `radius` of its middle, off it by up to `noise`. */
static size_t pierced_sheet(double radius, double noise, double *p) {
    size_t count = 0;
    brio_rng rng = brio_rng_new(11);
    for (size_t i = 0; i < 2500; i++) {
        double x = (double)(i % 50) + 0.4 * brio_rng_double(&rng), y = (double)(i / 50) + 0.4 * brio_rng_double(&rng);
        double off = noise * (2 * brio_rng_double(&rng) - 1);
        if (hypot(x - 25, y - 25) < radius) continue;
        p[3 * count] = x, p[3 * count + 1] = y, p[3 * count++ + 2] = 2 * sin(0.2 * x) * cos(0.15 * y) + off;
    }
    return count;
}

static size_t count_loops(const double *p, size_t n, const brio_surface_options *o) {
    brio_context *ctx = serial_context();
    brio_mesh *mesh;
    brio_certificate c = {0};
    EXPECT(make_cocone(ctx, p, n, o, &mesh, NULL) == BRIO_OK);
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK && c.manifold && c.oriented);
    size_t loops = c.boundary_loops;
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
    return loops;
}

/* The hole of one missing sample is no wider than the gaps that noise leaves. */
static void holes_without_room_for_a_sample_are_closed(void) {
    static double p[3 * 2500];
    brio_surface_options o = COCONE_OPTIONS;
    for (int step = 0; step < 16; step++) {
        double radius = 0.6 * (step % 2), noise = 0.1 * (step / 2);
        EXPECT(count_loops(p, pierced_sheet(radius, noise, p), &o) == 1, "radius %g, noise %g", radius, noise);
    }
    o.boundaries = 1;
    EXPECT(count_loops(p, pierced_sheet(0.6, 0, p), &o) == 1);
    EXPECT(count_loops(p, pierced_sheet(18, 0, p), &o) == 2);
}

/* Jittered samples of the faces of a cube, none on its edges. */
static void sharp_edges_are_no_openings(void) {
    static double p[3 * 6 * 900];
    brio_rng rng = brio_rng_new(2);
    for (size_t i = 0; i < 5400; i++) {
        size_t face = i / 900, axis = face / 2;
        p[3 * i + axis] = face % 2 ? 30 : 0;
        p[3 * i + (axis + 1) % 3] = (double)(i % 30) + 0.3 + 0.4 * brio_rng_double(&rng);
        p[3 * i + (axis + 2) % 3] = (double)(i / 30 % 30) + 0.3 + 0.4 * brio_rng_double(&rng);
    }
    brio_surface_options o = COCONE_OPTIONS;
    o.boundaries = 1;
    expect_surface(p, 5400, &o, (expectation){1, 1, 0, 0, 27000});
}

/* Tip n is above and tip n + 1 below; a face is seen counterclockwise from outside. */
static void expect_double_cone(const brio_mesh *mesh, uint32_t n) {
    uint8_t *sides = calloc(n, 1); /* bit 0: with the tip above; bit 1: with the one below */
    EXPECT(mesh->num_faces == 2 * n, "%zu faces", mesh->num_faces);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *v = mesh->face_vertices + 3 * f;
        int tip = v[0] >= n ? 0 : v[1] >= n ? 1 : 2;
        uint32_t a = v[(tip + 1) % 3], b = v[(tip + 2) % 3], from = v[tip] == n ? a : b, to = v[tip] == n ? b : a;
        EXPECT(v[tip] >= n && a < n && b < n && to == (from + 1) % n, "%u %u %u", v[0], v[1], v[2]);
        if (from < n) sides[from] |= (uint8_t)(v[tip] == n ? 1 : 2);
    }
    for (uint32_t i = 0; i < n; i++) EXPECT(sides[i] == 3, "side %u", i);
    free(sides);
}

/* A double cone over a regular polygon: from its tips every sample is seen. The surface is known, triangle by triangle:
 * each side of the polygon has one with either tip. Memory stays in proportion to the samples. */
static void tips_of_high_degree_have_all_their_triangles(void) {
    enum { N = 20000, BYTES_A_SAMPLE = 1000 };
    static double p[3 * (N + 2)];
    brio_context *ctx = serial_context();
    for (int tight = 0; tight < 2; tight++) {
        brio_surface_options o = COCONE_OPTIONS;
        brio_mesh *mesh = NULL;
        o.method = tight ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE;
        for (size_t i = 0; i < N; i++)
            p[3 * i] = cos(2 * PI * (double)i / N), p[3 * i + 1] = sin(2 * PI * (double)i / N), p[3 * i + 2] = 0;
        p[3 * N] = p[3 * N + 1] = 0, p[3 * N + 2] = 1;
        p[3 * N + 3] = p[3 * N + 4] = 0, p[3 * N + 5] = -1;
        EXPECT(make_cocone(ctx, p, N + 2, &o, &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
        expect_double_cone(mesh, N);
        brio_mesh_free(mesh);
    }
    EXPECT(brio_context_memory_peak(ctx) < (size_t)BYTES_A_SAMPLE * N, "%zu bytes", brio_context_memory_peak(ctx));
    brio_context_free(ctx);
}

/* --- what the result depends on --- */

static void shuffled_samples_give_the_same_faces(void) {
    static double p[3 * 3000], q[3 * 3000];
    static size_t to[3000];
    brio_context *ctx = serial_context();
    for (int noisy = 0; noisy < 2; noisy++) {
        brio_mesh *a, *b;
        torus_points(2, 3000, p);
        brio_rng rng = brio_rng_new(3);
        for (int i = 0; noisy && i < 9000; i++) p[i] += 0.05 * brio_rng_double(&rng);
        shuffle_points(5, 3000, p, q, to);
        EXPECT(make_cocone(ctx, p, 3000, NULL, &a, NULL) == BRIO_OK);
        EXPECT(make_cocone(ctx, q, 3000, NULL, &b, NULL) == BRIO_OK);
        expect_same_faces(a, to, b);
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
    brio_context_free(ctx);
}

static void duplicates_and_scale_change_nothing(void) {
    static double p[3 * 2000], q[3 * 4000];
    torus_points(2, 2000, p);
    for (int i = 0; i < 12000; i++) q[i] = p[i % 6000] * 0x1p-400;
    brio_context *ctx = serial_context();
    brio_mesh *a, *b;
    brio_surface_stats s = {0};
    EXPECT(make_cocone(ctx, p, 2000, NULL, &a, NULL) == BRIO_OK);
    EXPECT(make_cocone(ctx, q, 4000, NULL, &b, &s) == BRIO_OK && s.samples == 2000);
    expect_same_faces(a, NULL, b);
    EXPECT(!memcmp(b->vertices, q, sizeof q));
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void density_of_a_sphere_is_measured(void) {
    static double p[3 * 3000];
    sphere_points(1, 3000, p);
    for (int i = 0; i < 9000; i++) p[i] *= 3;
    brio_context *ctx = serial_context();
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh;
    brio_surface_stats s = {0};
    o.density = 1;
    EXPECT(make_cocone(ctx, p, 3000, &o, &mesh, &s) == BRIO_OK);
    const brio_property *size = brio_mesh_property(mesh, "feature_size"), *r = brio_mesh_property(mesh, "r");
    size_t outside = 0;
    EXPECT(size && r);
    for (size_t i = 0; i < 3000; i++) {
        EXPECT(fabs(brio_property_value(size, i) - 3) < 1e-6);
        outside += brio_property_value(r, i) > 0.08;
    }
    EXPECT(outside == s.outside_guarantee && s.r_median > 0.02 && s.r_median < s.r_p95 && s.r_p95 < 0.2);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static brio_status small_cocone(brio_context *ctx) {
    double p[3 * 60];
    brio_mesh *mesh;
    brio_surface_options o = COCONE_OPTIONS;
    o.boundaries = o.density = 1;
    clustered_points(3, 60, p);
    brio_status status = make_cocone(ctx, p, 60, &o, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_cocone);
}

/* --- the theory, on r-samples with r <= 0.08 --- */

/* What the proofs speak of, for one r-sample. */
typedef struct {
    brio_context *ctx;
    const known_surface *surface;
    double *points;
    size_t n;
    brio_triangulation *t;
    brio_pole_vectors dual;
    brio_cocones cocones;
    size_t candidates;
} theory;

static double r_over(double r) {
    return r / (1 - r);
}

static double angle(const double *u, const double *v) {
    double uv = u[0] * v[0] + u[1] * v[1] + u[2] * v[2], uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    double vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    return acos(fmin(1, fabs(uv) / sqrt(uu * vv)));
}

/* Lemma 5 for every Voronoi vertex of every sample, and Lemma 6. */
static void check_cells(const theory *x) {
    double r = x->surface->r, lfs = x->surface->feature_size;
    for (size_t tet = 0; tet < x->dual.num_finite; tet++)
        for (int i = 0; i < 4; i++) {
            size_t p = x->dual.t.tet[tet].vertex[i];
            double to[3], normal[3];
            brio_towards_centre(&x->dual, tet, p, to);
            x->surface->normal(x->points + 3 * p, normal);
            double rho = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]) / lfs;
            if (rho <= r_over(r)) continue;
            EXPECT(angle(to, normal) <= asin(r_over(r) / rho) + asin(r_over(r)) + 1e-9, "lemma 5 at sample %zu", p);
        }
    for (size_t p = 0; p < x->n; p++) {
        double normal[3];
        x->surface->normal(x->points + 3 * p, normal);
        EXPECT(angle(x->dual.plane + 4 * p, normal) <= 2 * asin(r_over(r)) + 1e-9, "lemma 6 at sample %zu", p);
    }
}

/* Whether the Voronoi edge of a facet crosses the surface, looked at in 64 places near the facet; unless its ends are on
 * both sides, or on one side and together farther from the surface than from each other: values are distances. */
static bool is_restricted(const theory *x, uint32_t facet) {
    uint32_t here = brio_tet_of(facet), there = brio_tet_of(*brio_mate(&x->dual.t, facet));
    double a[3], b[3], reach = 4 * x->surface->feature_size;
    if (here >= x->dual.num_finite) here = there, there = brio_tet_of(facet);
    const double *end[2] = {x->dual.centre + 4 * (size_t)here, x->dual.centre + 4 * (size_t)there};
    for (int k = 0; k < 3; k++) {
        a[k] = end[0][k], b[k] = end[1][k];
        if (there >= x->dual.num_finite) b[k] = a[k] + reach * end[1][k];
    }
    double first = x->surface->value(a), last = x->surface->value(b), square = 0;
    for (int k = 0; k < 3; k++) square += (b[k] - a[k]) * (b[k] - a[k]);
    if ((last < 0) != (first < 0)) return true;
    if (fabs(first) + fabs(last) > sqrt(square) + 1e-9) return false;
    for (int i = 1; i <= 64; i++) {
        double y[3], s = i / 64.0;
        for (int k = 0; k < 3; k++) y[k] = a[k] + s * (b[k] - a[k]);
        if ((x->surface->value(y) < 0) != (first < 0)) return true;
    }
    return false;
}

/* The angle between a triangle and the tangent plane at the corner of its largest angle: theorem 26. */
static void check_normal(const theory *x, const uint32_t corner[3]) {
    const double *p[3];
    double normal[3], cross[3], longest = 0, alpha = asin(1.3 * r_over(x->surface->r));
    int largest = 0;
    for (int k = 0; k < 3; k++) p[k] = x->points + 3 * (size_t)corner[k];
    for (int k = 0; k < 3; k++) {
        const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        double d = (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
        if (d > longest) longest = d, largest = k;
    }
    for (int k = 0; k < 3; k++) {
        int m = (k + 1) % 3, n = (k + 2) % 3;
        cross[k] = (p[1][m] - p[0][m]) * (p[2][n] - p[0][n]) - (p[1][n] - p[0][n]) * (p[2][m] - p[0][m]);
    }
    x->surface->normal(p[largest], normal);
    EXPECT(angle(cross, normal) <= alpha + asin(2 / sqrt(3) * sin(2 * alpha)) + 1e-9, "theorem 26");
}

/* Distance from p to the nearest point of the segment between two Voronoi vertices. */
static double edge_distance(const theory *x, uint32_t p, uint32_t facet) {
    uint32_t here = brio_tet_of(facet), there = brio_tet_of(*brio_mate(&x->dual.t, facet));
    double a[3], b[3], d[3], ad = 0, dd = 0, square = 0;
    if (here >= x->dual.num_finite) here = there, there = brio_tet_of(facet);
    brio_towards_centre(&x->dual, here, p, a);
    brio_towards_centre(&x->dual, there, p, b);
    bool ray = there >= x->dual.num_finite;
    for (int k = 0; k < 3; k++) d[k] = ray ? b[k] : b[k] - a[k], ad -= a[k] * d[k], dd += d[k] * d[k];
    double s = fmax(0, dd > 0 ? ad / dd : 0);
    if (!ray) s = fmin(s, 1);
    for (int k = 0; k < 3; k++) square += (a[k] + s * d[k]) * (a[k] + s * d[k]);
    return sqrt(square);
}

/* An edge of a restricted triangle, and the corner across. */
typedef struct {
    uint32_t low, high, across;
} spoke;

static int compare_spokes(const void *a, const void *b) {
    const spoke *x = a, *y = b;
    return x->low != y->low ? (x->low < y->low ? -1 : 1) : x->high < y->high ? -1 : x->high > y->high;
}

static void add_spokes(spoke *list, const uint32_t corner[3]) {
    for (int k = 0; k < 3; k++) {
        uint32_t a = corner[(k + 1) % 3], b = corner[(k + 2) % 3];
        list[k] = (spoke){a < b ? a : b, a < b ? b : a, corner[k]};
    }
}

/* The angle between two triangles at their common edge. */
static double dihedral(const double *a, const double *b, const double *p, const double *q) {
    double d[3], u[3], v[3], dd = 0, du = 0, dv = 0, uv = 0, uu = 0, vv = 0;
    for (int k = 0; k < 3; k++) d[k] = b[k] - a[k], u[k] = p[k] - a[k], v[k] = q[k] - a[k];
    for (int k = 0; k < 3; k++) dd += d[k] * d[k], du += d[k] * u[k], dv += d[k] * v[k];
    for (int k = 0; k < 3; k++) u[k] -= du / dd * d[k], v[k] -= dv / dd * d[k];
    for (int k = 0; k < 3; k++) uv += u[k] * v[k], uu += u[k] * u[k], vv += v[k] * v[k];
    return acos(fmax(-1, fmin(1, uv / sqrt(uu * vv))));
}

/* Lemma 29: no restricted triangle has a sharp edge. The proof has it that adjacent ones meet at 120 degrees or more. */
static void check_no_sharp_edges(const theory *x, spoke *list, size_t count) {
    qsort(list, count, sizeof *list, compare_spokes);
    for (size_t i = 0; i + 1 < count; i += 2) {
        const spoke *s = list + i;
        EXPECT(compare_spokes(s, s + 1) == 0 && (i + 2 == count || compare_spokes(s, s + 2) != 0), "two at an edge");
        double angle = dihedral(x->points + 3 * (size_t)s->low, x->points + 3 * (size_t)s->high,
                                x->points + 3 * (size_t)s->across, x->points + 3 * (size_t)s[1].across);
        EXPECT(angle >= 2 * PI / 3, "lemma 29 at edge %u %u: %g", s->low, s->high, angle);
    }
}

/* Restricted Delaunay triangles are candidates (theorem 22); candidates are small (lemma 24) and flat (theorem 26). */
static void check_candidates(const theory *x) {
    size_t restricted = 0, expected = 2 * x->n - 4 + 4 * (size_t)x->surface->genus;
    spoke *spokes = malloc(3 * expected * sizeof *spokes);
    for (uint32_t facet = 0; facet < 4 * x->dual.t.count; facet++) {
        const uint32_t *v = x->dual.t.tet[brio_tet_of(facet)].vertex;
        uint32_t corner[3];
        for (int k = 0; k < 3; k++) corner[k] = v[BRIO_FACET[brio_slot_of(facet)][k]];
        if (*brio_mate(&x->dual.t, facet) < facet || corner[0] == BRIO_INFINITE || corner[1] == BRIO_INFINITE ||
            corner[2] == BRIO_INFINITE)
            continue;
        bool is_one = is_restricted(x, facet);
        if (is_one && restricted < expected) add_spokes(spokes + 3 * restricted, corner);
        restricted += is_one;
        EXPECT(!is_one || brio_is_candidate(&x->cocones, facet), "theorem 22 at facet %u", facet);
        if (!brio_is_candidate(&x->cocones, facet)) continue;
        check_normal(x, corner);
        for (int k = 0; k < 3; k++)
            EXPECT(edge_distance(x, corner[k], facet) <= 1.3 * r_over(x->surface->r) * x->surface->feature_size + 1e-12,
                   "lemma 24 at facet %u", facet);
    }
    EXPECT(restricted == expected && x->candidates >= restricted, "%zu restricted triangles of %zu samples", restricted,
           x->n);
    if (restricted == expected) check_no_sharp_edges(x, spokes, 3 * expected);
    free(spokes);
}

/* Theorem 19: the right topology, near the surface everywhere (looked at on a grid in each triangle). */
static void check_result(const theory *x) {
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_surface_stats s = {0};
    double limit = 1.3 * r_over(x->surface->r) * x->surface->feature_size;
    EXPECT(make_cocone(x->ctx, x->points, x->n, NULL, &mesh, &s) == BRIO_OK);
    EXPECT(brio_mesh_certificate(x->ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == x->surface->genus && s.unused == 0);
    EXPECT(s.relabeled == 0, "%zu", s.relabeled);
    for (size_t f = 0; f < mesh->num_faces; f++)
        for (int i = 0; i < 16; i++) {
            double a = (i & 3) / 3.0, b = (i >> 2) / 3.0, y[3] = {0, 0, 0};
            if (a + b > 1) continue;
            const double weight[3] = {1 - a - b, a, b};
            for (int k = 0; k < 9; k++)
                y[k % 3] += weight[k / 3] * mesh->vertices[3 * mesh->face_vertices[3 * f + (size_t)(k / 3)] + k % 3];
            EXPECT(fabs(x->surface->value(y)) <= limit, "theorem 19 at face %zu", f);
        }
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
}

static void check_theory(const known_surface *surface) {
    theory x = {.ctx = serial_context(), .surface = surface};
    x.points = surface->sample(surface->r, 11, &x.n);
    EXPECT(brio_delaunay(x.ctx, x.points, NULL, x.n, NULL, &x.t) == BRIO_OK);
    EXPECT(brio_pole_vectors_find(x.ctx, x.t, x.points, x.n, THETA, &x.dual) == BRIO_OK);
    EXPECT(brio_cocones_new(x.ctx, &x.dual, &x.cocones) == BRIO_OK);
    brio_cocones_select(x.ctx, &x.cocones, &x.candidates);
    check_cells(&x);
    check_candidates(&x);
    check_result(&x);
    brio_cocones_free(x.ctx, &x.cocones);
    brio_pole_vectors_free(x.ctx, &x.dual);
    brio_triangulation_free(x.t);
    EXPECT(brio_context_memory(x.ctx) == 0);
    free(x.points);
    brio_context_free(x.ctx);
}

static void theory_holds_on_a_sphere(void) {
    check_theory(&known_sphere);
}

static void theory_holds_on_a_torus(void) {
    check_theory(&known_torus);
}

static void theory_holds_on_a_plate_of_genus_3(void) {
    check_theory(&known_plate);
}

SUITE(test_cocone) {
    RUN(small_inputs_are_manifold_oriented);
    RUN(large_noise_is_manifold_oriented);
    RUN(inputs_without_a_surface_say_so);
    RUN(closed_surfaces_have_their_genus_and_volume);
    RUN(nested_spheres_bound_a_shell);
    RUN(a_bowl_is_open_and_the_tight_cocone_closes_it);
    RUN(a_sheet_is_one_open_piece);
    RUN(holes_cut_into_a_torus_are_loops_and_the_tight_cocone_closes_them);
    RUN(holes_without_room_for_a_sample_are_closed);
    RUN(sharp_edges_are_no_openings);
    RUN(tips_of_high_degree_have_all_their_triangles);
    RUN(shuffled_samples_give_the_same_faces);
    RUN(duplicates_and_scale_change_nothing);
    RUN(density_of_a_sphere_is_measured);
    RUN(theory_holds_on_a_sphere);
    RUN(theory_holds_on_a_torus);
    if (!BRIEF_TESTS)
        RUN(theory_holds_on_a_plate_of_genus_3); /* checks of angles and distances; the torus has them, too */
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
