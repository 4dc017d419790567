/* The power crust: closed, manifold and oriented on anything that has an inside; independent of the order of the
 * samples. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include <math.h>

/* Runs the crust and its certificate; 1 when a surface came out, 0 when there is no inside. */
static int crust_is_certified(brio_context *ctx, const double *p, size_t n, bool triangulate, uint64_t trial) {
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *mesh;
    brio_certificate c = {0};
    o.polygons = !(triangulate);
    brio_status status = make_crust(ctx, p, n, &o, &mesh, NULL, NULL);
    EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_ANSWER && !mesh), "trial %llu: %s", (unsigned long long)trial,
           brio_message(ctx));
    if (status != BRIO_OK) return 0;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.boundary_edges == 0 && c.flipped_edges == 0, "trial %llu",
           (unsigned long long)trial);
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) EXPECT(isfinite(mesh->vertices[i]));
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    return 1;
}

/* Small inputs to try. */
enum { TRIALS = BRIEF_TESTS ? 300 : SHORT_TESTS ? 2500 : 10000 };

/* TRIALS inputs of 4 to 40 points on small grids and in clusters, one in four cut into triangles. */
static void small_inputs_are_closed_manifold_oriented(void) {
    double p[3 * 40];
    int surfaces = 0;
    brio_context *ctx = new_context();
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        size_t n = 4 + trial % 37;
        if (trial % 3 == 0)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 3 + (uint32_t)(trial % 3), p);
        surfaces += crust_is_certified(ctx, p, n, trial % 4 == 0, trial);
    }
    EXPECT(surfaces > TRIALS / 2, "%d", surfaces);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void expect_genus(const double *p, size_t n, int64_t genus, double volume) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_surface_stats s = {0};
    EXPECT(make_crust(ctx, p, n, NULL, &mesh, NULL, &s) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.components == 1 && c.genus == genus && c.closed && c.manifold && c.oriented, "genus %lld, %zu components",
           (long long)c.genus, c.components);
    EXPECT(fabs(c.volume - volume) < 0.02 * volume, "volume %g", c.volume);
    EXPECT(s.samples == n && s.poles.inner + s.poles.outer == s.poles.poles);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void torus_has_genus_one_and_its_volume(void) {
    static double p[3 * 6000];
    torus_points(1, 6000, p);
    expect_genus(p, 6000, 1, 2 * 9.869604401089358 * 0.16);
}

static void sphere_has_genus_zero_though_its_inner_poles_coincide(void) {
    static double p[3 * 2000];
    sphere_points(1, 2000, p);
    expect_genus(p, 2000, 0, 4.18879);
}

/* All corners of a shared tetrahedron: same vertices as a set, same faces as a multiset of positions. */
static void shuffled_samples_give_the_same_mesh(void) {
    static double p[3 * 3000], q[3 * 3000];
    static size_t to[3000];
    torus_points(2, 3000, p);
    shuffle_points(5, 3000, p, q, to);
    brio_context *ctx = new_context();
    brio_mesh *a, *b;
    EXPECT(make_crust(ctx, p, 3000, NULL, &a, NULL, NULL) == BRIO_OK);
    EXPECT(make_crust(ctx, q, 3000, NULL, &b, NULL, NULL) == BRIO_OK);
    EXPECT(a->num_vertices == b->num_vertices && a->num_faces == b->num_faces);
    EXPECT(!memcmp(a->vertices, b->vertices, 24 * a->num_vertices));
    EXPECT(!memcmp(a->face_offsets, b->face_offsets, 8 * (a->num_faces + 1)));
    EXPECT(!memcmp(a->face_vertices, b->face_vertices, 4 * a->face_offsets[a->num_faces]));
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void duplicates_change_nothing(void) {
    static double p[3 * 4000];
    torus_points(2, 2000, p);
    memcpy(p + 6000, p, 6000 * sizeof *p);
    brio_context *ctx = new_context();
    brio_mesh *a, *b;
    EXPECT(make_crust(ctx, p, 2000, NULL, &a, NULL, NULL) == BRIO_OK);
    EXPECT(make_crust(ctx, p, 4000, NULL, &b, NULL, NULL) == BRIO_OK);
    EXPECT(a->num_vertices == b->num_vertices && !memcmp(a->vertices, b->vertices, 24 * a->num_vertices));
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void scale_of_the_input_is_the_scale_of_the_output(void) {
    static double p[3 * 1500], q[3 * 1500];
    torus_points(2, 1500, p);
    for (int i = 0; i < 4500; i++) q[i] = p[i] * 0x1p400;
    brio_context *ctx = new_context();
    brio_mesh *a, *b;
    EXPECT(make_crust(ctx, p, 1500, NULL, &a, NULL, NULL) == BRIO_OK);
    EXPECT(make_crust(ctx, q, 1500, NULL, &b, NULL, NULL) == BRIO_OK);
    bool same = a->num_vertices == b->num_vertices;
    for (size_t i = 0; same && i < 3 * a->num_vertices; i++) same = a->vertices[i] * 0x1p400 == b->vertices[i];
    EXPECT(same);
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void inputs_without_an_inside_say_so(void) {
    const double three[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, flat[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, .5, .5, 0};
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    EXPECT(make_crust(ctx, NULL, 0, NULL, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_crust(ctx, three, 3, NULL, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_crust(ctx, flat, 5, NULL, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    const double bad[9] = {0, 0, 0, 1, NAN, 0, 0, 1, INFINITY};
    EXPECT(make_crust(ctx, bad, 3, NULL, &mesh, NULL, NULL) == BRIO_ERR_NOT_FINITE && !mesh);
    EXPECT(!strcmp(brio_message(ctx), "point 1: y is NaN (2 such points in all)"), "%s", brio_message(ctx));
    const double once[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    brio_surface_stats s = {0};
    EXPECT(make_crust(ctx, once, 3, NULL, &mesh, NULL, &s) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(s.samples == 1 && !strcmp(brio_message(ctx), "1 distinct points span no solid"), "%s", brio_message(ctx));
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static brio_status small_crust(brio_context *ctx) {
    double p[3 * 60];
    brio_mesh *mesh;
    sphere_points(3, 60, p);
    brio_status status = make_crust(ctx, p, 60, NULL, &mesh, NULL, NULL);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_crust);
}

SUITE(test_power_crust) {
    RUN(small_inputs_are_closed_manifold_oriented);
    RUN(torus_has_genus_one_and_its_volume);
    RUN(sphere_has_genus_zero_though_its_inner_poles_coincide);
    RUN(shuffled_samples_give_the_same_mesh);
    RUN(duplicates_change_nothing);
    RUN(scale_of_the_input_is_the_scale_of_the_output);
    RUN(inputs_without_an_inside_say_so);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
