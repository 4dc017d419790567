/* Samples of the faces of meshes: how far places are from them, and how close together they are. */
#include "base/rng.h"
#include "failing_allocator.h"
#include "points.h"
#include "query/nearest_points.h"
#include "surfaces.h"
#include <math.h>
#include <string.h>

/* Triangles of every shape: long, flat, without area. */
static brio_mesh *random_triangles(brio_context *ctx, uint64_t seed, size_t count) {
    brio_rng rng = brio_rng_new(seed);
    double *v = malloc(9 * count * sizeof *v);
    uint32_t *t = malloc(3 * count * sizeof *t);
    for (size_t i = 0; i < 9 * count; i++) v[i] = 10 * brio_rng_double(&rng);
    for (size_t f = 0; f < count; f++) {
        double *p = v + 9 * f;
        double flat = f % 3 == 0 ? 1e-3 : f % 3 == 1 ? 1 : 0;
        for (int k = 0; k < 3; k++) p[6 + k] = p[k] + 0.3 * (p[3 + k] - p[k]) + flat * (p[6 + k] - p[k]);
        for (uint32_t c = 0; c < 3; c++) t[3 * f + c] = (uint32_t)(3 * f + c);
    }
    brio_mesh *mesh = triangle_mesh(ctx, v, 3 * count, t, count);
    free(v);
    free(t);
    return mesh;
}

static void every_place_is_within_the_spacing_of_a_sample(void) {
    brio_context *ctx = new_context();
    for (uint64_t seed = 0; seed < 20; seed++) {
        brio_mesh *mesh = random_triangles(ctx, seed, 30), *samples = NULL;
        brio_rng rng = brio_rng_new(100 + seed);
        brio_point_tree tree;
        double spacing = 0.2 + 5 * brio_rng_double(&rng), most = 0;
        EXPECT(brio_mesh_samples(ctx, mesh, spacing, &samples) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_point_tree_new(ctx, samples->vertices, samples->num_vertices, &tree) == BRIO_OK);
        for (int i = 0; i < 20000; i++) {
            const double *p = mesh->vertices + 9 * (brio_rng_next(&rng) % 30);
            double s = brio_rng_double(&rng), t = brio_rng_double(&rng), x[3];
            if (s + t > 1) s = 1 - s, t = 1 - t;
            for (int k = 0; k < 3; k++) x[k] = p[k] + s * (p[3 + k] - p[k]) + t * (p[6 + k] - p[k]);
            most = fmax(most, sqrt(brio_nearest_square(&tree, x, INFINITY)));
        }
        EXPECT(most <= spacing, "seed %d: %g of %g", (int)seed, most, spacing);
        EXPECT(!memcmp(samples->vertices, mesh->vertices, 24 * mesh->num_vertices), "the vertices come first");
        for (size_t i = mesh->num_vertices; i < samples->num_vertices; i++) {
            brio_near_point near[BRIO_NEAR_ROOM];
            size_t found = brio_nearest_points(&tree, samples->vertices + 3 * i, 2, INFINITY, near);
            EXPECT(found == 2 && sqrt(fmax(near[0].square, near[1].square)) >= 0.5 * spacing * (1 - 1e-12));
        }
        brio_point_tree_free(ctx, &tree);
        brio_mesh_free(mesh);
        brio_mesh_free(samples);
    }
    brio_context_free(ctx);
}

static void scale_changes_nothing(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = random_triangles(ctx, 5, 30), *a = NULL, *b = NULL;
    EXPECT(brio_mesh_samples(ctx, mesh, 1, &a) == BRIO_OK);
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) mesh->vertices[i] *= 0x1p-400;
    EXPECT(brio_mesh_samples(ctx, mesh, 0x1p-400, &b) == BRIO_OK);
    bool same = a && b && a->num_vertices == b->num_vertices;
    for (size_t i = 0; same && i < 3 * a->num_vertices; i++) same = a->vertices[i] * 0x1p-400 == b->vertices[i];
    EXPECT(same);
    brio_mesh_free(mesh);
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void wrong_spacings_are_refused(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = random_triangles(ctx, 5, 3), *out = NULL;
    static const double wrong[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++) EXPECT(brio_mesh_samples(ctx, mesh, wrong[i], &out) == BRIO_ERR_ARGUMENT && !out);
    EXPECT(brio_mesh_samples(ctx, mesh, 1e-300, &out) == BRIO_ERR_TOO_LARGE && !out, "%s", brio_message(ctx));
    mesh->num_faces = 0;
    EXPECT(brio_mesh_samples(ctx, mesh, 1, &out) == BRIO_ERR_ARGUMENT && !out);
    mesh->num_faces = 3;
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static brio_status small_samples(brio_context *ctx) {
    brio_mesh *mesh = NULL, *out = NULL;
    const double v[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint64_t offsets[2] = {0, 3};
    const uint32_t corners[3] = {0, 1, 2};
    brio_status status = brio_mesh_new(ctx, &mesh);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(mesh, v, 3);
    if (status == BRIO_OK) status = brio_mesh_set_faces(mesh, offsets, corners, 1);
    if (status == BRIO_OK) status = brio_mesh_samples(ctx, mesh, 0.1, &out);
    brio_mesh_free(mesh);
    brio_mesh_free(out);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_samples);
}

SUITE(test_mesh_samples) {
    RUN(every_place_is_within_the_spacing_of_a_sample);
    RUN(scale_changes_nothing);
    RUN(wrong_spacings_are_refused);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
