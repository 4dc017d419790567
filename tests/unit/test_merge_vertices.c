/* Vertices that merge: against brute force, for any order, and what becomes of faces, properties and wrong calls. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST = 400 };

static uint64_t state = 1;

static unsigned below(unsigned n) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(state >> 33) % n;
}

static brio_mesh *cloud(brio_context *ctx, const double *points, size_t n) {
    brio_mesh *mesh;
    void *data;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, points, n) == BRIO_OK);
    EXPECT(brio_mesh_add_property(mesh, "index", BRIO_SCALAR_INT32, &data) == BRIO_OK);
    for (size_t i = 0; i < n; i++) ((int32_t *)data)[i] = (int32_t)i;
    return mesh;
}

static int32_t index_of(const brio_mesh *mesh, size_t v) {
    return ((const int32_t *)mesh->properties[0].data)[v];
}

static int is_near(const double *p, const double *q, double distance) {
    double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return x * x + y * y + z * z <= distance * distance;
}

static int is_before(const double *p, const double *q) {
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k];
    return 0;
}

/* Finds the vertex that stands for each one: grows sets until nothing changes. */
static void brute_force(const double *points, size_t n, double distance, size_t *stands) {
    size_t set[MOST];
    for (size_t i = 0; i < n; i++) set[i] = i;
    for (int changed = 1; changed;) {
        changed = 0;
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n; j++)
                if (set[j] < set[i] && is_near(points + 3 * i, points + 3 * j, distance)) set[i] = set[j], changed = 1;
    }
    for (size_t i = 0; i < n; i++) {
        stands[i] = i;
        for (size_t j = n; j-- > 0;)
            if (set[j] == set[i] && !is_before(points + 3 * stands[i], points + 3 * j) &&
                (is_before(points + 3 * j, points + 3 * stands[i]) || j < stands[i]))
                stands[i] = j;
    }
}

