/* Offset surfaces against exact ones, at three densities of the samples, and closed whatever the points and the
 * distance. BRIO_TEST_VERBOSE=1 prints the errors. */
#include "failing_allocator.h"
#include "harness.h"
#include "medial_shapes.h"
#include "points.h"
#include "surface_calls.h"

static void expect_closed(brio_context *ctx, const brio_mesh *mesh, const char *what) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.boundary_edges == 0 && c.flipped_edges == 0, "%s", what);
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) EXPECT(isfinite(mesh->vertices[i]));
    brio_certificate_free(&c);
}

static void expect_no_crossings(brio_context *ctx, const brio_mesh *mesh, const char *what) {
    int64_t pairs = -1;
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK);
    EXPECT(pairs == 0, "%s: %lld pairs of faces cross", what, (long long)pairs);
}

/* The largest distance of a vertex from the exact offset. */
static double error_of(const medial_shape *shape, double h, double distance) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(shape, h, 1);
    brio_mesh *mesh;
    double most = 0;
    EXPECT(make_offset(ctx, c.points, c.count, distance, NULL, &mesh, NULL) == BRIO_OK, "%s by %g: %s", shape->name,
           distance, brio_message(ctx));
    expect_closed(ctx, mesh, shape->name);
    expect_no_crossings(ctx, mesh, shape->name);
    for (size_t v = 0; v < mesh->num_vertices; v++)
        most = fmax(most, fabs(shape->signed_distance(mesh->vertices + 3 * v) - distance));
    if (getenv("BRIO_TEST_VERBOSE"))
        fprintf(stderr, "%s h %g by %g: %zu samples, error %g\n", shape->name, h, distance, c.count, most);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
    free(c.points);
    return most;
}

/* The faces are tangent to the balls: their corners are off by the square of the spacing. */
static void expect_convergence(const medial_shape *shape, double distance, double most_over_square) {
    for (int i = 0; i < 3; i++) {
        double h = 0.3 / (1 + 0.5 * i), error = error_of(shape, h, distance);
        EXPECT(error < most_over_square * h * h, "%s by %g: %g at h = %g", shape->name, distance, error, h);
    }
}

static void offsets_of_sphere_are_as_far_off_as_the_square_of_the_spacing(void) {
    expect_convergence(&medial_sphere, 0.5, 1.6);
    expect_convergence(&medial_sphere, -0.5, 0.45); /* 0.41 with another rounding of sines */
}

static void offsets_of_torus_are_as_far_off_as_the_square_of_the_spacing(void) {
    expect_convergence(&medial_torus, 0.2, 2.8);
    expect_convergence(&medial_torus, -0.2, 1);
}

/* --- what the distance does to the solid --- */

