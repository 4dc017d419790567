/* Butterfly subdivision: topology, interpolation, precision, extraordinary vertices, boundaries, properties. */
#include "failing_allocator.h"
#include "surfaces.h"
#include <string.h>

static brio_context *ctx;

static brio_mesh *subdivide(const brio_mesh *mesh, int levels) {
    brio_mesh *fine = NULL;
    EXPECT(brio_mesh_subdivide(ctx, mesh, levels, &fine) == BRIO_OK, "%s", brio_message(ctx));
    return fine;
}

static brio_certificate certify(const brio_mesh *mesh) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    return c;
}

/* --- topology --- */

static void counts_genus_and_old_vertices(void) {
    for (int genus = 0; genus < 4; genus++) {
        brio_mesh *mesh = random_surface(ctx, genus, 0.25, (uint64_t)genus);
        brio_certificate before = certify(mesh);
        for (int levels = 1; levels <= 3; levels++) {
            brio_mesh *fine = subdivide(mesh, levels);
            brio_certificate c = certify(fine);
            EXPECT(fine->num_faces == mesh->num_faces << 2 * levels);
            EXPECT(c.closed && c.manifold && c.oriented && c.genus == genus && c.components == 1, "%d", genus);
            EXPECT(!memcmp(fine->vertices, mesh->vertices, 3 * mesh->num_vertices * sizeof(double)));
            EXPECT(fabs(c.volume - before.volume) < 0.05 * before.volume, "%g, %g", c.volume, before.volume);
            if (levels == 1) EXPECT(fine->num_vertices == mesh->num_vertices + 3 * mesh->num_faces / 2);
            brio_certificate_free(&c);
            brio_mesh_free(fine);
        }
        brio_certificate_free(&before);
        brio_mesh_free(mesh);
    }
}

static void levels_are_repetitions(void) {
    brio_mesh *mesh = random_surface(ctx, 1, 0.25, 9);
    brio_mesh *once = subdivide(mesh, 1), *again = subdivide(once, 1), *twice = subdivide(mesh, 2);
    EXPECT(again->num_vertices == twice->num_vertices);
    EXPECT(!memcmp(again->vertices, twice->vertices, 3 * twice->num_vertices * sizeof(double)));
    EXPECT(!memcmp(again->face_vertices, twice->face_vertices, 3 * twice->num_faces * sizeof(uint32_t)));
    brio_mesh_free(mesh);
    brio_mesh_free(once);
    brio_mesh_free(again);
    brio_mesh_free(twice);
}

static void result_does_not_depend_on_threads(void) {
    brio_mesh *mesh = random_surface(ctx, 2, 0.15, 9);
    brio_mesh *many = subdivide(mesh, 1);
    brio_context_set_threads(ctx, 1);
    brio_mesh *one = subdivide(mesh, 1);
    brio_context_set_threads(ctx, 0);
    EXPECT(!memcmp(one->vertices, many->vertices, 3 * one->num_vertices * sizeof(double)));
    brio_mesh_free(mesh);
    brio_mesh_free(many);
    brio_mesh_free(one);
}

static void lone_vertices_and_no_faces(void) {
    const uint32_t face[] = {3, 1, 2};
    brio_mesh *mesh = triangle_mesh(ctx, NULL, 5, face, 1), *fine = subdivide(mesh, 1), *empty = NULL;
    EXPECT(fine->num_vertices == 8 && fine->num_faces == 4);
    EXPECT(!memcmp(fine->vertices, mesh->vertices, 15 * sizeof(double)));
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
    EXPECT(brio_mesh_new(ctx, &empty) == BRIO_OK);
    fine = subdivide(empty, 3);
    EXPECT(fine->num_vertices == 0 && fine->num_faces == 0);
    brio_mesh_free(fine);
    brio_mesh_free(empty);
}

/* --- precision --- */

static double cubic(double x, double y) {
    return 1 + x - 2 * y + x * x - 3 * x * y + 0.5 * y * y + 0.25 * x * x * x - x * x * y + 0.5 * x * y * y + y * y * y;
}