/* Integer grids, where ties are the common case; all squares are exact. */
static void sets_are_those_of_brute_force(void) {
    brio_context *ctx = new_context();
    for (int run = 0; run < (SHORT_TESTS ? 60 : 400); run++) {
        double points[3 * MOST], distance = (double[]){0, 1, sqrt(2) * 1.0000001, 2, 3, 4.5, 40}[below(7)];
        size_t n = below(MOST), stands[MOST], kept = 0;
        unsigned side = 2 + below(run % 2 ? 40 : 8);
        for (size_t i = 0; i < 3 * n; i++) points[i] = (double)below(side) - side / 2.0 + (below(9) ? 0 : -0.0);
        brute_force(points, n, distance, stands);
        brio_mesh *mesh = cloud(ctx, points, n);
        brio_merge_stats stats = {0};
        EXPECT(brio_mesh_merge_vertices(mesh, distance, &stats) == BRIO_OK, "%s", brio_message(ctx));
        for (size_t i = 0; i < n; i++) {
            if (stands[i] != i) continue;
            EXPECT(kept < mesh->num_vertices && index_of(mesh, kept) == (int32_t)i, "run %d, vertex %zu", run, i);
            EXPECT(kept < mesh->num_vertices && !memcmp(mesh->vertices + 3 * kept, points + 3 * i, 24));
            kept++;
        }
        EXPECT(mesh->num_vertices == kept && stats.vertices == n - kept && !stats.faces);
        brio_mesh_free(mesh);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static int compare_rows(const void *a, const void *b) {
    return is_before(a, b) ? -1 : is_before(b, a);
}

/* Merges points in an order of the run, and sorts what is left. Returns how much that is. */
static size_t merged_positions(brio_context *ctx, const double *points, size_t n, double *out) {
    double mixed[3 * MOST];
    memcpy(mixed, points, 3 * n * sizeof *mixed);
    for (size_t i = n; i-- > 1;) {
        size_t j = below((unsigned)i + 1);
        for (int k = 0; k < 3; k++) {
            double x = mixed[3 * i + (size_t)k];
            mixed[3 * i + (size_t)k] = mixed[3 * j + (size_t)k];
            mixed[3 * j + (size_t)k] = x;
        }
    }
    brio_mesh *mesh = cloud(ctx, mixed, n);
    EXPECT(brio_mesh_merge_vertices(mesh, 0.07, NULL) == BRIO_OK);
    size_t left = mesh->num_vertices;
    memcpy(out, mesh->vertices, 3 * left * sizeof *out);
    qsort(out, left, 3 * sizeof *out, compare_rows);
    brio_mesh_free(mesh);
    return left;
}

static void the_order_of_the_vertices_does_not_matter(void) {
    brio_context *ctx = new_context();
    double points[3 * MOST], first[3 * MOST], other[3 * MOST];
    for (size_t i = 0; i < 3 * MOST; i++) points[i] = below(1u << 30) * 0x1p-30;
    size_t left = merged_positions(ctx, points, MOST, first);
    EXPECT(left > 20 && left < MOST - 20, "%zu", left);
    for (int run = 0; run < 5; run++) {
        EXPECT(merged_positions(ctx, points, MOST, other) == left && !memcmp(first, other, 3 * left * sizeof *first));
    }
    brio_context_free(ctx);
}

/* Two triangles and a square whose vertices are apart, a triangle that loses a corner, a pentagon that keeps four. */
static brio_mesh *parts(brio_context *ctx) {
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -0.0, 0, 0, 5, 5, 5};
    static const uint64_t offsets[] = {0, 3, 6, 9, 14, 18};
    static const uint32_t corners[] = {0, 1, 2, 3, 4, 5, 0, 6, 7, 0, 1, 3, 4, 2, 0, 7, 6, 7};
    static const uint32_t edges[] = {0, 6, 0, 7}, tetrahedra[] = {0, 1, 2, 7, 1, 3, 2, 7};
    brio_mesh *mesh = cloud(ctx, points, 8);
    EXPECT(brio_mesh_set_faces(mesh, offsets, corners, 5) == BRIO_OK);
    EXPECT(brio_mesh_set_edges(mesh, edges, 2) == BRIO_OK);
    EXPECT(brio_mesh_set_tetrahedra(mesh, tetrahedra, 4, 2) == BRIO_OK);
    return mesh;
}

static void faces_share_vertices_and_degenerate_ones_go(void) {
    static const uint64_t offsets[] = {0, 3, 6, 10};
    static const uint32_t corners[] = {0, 1, 2, 1, 3, 2, 0, 1, 3, 2};
    brio_context *ctx = new_context();
    brio_mesh *mesh = parts(ctx);
    brio_merge_stats stats = {0};
    EXPECT(brio_mesh_merge_vertices(mesh, 0, &stats) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(stats.vertices == 3 && stats.faces == 2 && stats.tetrahedra == 1 && stats.edges == 1);
    EXPECT(mesh->num_vertices == 5 && index_of(mesh, 3) == 4 && index_of(mesh, 4) == 7);
    EXPECT(mesh->num_faces == 3 && !memcmp(mesh->face_offsets, offsets, sizeof offsets));
    EXPECT(!memcmp(mesh->face_vertices, corners, sizeof corners));
    EXPECT(mesh->num_edges == 1 && mesh->edges[1] == 4 && mesh->num_tetrahedra == 1 && mesh->tetrahedra[3] == 4);
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void wrong_calls_leave_the_mesh_as_it_was(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = parts(ctx);
    const double wrong[] = {-1, NAN, INFINITY, 4e-308 / 4, 1e-13};
    for (int i = 0; i < 5; i++) EXPECT(brio_mesh_merge_vertices(mesh, wrong[i], NULL) == BRIO_ERR_ARGUMENT, "%d", i);
    EXPECT(brio_mesh_merge_vertices(mesh, 1e-10, NULL) == BRIO_OK && mesh->num_vertices == 5);
    mesh->edges[0] = 99;
    EXPECT(brio_mesh_merge_vertices(mesh, 0, NULL) == BRIO_ERR_ARGUMENT && mesh->num_vertices == 5);
    mesh->edges[0] = 0;
    mesh->vertices[0] = NAN;
    EXPECT(brio_mesh_merge_vertices(mesh, 0, NULL) == BRIO_ERR_NOT_FINITE && mesh->num_vertices == 5);
    brio_mesh_free(mesh);
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_merge_vertices(mesh, 0, NULL) == BRIO_OK);
    EXPECT(brio_mesh_merge_vertices(mesh, 3, NULL) == BRIO_OK);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* Squares of these differences overflow, or are 0. */
static void the_scale_does_not_matter(void) {
    brio_context *ctx = new_context();
    for (int exponent = -900; exponent <= 1000; exponent += 100) {
        double points[3 * 60];
        for (size_t i = 0; i < 3 * 60; i++) points[i] = ldexp((double)(i * i % 23), exponent);
        brio_mesh *mesh = cloud(ctx, points, 60);
        size_t stands[MOST], left = 0;
        double plain[3 * 60];
        for (size_t i = 0; i < 3 * 60; i++) plain[i] = (double)(i * i % 23);
        brute_force(plain, 60, 6, stands);
        for (size_t i = 0; i < 60; i++) left += stands[i] == i;
        EXPECT(brio_mesh_merge_vertices(mesh, ldexp(6, exponent), NULL) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(mesh->num_vertices == left, "2^%d: %zu, not %zu", exponent, mesh->num_vertices, left);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

static brio_status merge_parts(brio_context *ctx) {
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0};
    static const uint64_t offsets[] = {0, 3};
    static const uint32_t corners[] = {0, 1, 2};
    brio_mesh *mesh = NULL;
    brio_status status = brio_mesh_new(ctx, &mesh);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(mesh, points, 4);
    if (status == BRIO_OK) status = brio_mesh_set_faces(mesh, offsets, corners, 1);
    if (status == BRIO_OK) status = brio_mesh_merge_vertices(mesh, 0.5, NULL);
    if (mesh) EXPECT(mesh->num_vertices == (status == BRIO_OK ? 3u : mesh->vertices ? 4u : 0u));
    brio_mesh_free(mesh);
    return status;
}

/* A grid of the spacing 0.1, merged over 0.1, fell into 64 vertices: distances were 0.1 up to rounding, some of them above it. */
static void vertices_of_a_grid_merge_over_its_spacing(void) {
    enum { SIDE = 6, COUNT = SIDE * SIDE * SIDE };
    const double spacings[] = {1, 0.1, 0.3, 1.0 / 3, 1e-3}, shifts[] = {0, 1000, -12345.678};
    for (size_t s = 0; s < 15; s++) {
        brio_context *ctx = new_context();
        brio_mesh *mesh = NULL;
        double points[3 * COUNT], spacing = spacings[s % 5];
        for (size_t i = 0; i < COUNT; i++) {
            const size_t at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            for (size_t k = 0; k < 3; k++) points[3 * i + k] = shifts[s / 5] + spacing * (double)at[k];
        }
        EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, points, COUNT) == BRIO_OK);
        EXPECT(brio_mesh_merge_vertices(mesh, 0.999 * spacing, NULL) == BRIO_OK && mesh->num_vertices == COUNT);
        EXPECT(brio_mesh_merge_vertices(mesh, spacing, NULL) == BRIO_OK && mesh->num_vertices == 1,
               "spacing %g at %g: %zu", spacing, shifts[s / 5], mesh->num_vertices);
        brio_mesh_free(mesh);
        brio_context_free(ctx);
    }
}

static void every_failing_allocation_is_clean(void) {
    expect_clean_failures(merge_parts);
}

SUITE(test_merge_vertices) {
    RUN(sets_are_those_of_brute_force);
    RUN(the_order_of_the_vertices_does_not_matter);
    RUN(faces_share_vertices_and_degenerate_ones_go);
    RUN(wrong_calls_leave_the_mesh_as_it_was);
    RUN(the_scale_does_not_matter);
    RUN(vertices_of_a_grid_merge_over_its_spacing);
    RUN(every_failing_allocation_is_clean);
    return harness_end();
}