static void expect_genus(const double *p, size_t n, double distance, size_t components, int64_t genus) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    brio_certificate c = {0};
    EXPECT(make_offset(ctx, p, n, distance, NULL, &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.components == components && c.genus == genus,
           "by %g: %zu components, genus %lld", distance, c.components, (long long)c.genus);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* The hole of the torus has radius 0.6. */
static void hole_of_torus_closes_when_the_offset_fills_it(void) {
    cloud c = medial_sample(&medial_torus, 0.1, 2);
    expect_genus(c.points, c.count, 0.5, 1, 1);
    expect_genus(c.points, c.count, 0.7, 1, 0);
    free(c.points);
}

static void two_spheres_become_one(void) {
    cloud c = medial_sample(&medial_sphere, 0.25, 3);
    size_t n = c.count;
    for (size_t i = 0; i < n; i++) {
        double x = c.points[3 * i] + 3;
        cloud_add(&c, x, c.points[3 * i + 1], c.points[3 * i + 2]);
    }
    expect_genus(c.points, c.count, 0.3, 2, 0);
    expect_genus(c.points, c.count, 0.8, 1, 0);
    free(c.points);
}

static void offset_that_swallows_everything_says_so(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_torus, 0.2, 4);
    brio_mesh *mesh;
    EXPECT(make_offset(ctx, c.points, c.count, -0.45, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(strstr(brio_message(ctx), "swallows the whole object"), "%s", brio_message(ctx));
    EXPECT(make_offset(ctx, c.points, c.count, -1e300, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    free(c.points);
}

static void offset_by_nothing_is_the_power_crust(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_torus, 0.2, 5);
    brio_mesh *offset, *crust;
    brio_distance d = {0};
    EXPECT(make_offset(ctx, c.points, c.count, 0, NULL, &offset, NULL) == BRIO_OK);
    EXPECT(make_crust(ctx, c.points, c.count, NULL, &crust, NULL, NULL) == BRIO_OK);
    EXPECT(brio_mesh_distance(ctx, offset, crust, 2000, 1, &d) == BRIO_OK && d.hausdorff < 1e-9, "%g", d.hausdorff);
    expect_no_crossings(ctx, offset, "torus by 0");
    brio_mesh_free(offset);
    brio_mesh_free(crust);
    brio_context_free(ctx);
    free(c.points);
}

static void expect_components(brio_context *ctx, const brio_mesh *mesh, size_t components, double volume) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.components == components && fabs(c.volume - volume) < 0.05 * volume, "%zu components, %g",
           c.components, c.volume);
    brio_certificate_free(&c);
}

/* Samples of a hollow ball bound a shell; where the outer sphere is the solid, there is no hollow. */
static void known_solid_decides_the_labels(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_sphere, 0.15, 7);
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *solid, *mesh;
    size_t n = c.count;
    EXPECT(make_crust(ctx, c.points, n, NULL, &solid, NULL, NULL) == BRIO_OK);
    for (size_t i = 0; i < n; i++)
        cloud_add(&c, 0.5 * c.points[3 * i], 0.5 * c.points[3 * i + 1], 0.5 * c.points[3 * i + 2]);
    for (int known = 0; known < 2; known++) {
        double ball = 4.18879;
        o.poles.solid = known ? solid : NULL;
        EXPECT(make_crust(ctx, c.points, c.count, &o, &mesh, NULL, NULL) == BRIO_OK, "%s", brio_message(ctx));
        expect_components(ctx, mesh, known ? 1 : 2, known ? ball : ball * (1 - 0.125));
        brio_mesh_free(mesh);
        brio_surface_options moved = OFFSET_OPTIONS;
        moved.poles = o.poles;
        EXPECT(make_offset(ctx, c.points, c.count, 0.1, &moved, &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
        expect_components(ctx, mesh, known ? 1 : 2, ball * (1.331 - (known ? 0 : 0.064)));
        brio_mesh_free(mesh);
    }
    brio_mesh_free(solid);
    brio_context_free(ctx);
    free(c.points);
}

/* --- any input, any distance --- */

static void small_inputs_are_closed_at_any_distance(void) {
    double p[3 * 40];
    int surfaces = 0;
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    for (uint64_t trial = 0; trial < 1500; trial += BRIEF_TESTS ? 7 : 1) {
        size_t n = 4 + trial % 37;
        brio_rng rng = brio_rng_new(trial);
        brio_mesh *mesh;
        if (trial % 3 == 0)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 3 + (uint32_t)(trial % 3), p);
        double distance = (trial % 2 ? 1 : -1) * pow(10, 3 - 6 * brio_rng_double(&rng));
        brio_status status = make_offset(ctx, p, n, distance, NULL, &mesh, NULL);
        EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_ANSWER && !mesh), "trial %d: %s", (int)trial,
               brio_message(ctx));
        if (status != BRIO_OK) continue;
        expect_closed(ctx, mesh, "small input");
        surfaces++;
        brio_mesh_free(mesh);
    }
    EXPECT(surfaces > (BRIEF_TESTS ? 70 : 500), "%d", surfaces);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void distances_of_any_size_are_answered(void) {
    static const double distances[] = {1e-320, -1e-320, 1e-30, 1e10, 1e17, -1e17, 1e100, 1e200, 1e308};
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_sphere, 0.4, 6);
    for (int i = 0; i < 9; i++) {
        brio_mesh *mesh;
        brio_status status = make_offset(ctx, c.points, c.count, distances[i], NULL, &mesh, NULL);
        if (distances[i] > 1e20)
            EXPECT(status == BRIO_ERR_ARGUMENT && !mesh, "by %g: %s", distances[i], brio_message(ctx));
        else
            EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_ANSWER, "by %g: %s", distances[i], brio_message(ctx));
        if (mesh) expect_closed(ctx, mesh, "any distance");
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
    free(c.points);
}

