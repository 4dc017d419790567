/* Nearest points against brute force, and distances between surfaces that are known. */
#include "brio/testdata.h"
#include "base/rng.h"
#include "failing_allocator.h"
#include "mesh/closest_point.h"
#include <math.h>
#include <string.h>

static brio_context *ctx;

/* Any number of triangles or quadrilaterals. */
static brio_mesh *mesh_new(brio_context *context, const double *vertices, size_t num_vertices, const uint32_t *corners,
                           size_t num_faces, size_t corners_of_face) {
    uint64_t offsets[1024];
    brio_mesh *mesh = NULL;
    for (size_t f = 0; f <= num_faces; f++) offsets[f] = f * corners_of_face;
    if (brio_mesh_new(context, &mesh) != BRIO_OK) return NULL;
    if (brio_mesh_set_vertices(mesh, vertices, num_vertices) == BRIO_OK &&
        brio_mesh_set_faces(mesh, offsets, corners, num_faces) == BRIO_OK)
        return mesh;
    brio_mesh_free(mesh);
    return NULL;
}

/* A square of the given side at height z, as one face. */
static brio_mesh *square(brio_context *context, double side, double z) {
    const double vertices[] = {0, 0, z, side, 0, z, side, side, z, 0, side, z};
    const uint32_t corners[] = {0, 1, 2, 3};
    return mesh_new(context, vertices, 4, corners, 1, 4);
}

/* --- nearest points --- */

/* Distance from p to a triangle by searching its parameters ever more finely: slow, and of no shared idea. */
static double distance_by_search(const double *a, const double *b, const double *c, const double *p) {
    double s0 = 0.5, t0 = 0.5, width = 0.5, best = INFINITY;
    for (int round = 0; round < 40; round++, width *= 0.6) {
        double s_best = s0, t_best = t0;
        for (int i = -4; i <= 4; i++)
            for (int j = -4; j <= 4; j++) {
                double s = fmin(fmax(s0 + i * width / 4, 0), 1), t = fmin(fmax(t0 + j * width / 4, 0), 1), sum = 0;
                /* (s, t) of the unit square onto the triangle */
                for (int k = 0; k < 3; k++) {
                    double q = (1 - s) * a[k] + s * ((1 - t) * b[k] + t * c[k]) - p[k];
                    sum += q * q;
                }
                if (sum >= best) continue;
                best = sum;
                s_best = s;
                t_best = t;
            }
        s0 = s_best;
        t0 = t_best;
    }
    return sqrt(best);
}

static double norm(const double *a, const double *b) {
    return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* Nearest distance over all triangles one by one, each in a tree of its own. */
static double nearest_of_all(const brio_mesh *mesh, const double *p) {
    double best = INFINITY;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *c = mesh->face_vertices + 3 * f;
        uint32_t triangle[1][3] = {{c[0], c[1], c[2]}};
        brio_triangle_tree one = {mesh->vertices, triangle, 1, NULL};
        double q[3];
        size_t t;
        best = fmin(best, sqrt(brio_closest_point(&one, p, q, &t)));
    }
    return best;
}

/* Random triangles; every fourth is a segment or a point. */
static brio_mesh *random_triangles(uint64_t seed, uint32_t num_vertices, size_t num_faces) {
    double vertices[300];
    uint32_t corners[1200];
    brio_rng rng = brio_rng_new(seed);
    for (uint32_t i = 0; i < 3 * num_vertices; i++) vertices[i] = brio_rng_double(&rng);
    for (size_t i = 0; i < 3 * num_faces; i++) corners[i] = brio_rng_below(&rng, num_vertices);
    for (size_t f = 0; f < num_faces; f += 4) corners[3 * f + 2] = corners[3 * f];
    return mesh_new(ctx, vertices, num_vertices, corners, num_faces, 3);
}

