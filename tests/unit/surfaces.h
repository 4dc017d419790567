/* Surfaces to test with: random closed ones of any genus, pieces with boundary, meshes made by hand. */
#ifndef BRIO_TESTS_SURFACES_H
#define BRIO_TESTS_SURFACES_H

#include "base/rng.h"
#include "harness.h"
#include "iso/iso_surface.h"
#include <math.h>

/* A chain of tori, bent at random. */
typedef struct {
    int genus;
    double radius, bend[3], phase[3];
} chain;

static inline double chain_value(const double *p, const void *user) {
    const chain *c = user;
    double q[3], least = 1e9;
    for (int k = 0; k < 3; k++) q[k] = p[k] + c->bend[k] * sin(p[(k + 1) % 3] + c->phase[k]);
    for (int i = 0; i < c->genus; i++) {
        double x = q[0] - 2 * i, ring = sqrt(x * x + q[1] * q[1]) - 1;
        least = fmin(least, sqrt(ring * ring + q[2] * q[2]) - c->radius);
    }
    return c->genus ? least : sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) - 1;
}

/* A closed surface of a genus, the same for the same seed.   cell  of the grid, at most 0.25 */
static inline brio_mesh *random_surface(brio_context *ctx, int genus, double cell, uint64_t seed) {
    brio_rng rng = brio_rng_new(seed);
    brio_mesh *mesh = NULL;
    chain c = {.genus = genus, .radius = 0.3 + 0.2 * brio_rng_double(&rng)};
    brio_implicit_grid grid = {.value = chain_value, .user = &c, .cell = cell};
    for (int k = 0; k < 3; k++) {
        c.bend[k] = 0.2 * brio_rng_double(&rng);
        c.phase[k] = 6 * brio_rng_double(&rng);
        grid.low[k] = -2 - cell * brio_rng_double(&rng);
        grid.cells[k] = (uint32_t)((4 + (k == 0 && genus > 1 ? 2 * (genus - 1) : 0)) / cell) + 2;
    }
    EXPECT(brio_marched_surface(ctx, &grid, &mesh) == BRIO_OK, "%s", brio_message(ctx));
    return mesh;
}

/* A mesh of triangles made by hand; positions are a spiral when NULL. */
static inline brio_mesh *triangle_mesh(brio_context *ctx, const double *points, size_t num_vertices,
                                       const uint32_t *triangles, size_t num_triangles) {
    brio_mesh *mesh = NULL;
    uint64_t *offsets = malloc((num_triangles + 1) * sizeof *offsets);
    for (size_t f = 0; f <= num_triangles; f++) offsets[f] = 3 * f;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(brio_mesh_set_vertices(mesh, points, num_vertices) == BRIO_OK);
    for (size_t i = 0; !points && i < num_vertices; i++) {
        double *p = mesh->vertices + 3 * i, t = (double)i;
        p[0] = cos(t) * (1 + t);
        p[1] = sin(t) * (1 + t);
        p[2] = t;
    }
    EXPECT(brio_mesh_set_faces(mesh, offsets, triangles, num_triangles) == BRIO_OK);
    free(offsets);
    return mesh;
}

/* A copy of a mesh without the triangles for which `drop` says so. */
static inline brio_mesh *without_triangles(brio_context *ctx, const brio_mesh *mesh,
                                           int (*drop)(const brio_mesh *, size_t)) {
    uint32_t *kept = malloc(3 * mesh->num_faces * sizeof *kept);
    size_t count = 0;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        if (drop(mesh, f)) continue;
        for (int i = 0; i < 3; i++) kept[3 * count + (size_t)i] = mesh->face_vertices[3 * f + (size_t)i];
        count++;
    }
    brio_mesh *copy = triangle_mesh(ctx, mesh->vertices, mesh->num_vertices, kept, count);
    free(kept);
    return copy;
}

/* A flat grid of m by n squares, each cut in two along the same diagonal; its inner vertices have six neighbours. */
static inline brio_mesh *flat_grid(brio_context *ctx, uint32_t m, uint32_t n) {
    size_t vertices = (size_t)(m + 1) * (n + 1), count = 0;
    double *points = malloc(3 * vertices * sizeof *points);
    uint32_t *triangles = malloc((size_t)m * n * 6 * sizeof *triangles);
    for (size_t i = 0; i < vertices; i++) {
        points[3 * i] = (double)(i % (m + 1));
        points[3 * i + 1] = (double)(i / (m + 1));
        points[3 * i + 2] = 0;
    }
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < m; x++) {
            uint32_t a = y * (m + 1) + x, b = a + 1, c = b + m + 1, d = a + m + 1;
            const uint32_t corners[6] = {a, b, c, a, c, d};
            for (int i = 0; i < 6; i++) triangles[count++] = corners[i];
        }
    brio_mesh *mesh = triangle_mesh(ctx, points, vertices, triangles, count / 3);
    free(points);
    free(triangles);
    return mesh;
}

#endif