static void shuffled_samples_give_the_same_offset(void) {
    static double p[3 * 1000], q[3 * 1000];
    static size_t to[1000];
    brio_context *ctx = new_context();
    brio_mesh *a, *b;
    torus_points(2, 1000, p);
    shuffle_points(5, 1000, p, q, to);
    brio_context_set_threads(ctx, 1);
    EXPECT(make_offset(ctx, p, 1000, 0.1, NULL, &a, NULL) == BRIO_OK);
    brio_context_set_threads(ctx, 4);
    EXPECT(make_offset(ctx, q, 1000, 0.1, NULL, &b, NULL) == BRIO_OK);
    EXPECT(a->num_vertices == b->num_vertices && a->num_faces == b->num_faces);
    EXPECT(!memcmp(a->vertices, b->vertices, 24 * a->num_vertices));
    EXPECT(!memcmp(a->face_vertices, b->face_vertices, 4 * a->face_offsets[a->num_faces]));
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void scale_of_points_and_distance_is_the_scale_of_the_offset(void) {
    static double p[3 * 500], q[3 * 500];
    brio_context *ctx = new_context();
    brio_mesh *a, *b;
    torus_points(3, 500, p);
    for (int i = 0; i < 1500; i++) q[i] = p[i] * 0x1p300;
    EXPECT(make_offset(ctx, p, 500, 0.3, NULL, &a, NULL) == BRIO_OK);
    EXPECT(make_offset(ctx, q, 500, 0.3 * 0x1p300, NULL, &b, NULL) == BRIO_OK);
    bool same = a->num_vertices == b->num_vertices;
    for (size_t i = 0; same && i < 3 * a->num_vertices; i++) same = a->vertices[i] * 0x1p300 == b->vertices[i];
    EXPECT(same);
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void duplicates_change_nothing(void) {
    static double p[3 * 1000];
    brio_context *ctx = new_context();
    brio_mesh *a, *b;
    torus_points(3, 500, p);
    memcpy(p + 1500, p, 1500 * sizeof *p);
    EXPECT(make_offset(ctx, p, 500, 0.1, NULL, &a, NULL) == BRIO_OK);
    EXPECT(make_offset(ctx, p, 1000, 0.1, NULL, &b, NULL) == BRIO_OK);
    EXPECT(a->num_vertices == b->num_vertices && !memcmp(a->vertices, b->vertices, 24 * a->num_vertices));
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void wrong_options_are_refused(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    double p[3 * 60];
    brio_surface_options dense = OFFSET_OPTIONS, later = dense, unset = {.size = 4, .method = BRIO_SURFACE_OFFSET};
    sphere_points(3, 60, p);
    later.poles.reserved[1] = 1;
    dense.poles.sampling_density = 1;
    EXPECT(make_offset(ctx, p, 60, NAN, NULL, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(make_offset(ctx, p, 60, INFINITY, NULL, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(make_offset(ctx, p, 60, 1, &later, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(make_offset(ctx, p, 60, 1, &unset, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(make_offset(ctx, p, 60, 1, &dense, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(make_offset(ctx, NULL, 0, 1, NULL, &mesh, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    brio_context_free(ctx);
}

static brio_status small_offset(brio_context *ctx) {
    double p[3 * 60];
    brio_mesh *mesh;
    brio_surface_options o = OFFSET_OPTIONS;
    o.simplify = 1;
    sphere_points(3, 60, p);
    brio_status status = make_offset(ctx, p, 60, 0.2, &o, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_offset);
}

SUITE(test_offset) {
    RUN(offsets_of_sphere_are_as_far_off_as_the_square_of_the_spacing);
    RUN(offsets_of_torus_are_as_far_off_as_the_square_of_the_spacing);
    RUN(hole_of_torus_closes_when_the_offset_fills_it);
    RUN(two_spheres_become_one);
    RUN(offset_that_swallows_everything_says_so);
    RUN(offset_by_nothing_is_the_power_crust);
    RUN(known_solid_decides_the_labels);
    RUN(small_inputs_are_closed_at_any_distance);
    RUN(distances_of_any_size_are_answered);
    RUN(shuffled_samples_give_the_same_offset);
    RUN(scale_of_points_and_distance_is_the_scale_of_the_offset);
    RUN(duplicates_change_nothing);
    RUN(wrong_options_are_refused);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
