/* Counts from a caller that no array can have: refused before anything is read or allocated by them. */
#include "brio/testdata.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include "trial.h"
#include <stdint.h>

static double points[3] = {1, 2, 3};
static uint32_t indices[4] = {0, 1, 2, 3};
static brio_context *ctx;

/* Counts that wrap when they are multiplied by 3, 4, 8, 24 or 32, or when 1 is added. The least would fit in a size_t, and in
 * no index. Where addresses have 32 bits some of them are numbers that an array can have. */
static const size_t COUNTS[] = {SIZE_MAX,          SIZE_MAX - 1,      SIZE_MAX / 2 + 1,  SIZE_MAX / 3 + 1,
                                SIZE_MAX / 4 + 2,  SIZE_MAX / 8 + 2,  SIZE_MAX / 16 + 2, SIZE_MAX / 24 + 2,
                                SIZE_MAX / 32 + 2, SIZE_MAX / 72 + 2, SIZE_MAX / 96 + 2, (size_t)UINT32_MAX + 1};

typedef brio_status (*call)(size_t n);

static brio_status delaunay(size_t n) {
    brio_triangulation *t = NULL;
    return brio_delaunay(ctx, points, NULL, n, NULL, &t);
}
static brio_status delaunay2(size_t n) {
    brio_triangulation2 *t = NULL;
    return brio_delaunay2(ctx, points, NULL, n, NULL, &t);
}
static brio_status delaunay2_flat(size_t n) {
    brio_triangulation2 *t = NULL;
    return brio_delaunay2_flat(ctx, points, NULL, n, NULL, &t);
}
static brio_status convex_hull(size_t n) {
    brio_mesh *mesh = NULL;
    return brio_convex_hull(ctx, points, n, NULL, &mesh, NULL);
}
static brio_status labeled_delaunay(size_t n) {
    brio_mesh *mesh = NULL;
    return make_labeled(ctx, points, n, NULL, &mesh, NULL, NULL);
}
static brio_status power_crust(size_t n) {
    brio_mesh *mesh = NULL;
    return make_crust(ctx, points, n, NULL, &mesh, NULL, NULL);
}
static brio_status cocone(size_t n) {
    brio_mesh *mesh = NULL;
    return make_cocone(ctx, points, n, NULL, &mesh, NULL);
}
static brio_status offset_surface(size_t n) {
    brio_mesh *mesh = NULL;
    return make_offset(ctx, points, n, 1, NULL, &mesh, NULL);
}
static brio_status power_shape(size_t n) {
    brio_mesh *shape = NULL;
    return brio_power_shape(ctx, points, n, NULL, &shape, NULL, NULL);
}
static brio_status thin(size_t n) {
    uint8_t chosen[1];
    return brio_thin(ctx, points, n, 1, chosen, NULL);
}
static brio_status outliers(size_t n) {
    uint8_t outlier[1];
    return brio_outliers(ctx, points, n, 8, NULL, outlier);
}
static brio_status generate(size_t n) {
    brio_mesh *mesh = NULL;
    return brio_generate(ctx, BRIO_KIND_CUBE, n, NULL, &mesh);
}
static brio_status tetrahedra_check(size_t n) {
    return brio_tetrahedra_check(ctx, points, NULL, n, indices, 4, 0, NULL);
}
static brio_status tetrahedra_check_many(size_t n) {
    return brio_tetrahedra_check(ctx, points, NULL, 1, indices, 4, n, NULL);
}
static brio_status estimate(size_t n) {
    uint64_t bytes;
    return brio_estimate_delaunay(ctx, points, NULL, n, NULL, &bytes);
}
static brio_status estimate_tetrahedra(size_t n) {
    uint64_t tetrahedra;
    return brio_estimate_tetrahedra(ctx, points, NULL, n, &tetrahedra);
}

/* Edges were read by their number before it was held against any limit, and twice that number wrapped. */
static brio_status edges(size_t n) {
    brio_triangulation *t = NULL;
    trial_options o = {0};
    o.locate = BRIO_LOCATION_NEIGHBOUR;
    o.edges = indices;
    o.num_edges = n;
    return trial_delaunay(ctx, points, NULL, 1, &o, &t, NULL);
}