static void cubics_on_a_regular_grid(void) {
    enum { N = 10 };
    brio_mesh *mesh = flat_grid(ctx, N, N);
    for (size_t i = 0; i < mesh->num_vertices; i++) {
        double *p = mesh->vertices + 3 * i;
        p[2] = cubic(p[0], p[1]);
    }
    brio_mesh *fine = subdivide(mesh, 1);
    size_t inside = 0;
    for (size_t i = mesh->num_vertices; i < fine->num_vertices; i++) {
        const double *p = fine->vertices + 3 * i;
        if (p[0] < 2 || p[1] < 2 || p[0] > N - 2 || p[1] > N - 2) continue;
        EXPECT(fmod(2 * p[0], 1) == 0 && fmod(2 * p[1], 1) == 0);
        EXPECT(fabs(p[2] - cubic(p[0], p[1])) < 1e-10, "%g %g: %g", p[0], p[1], p[2] - cubic(p[0], p[1]));
        inside++;
    }
    EXPECT(inside > 100);
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
}

/* Any mesh in a plane, of any degrees and with boundaries, stays in it. */
static void planes_stay_planes(void) {
    brio_mesh *mesh = random_surface(ctx, 1, 0.25, 4);
    for (size_t i = 0; i < mesh->num_vertices; i++) {
        double *p = mesh->vertices + 3 * i;
        p[2] = 3 + 2 * p[0] - 5 * p[1];
    }
    brio_mesh *fine = subdivide(mesh, 2);
    for (size_t i = 0; i < fine->num_vertices; i++) {
        const double *p = fine->vertices + 3 * i;
        EXPECT(fabs(p[2] - (3 + 2 * p[0] - 5 * p[1])) < 1e-12);
    }
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
}

/* Lines on a flat grid are kept up to its boundary, corners left aside: points map to midpoints. */
static void linear_functions_to_the_boundary(void) {
    brio_mesh *mesh = flat_grid(ctx, 5, 4), *fine = subdivide(mesh, 1);
    for (size_t i = mesh->num_vertices; i < fine->num_vertices; i++) {
        const double *p = fine->vertices + 3 * i;
        bool corner = fmin(p[0], 5 - p[0]) < 1 && fmin(p[1], 4 - p[1]) < 1;
        if (!corner) EXPECT(fmod(2 * p[0], 1) == 0 && fmod(2 * p[1], 1) == 0, "%g %g", p[0], p[1]);
    }
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
}

/* --- single rules --- */

/* A hub with `count` neighbours in a closed double pyramid; the far end has as many. */
static brio_mesh *double_pyramid(uint32_t count, uint64_t seed) {
    brio_rng rng = brio_rng_new(seed);
    uint32_t *faces = malloc(6 * count * sizeof *faces);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t j = (i + 1) % count, both[6] = {i, j, count, j, i, count + 1};
        memcpy(faces + 6 * i, both, sizeof both);
    }
    brio_mesh *mesh = triangle_mesh(ctx, NULL, count + 2, faces, 2 * count);
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) mesh->vertices[i] = brio_rng_double(&rng);
    free(faces);
    return mesh;
}

static double weight(uint32_t count, uint32_t j) {
    const double pi = acos(-1), four[] = {3. / 8, 0, -1. / 8, 0};
    if (count == 3) return j ? -1. / 12 : 5. / 12;
    if (count == 4) return four[j];
    return (0.25 + cos(2 * pi * j / count) + 0.5 * cos(4 * pi * j / count)) / count;
}

/* What the paper's sum gives for the edge from a vertex to the first of its neighbours. */
static void paper_rule(const brio_mesh *mesh, uint32_t v, const uint32_t *round, uint32_t count, double *p) {
    for (int k = 0; k < 3; k++) {
        p[k] = 0.75 * mesh->vertices[3 * (size_t)v + (size_t)k];
        for (uint32_t j = 0; j < count; j++)
            p[k] += weight(count, j) * mesh->vertices[3 * (size_t)round[j] + (size_t)k];
    }
}

/* The new vertex between two old ones is what they have in common in the result. */
static const double *vertex_between(const brio_mesh *coarse, const brio_mesh *fine, uint32_t a, uint32_t b) {
    for (size_t f = 0; f < coarse->num_faces; f++)
        for (size_t i = 0; i < 3; i++) {
            const uint32_t *v = coarse->face_vertices + 3 * f;
            if (v[i] == a && v[(i + 1) % 3] == b)
                return fine->vertices + 3 * (size_t)fine->face_vertices[12 * f + 9 + i];
        }
    EXPECT(0, "no edge %u %u", a, b);
    return fine->vertices;
}