static void nearest_point_of_a_triangle_is_right(void) {
    brio_rng rng = brio_rng_new(9);
    for (int round = 0; round < 60; round++) {
        double x[12], q[3];
        for (int i = 0; i < 12; i++) x[i] = brio_rng_double(&rng);
        uint32_t triangle[1][3] = {{0, 1, 2}};
        brio_triangle_tree tree = {x, triangle, 1, NULL};
        size_t t;
        double found = sqrt(brio_closest_point(&tree, x + 9, q, &t));
        double expected = distance_by_search(x, x + 3, x + 6, x + 9);
        EXPECT(fabs(found - expected) < 1e-6, "%g, not %g", found, expected);
        EXPECT(fabs(found - norm(q, x + 9)) < 1e-15);
    }
}

static void tree_finds_what_trying_all_finds(void) {
    static const size_t sizes[] = {1, 8, 9, 16, 17, 100, 400};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        brio_mesh *mesh = random_triangles(s, 60, sizes[s]);
        brio_triangle_tree tree;
        EXPECT(brio_triangle_tree_new(ctx, mesh, &tree) == BRIO_OK && tree.num_triangles == sizes[s]);
        brio_rng rng = brio_rng_new(100 + s);
        for (int i = 0; i < 200; i++) {
            double p[3], q[3];
            size_t t;
            for (int k = 0; k < 3; k++) p[k] = 3 * brio_rng_double(&rng) - 1;
            double found = sqrt(brio_closest_point(&tree, p, q, &t)), expected = nearest_of_all(mesh, p);
            EXPECT(found == expected && t < sizes[s], "%zu triangles: %g, not %g", sizes[s], found, expected);
        }
        brio_triangle_tree_free(ctx, &tree);
        brio_mesh_free(mesh);
    }
}

static void equal_centroids_make_a_tree(void) {
    const double vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t corners[3000];
    for (size_t i = 0; i < 3000; i++) corners[i] = i % 3;
    brio_mesh *mesh = mesh_new(ctx, vertices, 3, corners, 1000, 3);
    brio_triangle_tree tree;
    EXPECT(brio_triangle_tree_new(ctx, mesh, &tree) == BRIO_OK);
    double p[3] = {0.25, 0.25, 2}, q[3];
    size_t t;
    EXPECT(brio_closest_point(&tree, p, q, &t) == 4 && q[0] == 0.25 && q[2] == 0);
    brio_triangle_tree_free(ctx, &tree);
    brio_mesh_free(mesh);
}

/* --- distances --- */

static brio_distance distance(brio_mesh *a, brio_mesh *b, size_t samples) {
    brio_distance d = {0};
    EXPECT(brio_mesh_distance(ctx, a, b, samples, 1, &d) == BRIO_OK, "%s", brio_message(ctx));
    brio_mesh_free(a);
    brio_mesh_free(b);
    return d;
}

/* The boxes of a node and of all below it. */
static bool boxes_are_same(const brio_triangle_tree *a, const brio_triangle_tree *b, size_t node, size_t count) {
    if (memcmp(&a->boxes[node], &b->boxes[node], sizeof *a->boxes)) return false;
    if (count <= BRIO_LEAF_TRIANGLES) return true;
    return boxes_are_same(a, b, 2 * node + 1, count / 2) && boxes_are_same(a, b, 2 * node + 2, count - count / 2);
}

/* With five threads, the mesh has enough triangles that threads share the levels below the root. */
static void tree_does_not_depend_on_threads(void) {
    static const int threads[] = {2, 3, 5};
    brio_triangle_tree one;
    brio_mesh *mesh;
    EXPECT(brio_generate_truth(ctx, 80, &mesh) == BRIO_OK && mesh->num_faces > 5 << 12, "%zu", mesh->num_faces);
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_triangle_tree_new(ctx, mesh, &one) == BRIO_OK);
    for (size_t i = 0; i < sizeof threads / sizeof *threads; i++) {
        brio_triangle_tree tree;
        brio_context_set_threads(ctx, threads[i]);
        EXPECT(brio_triangle_tree_new(ctx, mesh, &tree) == BRIO_OK && tree.num_triangles == one.num_triangles);
        EXPECT(!memcmp(tree.triangles, one.triangles, one.num_triangles * sizeof *one.triangles), "%d", threads[i]);
        EXPECT(boxes_are_same(&tree, &one, 0, one.num_triangles), "%d", threads[i]);
        brio_triangle_tree_free(ctx, &tree);
    }
    brio_context_set_threads(ctx, 0);
    brio_triangle_tree_free(ctx, &one);
    brio_mesh_free(mesh);
}