/* Of a mesh: a new one for each call. */
static brio_status of_mesh(size_t n, int way) {
    static const uint64_t offsets[2] = {0, 3};
    brio_mesh *mesh = NULL;
    brio_status status = brio_mesh_new(ctx, &mesh);
    if (status != BRIO_OK) return status;
    if (way == 0) status = brio_mesh_set_vertices(mesh, points, n);
    if (way == 1) status = brio_mesh_set_faces(mesh, offsets, indices, n);
    if (way == 2) status = brio_mesh_set_tetrahedra(mesh, indices, 4, n);
    if (way == 3) status = brio_mesh_set_edges(mesh, indices, n);
    brio_mesh_free(mesh);
    return status;
}
static brio_status set_vertices(size_t n) {
    return of_mesh(n, 0);
}
static brio_status set_faces(size_t n) {
    return n == (size_t)UINT32_MAX + 1 ? BRIO_ERR_TOO_LARGE : of_mesh(n, 1); /* as many faces can be */
}
static brio_status set_tetrahedra(size_t n) {
    return n == (size_t)UINT32_MAX + 1 ? BRIO_ERR_TOO_LARGE : of_mesh(n, 2);
}
static brio_status set_edges(size_t n) {
    return n == (size_t)UINT32_MAX + 1 ? BRIO_ERR_TOO_LARGE : of_mesh(n, 3);
}

static const struct {
    const char *name;
    call run;
    size_t row; /* bytes */
} CALLS[] = {
    {"delaunay", delaunay, 24},
    {"delaunay2", delaunay2, 24},
    {"delaunay2_flat", delaunay2_flat, 24},
    {"convex_hull", convex_hull, 24},
    {"labeled_delaunay", labeled_delaunay, 24},
    {"power_crust", power_crust, 24},
    {"cocone", cocone, 24},
    {"offset_surface", offset_surface, 24},
    {"power_shape", power_shape, 24},
    {"thin", thin, 24},
    {"outliers", outliers, 24},
    {"generate", generate, 24},
    {"tetrahedra_check", tetrahedra_check, 24},
    {"tetrahedra_check_many", tetrahedra_check_many, 16},
    {"estimate", estimate, 24},
    {"estimate tetrahedra", estimate_tetrahedra, 24},
    {"edges", edges, 8},
    {"set_vertices", set_vertices, 24},
    {"set_faces", set_faces, 8},
    {"set_tetrahedra", set_tetrahedra, 16},
    {"set_edges", set_edges, 8},
};

/* Whether there may be an array of n rows after all, in half of the addresses of 32 bits. */
static bool may_be(size_t n, size_t row) {
    return SIZE_MAX == UINT32_MAX && n <= SIZE_MAX / 2 / row;
}

/* The power crust and the co-cone read all points for their scale before they held the number against the limit. */
static void counts_that_no_array_has_are_refused(void) {
    for (size_t c = 0; c < sizeof CALLS / sizeof *CALLS; c++) {
        for (size_t i = 0; i < sizeof COUNTS / sizeof *COUNTS; i++) {
            if (may_be(COUNTS[i], CALLS[c].row)) continue;
            brio_status status = CALLS[c].run(COUNTS[i]);
            EXPECT(status == BRIO_ERR_TOO_LARGE || status == BRIO_ERR_NO_MEMORY, "%s of %zu: %s", CALLS[c].name,
                   COUNTS[i], brio_status_string(status));
            EXPECT(brio_context_memory(ctx) == 0, "%s of %zu", CALLS[c].name, COUNTS[i]);
        }
    }
}

/* The estimates say how much, or the greatest number; they wrap nowhere. */
static void estimates_do_not_wrap(void) {
    for (size_t i = 0; i < sizeof COUNTS / sizeof *COUNTS; i++) {
        size_t n = COUNTS[i];
        EXPECT(brio_estimate_delaunay2(n, 1) >= n && brio_estimate_generate(n) >= n, "%zu", n);
        EXPECT(brio_estimate_iso_surface(n) >= n && brio_estimate_mesh_subdivide(n, 15) >= n, "%zu", n);
    }
}

SUITE(test_hostile_sizes) {
    ctx = new_context();
    RUN(counts_that_no_array_has_are_refused);
    RUN(estimates_do_not_wrap);
    brio_context_free(ctx);
    return harness_end();
}