static void extraordinary_vertices_follow_the_paper(void) {
    for (uint32_t n = 3; n <= 40; n += n < 10 ? 1 : 10) {
        brio_mesh *mesh = double_pyramid(n, n), *fine = subdivide(mesh, 1);
        for (uint32_t i = 0; i < n; i++) {
            uint32_t round[64];
            const uint32_t rim[4] = {n, (i + 1) % n, n + 1, (i + n - 1) % n};
            double hub[3], other[3];
            for (uint32_t j = 0; j < n; j++) round[j] = (i + j) % n;
            paper_rule(mesh, n, round, n, hub);
            paper_rule(mesh, i, rim, 4, other); /* a vertex of the rim has four neighbours, the hub first */
            const double *p = vertex_between(mesh, fine, n, i);
            for (int k = 0; k < 3; k++) {
                double expected = n == 6 ? other[k] : (hub[k] + other[k]) / 2;
                EXPECT(fabs(p[k] - expected) < 1e-14, "%u neighbours, edge %u: %g", n, i, p[k] - expected);
            }
        }
        brio_mesh_free(fine);
        brio_mesh_free(mesh);
    }
}

static void vertex_of_two_neighbours_has_midpoints(void) {
    const uint32_t faces[] = {0, 1, 2, 2, 1, 0};
    brio_mesh *mesh = triangle_mesh(ctx, NULL, 3, faces, 2), *fine = subdivide(mesh, 1);
    EXPECT(fine->num_vertices == 6);
    for (uint32_t i = 0; i < 3; i++) {
        const double *p = vertex_between(mesh, fine, i, (i + 1) % 3);
        for (size_t k = 0; k < 3; k++)
            EXPECT(fabs(p[k] - (mesh->vertices[3 * i + k] + mesh->vertices[3 * ((i + 1) % 3) + k]) / 2) < 1e-15);
    }
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
}

static void boundary_has_the_four_point_rule(void) {
    brio_mesh *mesh = flat_grid(ctx, 6, 3);
    for (size_t i = 0; i < mesh->num_vertices; i++) mesh->vertices[3 * i + 2] = sin((double)(i * i));
    brio_mesh *fine = subdivide(mesh, 1);
    for (uint32_t i = 1; i < 5; i++) { /* along the first row of vertices, 0 to 6 */
        const double *z = mesh->vertices + 3 * i + 2, *p = vertex_between(mesh, fine, i, i + 1);
        EXPECT(fabs(p[2] - (9 * (z[0] + z[3]) - z[-3] - z[6]) / 16) < 1e-15);
        EXPECT(p[0] == i + 0.5 && p[1] == 0);
    }
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
}

/* --- coordinates near the end of doubles --- */

static void scale(brio_mesh *mesh, int exponent) {
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) mesh->vertices[i] = ldexp(mesh->vertices[i], exponent);
}

/* A surface with all kinds of vertices, at most as large as 1. */
static brio_mesh *rough_surface(bool closed) {
    brio_mesh *mesh = closed ? random_surface(ctx, 1, 0.25, 5) : flat_grid(ctx, 6, 3);
    for (size_t i = 0; i < mesh->num_vertices && !closed; i++) mesh->vertices[3 * i + 2] = sin((double)(i * i));
    scale(mesh, -3);
    return mesh;
}

/* New vertices were infinite or no numbers. */
static void sums_of_large_coordinates_do_not_overflow(void) {
    static const int exponents[] = {900, 951, 1010, 1023};
    for (int closed = 0; closed < 2; closed++)
        for (int i = 0; i < 4; i++) {
            brio_mesh *mesh = rough_surface(closed), *expected = subdivide(mesh, 2);
            scale(expected, exponents[i]);
            scale(mesh, exponents[i]);
            brio_mesh *fine = subdivide(mesh, 2);
            for (size_t k = 0; k < 3 * fine->num_vertices; k++)
                EXPECT(fine->vertices[k] == expected->vertices[k], "2^%d: %g", exponents[i], fine->vertices[k]);
            brio_mesh_free(fine);
            brio_mesh_free(expected);
            brio_mesh_free(mesh);
        }
}

