/* What a context knows of a failure: the reason, the points that the sentence names, the bytes that were not to be had. Each
 * reason is evoked. */
#include "harness.h"
#include "points.h"
#include <stdio.h>

static brio_context *ctx;

static brio_failure last(void) {
    brio_failure f = {.size = sizeof f};
    EXPECT(brio_last_failure(ctx, &f) == BRIO_OK);
    return f;
}

static void expect_reason(brio_status status, brio_status expected, brio_reason reason) {
    brio_failure f = last();
    EXPECT(status == expected && f.status == status && f.reason == reason, "%d, %s: %s", (int)status,
           brio_reason_name(f.reason), brio_message(ctx));
}

static brio_mesh *mesh_of(const double *points, size_t n, const uint32_t *corners, size_t faces, size_t sides) {
    brio_mesh *mesh = NULL;
    uint64_t offsets[8];
    for (size_t f = 0; f <= faces; f++) offsets[f] = sides * f;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, points, n) == BRIO_OK &&
           brio_mesh_set_faces(mesh, offsets, corners, faces) == BRIO_OK);
    return mesh;
}

static const double CORNERS[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const uint32_t SIDES[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};

static void points_of_a_plane_bound_nothing(void) {
    double p[3 * 100];
    brio_mesh *mesh;
    uniform_points(1, 100, p);
    for (size_t i = 0; i < 100; i++) p[3 * i + 2] = 0;
    const brio_surface_options o = {.method = BRIO_SURFACE_POWER_CRUST};
    expect_reason(brio_surface(ctx, p, 100, &o, &mesh, NULL), BRIO_ERR_NO_ANSWER, BRIO_REASON_NO_INSIDE);
}

static void faces_of_a_surface_may_all_span_holes(void) {
    double p[3 * 200];
    brio_mesh *mesh;
    sphere_points(1, 200, p);
    const brio_surface_options o = {.open = 1e-3};
    expect_reason(brio_surface(ctx, p, 200, &o, &mesh, NULL), BRIO_ERR_NO_ANSWER, BRIO_REASON_ALL_HOLES);
}

static void offsets_swallow_and_open_meshes_have_no_inside(void) {
    brio_mesh *closed = mesh_of(CORNERS, 4, SIDES, 4, 3), *open = mesh_of(CORNERS, 4, SIDES, 3, 3), *out;
    expect_reason(brio_mesh_offset(ctx, closed, -5, NULL, &out, NULL), BRIO_ERR_NO_ANSWER, BRIO_REASON_SWALLOWED);
    expect_reason(brio_mesh_offset(ctx, open, 0.1, NULL, &out, NULL), BRIO_ERR_NO_ANSWER, BRIO_REASON_OPEN_MESH);
    double p[3 * 200];
    sphere_points(1, 200, p);
    const brio_surface_options o = {.method = BRIO_SURFACE_OFFSET, .distance = -9};
    expect_reason(brio_surface(ctx, p, 200, &o, &out, NULL), BRIO_ERR_NO_ANSWER, BRIO_REASON_SWALLOWED);
    brio_restricted_stats s = {0};
    expect_reason(brio_restricted_delaunay(ctx, CORNERS, 4, open, &out, &s), BRIO_ERR_ARGUMENT, BRIO_REASON_NOT_CLOSED);
    EXPECT(brio_mesh_keep_components(closed, 0, 100, NULL, NULL) == BRIO_ERR_NO_ANSWER);
    expect_reason(BRIO_ERR_NO_ANSWER, BRIO_ERR_NO_ANSWER, BRIO_REASON_NO_COMPONENT);
    brio_mesh_free(closed);
    brio_mesh_free(open);
}

static void squares_are_no_triangles(void) {
    static const double square[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    static const uint32_t corners[4] = {0, 1, 2, 3};
    brio_mesh *mesh = mesh_of(square, 4, corners, 1, 4), *out;
    expect_reason(brio_mesh_subdivide(ctx, mesh, 1, &out), BRIO_ERR_NO_ANSWER, BRIO_REASON_NOT_TRIANGLES);
    brio_mesh_free(mesh);
}

static void values_and_distances_may_be_out_of_reach(void) {
    brio_alpha_complex c = {.size = sizeof c};
    brio_triangulation *t;
    brio_mesh *mesh;
    EXPECT(brio_delaunay(ctx, CORNERS, NULL, 4, NULL, &t) == BRIO_OK);
    EXPECT(brio_alpha_values(ctx, t, CORNERS, NULL, 4, &c) == BRIO_OK);
    expect_reason(brio_alpha_shape(ctx, CORNERS, &c, 1e-3, &mesh, NULL), BRIO_ERR_NO_ANSWER, BRIO_REASON_NO_VALUE);
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
    double large[12];
    for (int i = 0; i < 12; i++) large[i] = CORNERS[i] > 0 ? 1.7e308 : -1.7e308;
    brio_mesh *closed = mesh_of(large, 4, SIDES, 4, 3), *other = mesh_of(CORNERS, 4, SIDES, 4, 3);
    brio_distance d = {0};
    expect_reason(brio_mesh_distance(ctx, closed, other, 100, 0, &d), BRIO_ERR_NO_ANSWER, BRIO_REASON_SCALE);
    brio_mesh_free(closed);
    brio_mesh_free(other);
}

static void curves_are_of_points_in_a_plane(void) {
    double p[3 * 100];
    brio_mesh *mesh;
    uniform_points(1, 100, p);
    expect_reason(brio_curve(ctx, p, 100, NULL, &mesh, NULL), BRIO_ERR_NO_ANSWER, BRIO_REASON_NOT_FLAT);
}

static void formats_may_be_unknown(void) {
    brio_mesh *mesh;
    static const char bytes[] = "\x01\x02\x03nothing that brio knows\x00\xff";
    expect_reason(brio_read_memory(ctx, bytes, sizeof bytes, "a.unknown", NULL, &mesh), BRIO_ERR_FORMAT,
                  BRIO_REASON_UNKNOWN_FORMAT);
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    expect_reason(brio_write(ctx, "/tmp/a.unknown", mesh, NULL), BRIO_ERR_ARGUMENT, BRIO_REASON_UNKNOWN_FORMAT);
    brio_mesh_free(mesh);
}

/* A failure without a reason forgets that of the one before. */
static void points_and_bytes_are_named(void) {
    double p[15] = {0};
    brio_triangulation *t;
    p[3 * 3 + 1] = NAN;
    EXPECT(brio_delaunay(ctx, p, NULL, 5, NULL, &t) == BRIO_ERR_NOT_FINITE);
    brio_failure f = last();
    EXPECT(f.status == BRIO_ERR_NOT_FINITE && f.reason == BRIO_REASON_NONE && f.num_points == 1 && f.points[0] == 3);
    static double many[3 * 5000];
    uniform_points(1, 5000, many);
    brio_context_set_memory_limit(ctx, brio_context_memory(ctx) + 100000);
    EXPECT(brio_delaunay(ctx, many, NULL, 5000, NULL, &t) == BRIO_ERR_NO_MEMORY);
    brio_context_set_memory_limit(ctx, 0);
    f = last();
    EXPECT(f.status == BRIO_ERR_NO_MEMORY && f.bytes > 0 && f.num_points == 0);
    EXPECT(brio_delaunay(ctx, many, NULL, 5000, NULL, &t) == BRIO_OK);
    EXPECT(last().bytes == f.bytes); /* what succeeds leaves it */
    many[0] = 0.5;
    EXPECT(brio_triangulation_check(ctx, t, many, NULL, 5000) == BRIO_ERR_CHECK);
    EXPECT(last().bytes == 0 && last().status == BRIO_ERR_CHECK, "%s", brio_message(ctx));
    brio_triangulation_free(t);
}

static void reasons_have_names_of_their_own(void) {
    for (int r = 0; r < BRIO_REASON_END; r++)
        for (int s = 0; s <= r; s++)
            EXPECT(!strcmp(brio_reason_name((brio_reason)r), brio_reason_name((brio_reason)s)) == (r == s));
    EXPECT(!*brio_reason_name(BRIO_REASON_NONE) && !*brio_reason_name(BRIO_REASON_END) &&
           !*brio_reason_name((brio_reason)-1));
}

SUITE(test_failures) {
    ctx = new_context();
    brio_failure f = last();
    EXPECT(f.status == BRIO_OK && f.reason == BRIO_REASON_NONE && f.num_points == 0);
    RUN(points_of_a_plane_bound_nothing);
    RUN(faces_of_a_surface_may_all_span_holes);
    RUN(offsets_swallow_and_open_meshes_have_no_inside);
    RUN(squares_are_no_triangles);
    RUN(values_and_distances_may_be_out_of_reach);
    RUN(curves_are_of_points_in_a_plane);
    RUN(formats_may_be_unknown);
    RUN(points_and_bytes_are_named);
    RUN(reasons_have_names_of_their_own);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