static void surface_has_no_distance_to_itself(void) {
    brio_distance d = distance(square(ctx, 1, 0), square(ctx, 1, 0), 1000);
    EXPECT(d.mean < 1e-15 && d.rms < 1e-15 && d.p95 < 1e-15 && d.hausdorff < 1e-14, "%g", d.hausdorff);
    EXPECT(fabs(d.normal_consistency - 1) < 1e-7);
    EXPECT(fabs(d.diagonal - sqrt(2)) < 1e-15);
}

static void parallel_squares_have_one_distance(void) {
    brio_distance d = distance(square(ctx, 1, 0), square(ctx, 1, 0.25), 0);
    EXPECT(fabs(d.mean - 0.25) < 1e-12 && fabs(d.rms - 0.25) < 1e-12, "%.17g", d.mean);
    EXPECT(fabs(d.p95 - 0.25) < 1e-14 && fabs(d.hausdorff - 0.25) < 1e-14, "%.17g", d.hausdorff);
    EXPECT(d.normal_consistency == 1);
}

/* A square of side 2 and its quarter of side 1. From the quarter the distance is 0; from the square it is 0 on a
 * quarter, uniform in [0, 1] on two, and that to the corner of a unit square on one, of mean 0.7652 and mean square
 * 2/3. */
static void larger_square_counts_both_ways(void) {
    brio_distance d = distance(square(ctx, 2, 0), square(ctx, 1, 0), 200000);
    EXPECT(fabs(d.mean - 0.5 * (0.5 * 0.5 + 0.25 * 0.76520)) < 0.002, "%g", d.mean);
    EXPECT(fabs(d.rms - sqrt(0.5 * (0.5 / 3 + 0.25 * 2 / 3))) < 0.002, "%g", d.rms);
    EXPECT(d.hausdorff > 1.39 && d.hausdorff <= sqrt(2), "%g", d.hausdorff);
    EXPECT(d.p95 > 0.9 && d.p95 < 1, "%g", d.p95);
}

static void perpendicular_squares_have_no_common_normal(void) {
    const double vertices[] = {0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1};
    const uint32_t corners[] = {0, 1, 2, 3};
    brio_distance d = distance(square(ctx, 1, 0), mesh_new(ctx, vertices, 4, corners, 1, 4), 2000);
    EXPECT(d.normal_consistency < 1e-12 && fabs(d.mean - 0.5) < 0.03, "%g %g", d.normal_consistency, d.mean);
}

static void figures_do_not_depend_on_threads(void) {
    brio_mesh *a, *b;
    brio_distance d[2] = {{.size = sizeof *d}, {.size = sizeof *d}};
    EXPECT(brio_generate_truth(ctx, 20, &a) == BRIO_OK && brio_generate_truth(ctx, 30, &b) == BRIO_OK);
    for (int i = 0; i < 2; i++) {
        brio_context_set_threads(ctx, i ? 1 : 3);
        EXPECT(brio_mesh_distance(ctx, a, b, 5000, 3, &d[i]) == BRIO_OK);
    }
    brio_context_set_threads(ctx, 0);
    EXPECT(!memcmp(&d[0], &d[1], sizeof d[0]));
    EXPECT(d[0].mean > 0 && d[0].mean < 0.02 * d[0].diagonal && d[0].normal_consistency > 0.9);
    brio_mesh_free(a);
    brio_mesh_free(b);
}