static void old_vertices_stay_beside_large_ones(void) {
    const double points[] = {1e308, 0x1p-1074, 0, -1e308, 1e-310, 1, 0, 1e308, -0.0};
    const uint32_t face[] = {0, 1, 2};
    brio_mesh *mesh = triangle_mesh(ctx, points, 3, face, 1), *fine = subdivide(mesh, 3);
    EXPECT(!memcmp(fine->vertices, points, sizeof points));
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
}

/* --- properties --- */

static void properties_go_along(void) {
    brio_mesh *mesh = random_surface(ctx, 0, 0.3, 2);
    double *height;
    float *half;
    uint16_t *label;
    EXPECT(brio_mesh_add_property(mesh, "height", BRIO_SCALAR_FLOAT64, (void **)&height) == BRIO_OK);
    EXPECT(brio_mesh_add_property(mesh, "half", BRIO_SCALAR_FLOAT32, (void **)&half) == BRIO_OK);
    EXPECT(brio_mesh_add_property(mesh, "label", BRIO_SCALAR_UINT16, (void **)&label) == BRIO_OK);
    for (size_t i = 0; i < mesh->num_vertices; i++) {
        height[i] = (double)i;
        half[i] = (float)i / 2;
        label[i] = (uint16_t)(i * 77);
    }
    brio_mesh *fine = subdivide(mesh, 1);
    EXPECT(fine->num_properties == 3);
    for (size_t f = 0; f < mesh->num_faces; f++)
        for (size_t i = 0; i < 3; i++) {
            uint32_t a = mesh->face_vertices[3 * f + i], b = mesh->face_vertices[3 * f + (i + 1) % 3];
            uint32_t e = fine->face_vertices[12 * f + 9 + i];
            double found = brio_property_value(&fine->properties[2], e);
            EXPECT(brio_property_value(&fine->properties[0], e) == (a + b) / 2.0);
            EXPECT(brio_property_value(&fine->properties[1], e) == (a + b) / 4.0);
            EXPECT(found == (uint16_t)(a * 77) || found == (uint16_t)(b * 77));
            EXPECT(brio_property_value(&fine->properties[2], a) == label[a]);
        }
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
}

/* The mean of two values at an end of the doubles is the value. */
static void constant_properties_stay_at_the_ends_of_doubles(void) {
    static const double ends[] = {0x1p-1074, 0x1.fffffffffffffp1023};
    for (int end = 0; end < 2; end++) {
        brio_mesh *mesh = random_surface(ctx, 0, 0.3, 2);
        double *height;
        EXPECT(brio_mesh_add_property(mesh, "height", BRIO_SCALAR_FLOAT64, (void **)&height) == BRIO_OK);
        for (size_t i = 0; i < mesh->num_vertices; i++) height[i] = ends[end];
        brio_mesh *fine = subdivide(mesh, 1);
        for (size_t i = 0; i < fine->num_vertices; i++)
            EXPECT(brio_property_value(&fine->properties[0], i) == ends[end], "vertex %zu", i);
        brio_mesh_free(fine);
        brio_mesh_free(mesh);
    }
}

/* --- refusals --- */

static void expect_refusal(const brio_mesh *mesh, int levels, brio_status expected, const char *part) {
    brio_mesh *fine = NULL;
    brio_status status = brio_mesh_subdivide(ctx, mesh, levels, &fine);
    EXPECT(status == expected && !fine, "status %d", (int)status);
    EXPECT(strstr(brio_message(ctx), part), "%s", brio_message(ctx));
}