static void surface_without_area_is_refused(void) {
    const double vertices[] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    const uint32_t corners[] = {0, 1, 2};
    brio_mesh *line = mesh_new(ctx, vertices, 3, corners, 1, 3), *plane = square(ctx, 1, 0), *empty;
    brio_distance d = {0};
    brio_mesh_new(ctx, &empty);
    EXPECT(brio_mesh_distance(ctx, line, plane, 10, 1, &d) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(ctx), "first") != NULL, "%s", brio_message(ctx));
    EXPECT(brio_mesh_distance(ctx, plane, line, 10, 1, &d) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_distance(ctx, plane, empty, 10, 1, &d) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_distance(ctx, plane, plane, SIZE_MAX, 1, &d) == BRIO_ERR_NO_MEMORY);
    plane->face_vertices[2] = 9;
    EXPECT(brio_mesh_distance(ctx, plane, plane, 10, 1, &d) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(line);
    brio_mesh_free(plane);
    brio_mesh_free(empty);
}

/* The message was "the faces of the first mesh have area nan". */
static void surface_with_nan_is_refused(void) {
    brio_mesh *good = square(ctx, 1, 0), *bad = square(ctx, 1, 1);
    brio_distance d = {0};
    bad->vertices[4] = NAN;
    EXPECT(brio_mesh_distance(ctx, bad, good, 10, 1, &d) == BRIO_ERR_NOT_FINITE);
    EXPECT(strstr(brio_message(ctx), "vertex 1 of the first mesh: y is NaN"), "%s", brio_message(ctx));
    bad->vertices[4] = INFINITY;
    EXPECT(brio_mesh_distance(ctx, good, bad, 10, 1, &d) == BRIO_ERR_NOT_FINITE);
    EXPECT(strstr(brio_message(ctx), "vertex 1 of the second mesh: y is infinite"), "%s", brio_message(ctx));
    brio_mesh_free(good);
    brio_mesh_free(bad);
}

/* A face of two corners counted as no face. */
static void surface_without_triangles_says_so(void) {
    const double vertices[] = {0, 0, 0, 1, 0, 0};
    const uint32_t corners[] = {0, 1};
    brio_mesh *edge = mesh_new(ctx, vertices, 2, corners, 1, 2), *plane = square(ctx, 1, 0);
    brio_distance d = {0};
    EXPECT(brio_mesh_distance(ctx, edge, plane, 10, 1, &d) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(ctx), "no face of the mesh has three corners"), "%s", brio_message(ctx));
    brio_mesh_free(edge);
    brio_mesh_free(plane);
}

/* --- sizes near the ends of doubles --- */

static brio_mesh *scaled(const brio_mesh *mesh, int exponent) {
    brio_mesh *copy = mesh_new(ctx, mesh->vertices, mesh->num_vertices, mesh->face_vertices, mesh->num_faces, 3);
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) copy->vertices[i] = ldexp(mesh->vertices[i], exponent);
    return copy;
}

/* The mean was 6 % of the diagonal between a surface of size 1e-90 and itself, and no number from 1e77 on. */
static void figures_do_not_depend_on_the_unit(void) {
    brio_mesh *a = random_triangles(3, 60, 100), *b = random_triangles(4, 50, 80);
    brio_distance one = distance(scaled(a, 0), scaled(b, 0), 500);
    for (int exponent = -960; exponent <= 1020; exponent += 20) {
        brio_distance d = distance(scaled(a, exponent), scaled(b, exponent), 500);
        EXPECT(d.mean == ldexp(one.mean, exponent) && d.rms == ldexp(one.rms, exponent), "2^%d: %g", exponent, d.mean);
        EXPECT(d.p95 == ldexp(one.p95, exponent) && d.hausdorff == ldexp(one.hausdorff, exponent), "2^%d", exponent);
        EXPECT(d.normal_consistency == one.normal_consistency, "2^%d: %g", exponent, d.normal_consistency);
        EXPECT(d.diagonal == ldexp(one.diagonal, exponent), "2^%d: %g", exponent, d.diagonal);
        d = distance(scaled(a, exponent), scaled(a, exponent), 500);
        EXPECT(d.hausdorff < ldexp(1e-12, exponent) && d.normal_consistency > 0.99, "2^%d: %g", exponent,
               d.normal_consistency);
    }
    brio_mesh_free(a);
    brio_mesh_free(b);
}