static void refusals(void) {
    const uint32_t faces[] = {0, 1, 2, 1, 0, 3, 0, 1, 4}, flipped[] = {0, 1, 2, 0, 1, 3}, outside[] = {0, 1, 5};
    brio_mesh *mesh = triangle_mesh(ctx, NULL, 5, faces, 3);
    expect_refusal(mesh, 0, BRIO_ERR_ARGUMENT, "0 levels");
    expect_refusal(mesh, 16, BRIO_ERR_ARGUMENT, "16 levels");
    expect_refusal(mesh, 1, BRIO_ERR_NO_ANSWER, "more than two faces");
    brio_mesh_free(mesh);
    mesh = triangle_mesh(ctx, NULL, 5, flipped, 2);
    expect_refusal(mesh, 1, BRIO_ERR_NO_ANSWER, "disagree");
    brio_mesh_free(mesh);
    mesh = triangle_mesh(ctx, NULL, 5, outside, 1);
    expect_refusal(mesh, 1, BRIO_ERR_ARGUMENT, "vertex 5 of a mesh of 5");
    brio_mesh_free(mesh);
    const double ends[] = {1.5e308, 0, 0, -1.5e308, 1e308, 0, 1.4e308, -1.7e308, 1e308};
    mesh = triangle_mesh(ctx, ends, 3, faces, 1);
    expect_refusal(mesh, 1, BRIO_ERR_NO_ANSWER, "doubles cannot hold vertex");
    brio_mesh_free(mesh);
    mesh = triangle_mesh(ctx, NULL, 5, faces, 1);
    brio_context_set_memory_limit(ctx, brio_context_memory(ctx) + 200000000);
    expect_refusal(mesh, 15, BRIO_ERR_NO_MEMORY, "");
    brio_context_set_memory_limit(ctx, 0);
    brio_mesh_free(mesh);
}

static int cancel_from_half(const char *stage, double fraction, void *user) {
    (void)stage, (void)user;
    return fraction > 0.5;
}

static void cancelled(void) {
    brio_mesh *mesh = random_surface(ctx, 0, 0.3, 2), *fine = NULL;
    brio_context_set_progress(ctx, cancel_from_half, NULL);
    EXPECT(brio_mesh_subdivide(ctx, mesh, 2, &fine) == BRIO_ERR_CANCELLED && !fine);
    brio_context_set_progress(ctx, NULL, NULL);
    brio_mesh_free(mesh);
}

static brio_status two_levels(brio_context *failing) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL, *fine = NULL;
    chain c = {.genus = 0, .radius = 0.4};
    brio_implicit_grid grid = {chain_value, &c, {-1.5, -1.5, -1.5}, 0.75, {4, 4, 4}};
    BRIO_TRY(brio_marched_surface(failing, &grid, &mesh));
    BRIO_TRY(brio_mesh_add_property(mesh, "p", BRIO_SCALAR_FLOAT32, NULL));
    BRIO_TRY(brio_mesh_subdivide(failing, mesh, 2, &fine));
done:
    brio_mesh_free(mesh);
    brio_mesh_free(fine);
    return status;
}

static brio_status two_levels_of_a_large_mesh(brio_context *failing) {
    const double points[] = {0, 0, 0, 1e308, 0, 0, 0, 1e308, 0};
    const uint32_t face[] = {0, 1, 2};
    const uint64_t offsets[] = {0, 3};
    brio_mesh *mesh = NULL, *fine = NULL;
    brio_status status = brio_mesh_new(failing, &mesh);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(mesh, points, 3);
    if (status == BRIO_OK) status = brio_mesh_set_faces(mesh, offsets, face, 1);
    if (status == BRIO_OK) status = brio_mesh_subdivide(failing, mesh, 2, &fine);
    brio_mesh_free(fine);
    brio_mesh_free(mesh);
    return status;
}

static void memory_fails_cleanly(void) {
    expect_clean_failures(two_levels);
    expect_clean_failures(two_levels_of_a_large_mesh);
}

SUITE(test_subdivide) {
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return HARNESS_SKIP;
    RUN(counts_genus_and_old_vertices);
    RUN(levels_are_repetitions);
    RUN(result_does_not_depend_on_threads);
    RUN(lone_vertices_and_no_faces);
    RUN(cubics_on_a_regular_grid);
    RUN(planes_stay_planes);
    RUN(linear_functions_to_the_boundary);
    RUN(extraordinary_vertices_follow_the_paper);
    RUN(vertex_of_two_neighbours_has_midpoints);
    RUN(boundary_has_the_four_point_rule);
    RUN(properties_go_along);
    RUN(sums_of_large_coordinates_do_not_overflow);
    RUN(old_vertices_stay_beside_large_ones);
    RUN(constant_properties_stay_at_the_ends_of_doubles);
    RUN(refusals);
    RUN(cancelled);
    RUN(memory_fails_cleanly);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