/* "The faces have area 0" was said of both. */
static void tiny_surface_beside_an_ordinary_one_has_area(void) {
    brio_distance d = distance(square(ctx, 1e-200, 0.5), square(ctx, 1, 0), 100);
    EXPECT(d.normal_consistency == 1 && d.mean >= 0.5 && d.hausdorff < 1.5, "%g", d.mean);
    d = distance(square(ctx, 1e200, 0), square(ctx, 1, 0), 100);
    EXPECT(d.normal_consistency == 1 && d.hausdorff > 1e199, "%g", d.hausdorff);
}

static void distances_beyond_doubles_are_refused(void) {
    brio_mesh *low = square(ctx, 1.7e308, -1.7e308), *high = square(ctx, 1.7e308, 1.7e308);
    brio_distance d = {.size = sizeof d, .mean = 7};
    EXPECT(brio_mesh_distance(ctx, low, high, 10, 1, &d) == BRIO_ERR_NO_ANSWER && d.mean == 0);
    EXPECT(strstr(brio_message(ctx), "cannot hold") != NULL, "%s", brio_message(ctx));
    brio_mesh_free(low);
    brio_mesh_free(high);
}

/* --- memory and cancelling --- */

static brio_status compare_squares_of(brio_context *context, double side) {
    brio_mesh *a = square(context, side, 0), *b = square(context, side, side);
    brio_distance d = {0};
    brio_status status = a && b ? brio_mesh_distance(context, a, b, 50, 1, &d) : BRIO_ERR_NO_MEMORY;
    brio_mesh_free(a);
    brio_mesh_free(b);
    return status;
}

static brio_status compare_squares(brio_context *context) {
    return compare_squares_of(context, 1);
}

static brio_status compare_tiny_squares(brio_context *context) {
    return compare_squares_of(context, 1e-200);
}

static void no_memory_is_a_status(void) {
    expect_clean_failures(compare_squares);
    expect_clean_failures(compare_tiny_squares);
}

static int cancel(const char *stage, double fraction, void *user) {
    (void)user;
    return !strcmp(stage, "distance") && fraction >= 0.5;
}

static void cancelling_leaves_nothing(void) {
    brio_mesh *a = square(ctx, 1, 0);
    brio_distance d = {0};
    size_t before = brio_context_memory(ctx);
    brio_context_set_progress(ctx, cancel, NULL);
    EXPECT(brio_mesh_distance(ctx, a, a, 100, 1, &d) == BRIO_ERR_CANCELLED);
    EXPECT(brio_context_memory(ctx) == before);
    brio_context_set_progress(ctx, NULL, NULL);
    brio_mesh_free(a);
}

SUITE(test_distance) {
    brio_context_new(NULL, &ctx);
    RUN(nearest_point_of_a_triangle_is_right);
    RUN(tree_finds_what_trying_all_finds);
    RUN(equal_centroids_make_a_tree);
    RUN(tree_does_not_depend_on_threads);
    RUN(surface_has_no_distance_to_itself);
    RUN(parallel_squares_have_one_distance);
    RUN(larger_square_counts_both_ways);
    RUN(perpendicular_squares_have_no_common_normal);
    RUN(figures_do_not_depend_on_threads);
    RUN(surface_without_area_is_refused);
    RUN(surface_with_nan_is_refused);
    RUN(surface_without_triangles_says_so);
    RUN(figures_do_not_depend_on_the_unit);
    RUN(tiny_surface_beside_an_ordinary_one_has_area);
    RUN(distances_beyond_doubles_are_refused);
    RUN(no_memory_is_a_status);
    RUN(cancelling_leaves_nothing);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
