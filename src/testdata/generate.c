/* Points of well-known kinds, for tests, examples and measurements.
 *
 * The seed and i alone determine point i, for every number of threads and, except of grids and frames, for every n. The
 * round kinds use rejection and square roots and no other function of the mathematical library, so their numbers are
 * equal on every machine.
 *
 * Based on: Marsaglia. Choosing a point from the surface of a sphere. Annals of Mathematical Statistics 1972. */
#include "brio/testdata.h"
#include "base/float_state.h"
#include "base/versioned.h"
#include "base/rng.h"
#include "base/team.h"
#include "iso/iso_surface.h"
#include "testdata/scan.h"
#include "testdata/sculpture.h"
#include <math.h>

static const size_t MOST_POINTS = (size_t)1 << 48;
static const size_t BATCH = (size_t)1 << 18; /* points between two reports of progress */

enum {
    DEFAULT_RESOLUTION = 160,
    LEAST_RESOLUTION = 4, /* no node of the grids of 1 to 3 cells is inside the sculpture: their surfaces are empty */
    MOST_RESOLUTION = 1 << 15,
    POINTS_A_THREAD = 1 << 10,
    CLUSTERS = 256,
    VIEWS = 12,
    EXPONENT_DIGITS = 20 /* binary digits of the exponent of a cluster's radius */
};

static const double NOISE = 0.05; /* of a scan, and VIEWS: what 0 stands for */
static const double TORUS_MAJOR = 1, TORUS_MINOR = 0.4, CYLINDER_HEIGHT = 4;
static const double LARGEST_CLUSTER = 0.1,
                    CLUSTER_RANGE = 1e-6; /* largest radius, and the least radius as a share of the largest */

/* --- one point of a kind --- */

static double symmetric(brio_rng *rng) {
    return 2 * brio_rng_double(rng) - 1;
}

static void point_of_cube(brio_rng *rng, double *p) {
    for (int k = 0; k < 3; k++) p[k] = brio_rng_double(rng);
}

static void point_of_ball(brio_rng *rng, double *p) {
    do {
        for (int k = 0; k < 3; k++) p[k] = symmetric(rng);
    } while (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] > 1);
}

static void point_of_sphere(brio_rng *rng, double *p) {
    double x, y, square;
    do {
        x = symmetric(rng);
        y = symmetric(rng);
        square = x * x + y * y;
    } while (square >= 1);
    double scale = 2 * sqrt(1 - square);
    p[0] = x * scale;
    p[1] = y * scale;
    p[2] = 1 - 2 * square;
}

/* Draws a uniform direction in the plane. */
static void direction(brio_rng *rng, double *cosine, double *sine) {
    double x, y, square;
    do {
        x = symmetric(rng);
        y = symmetric(rng);
        square = x * x + y * y;
    } while (square > 1 || square < 0x1p-40);
    *cosine = x / sqrt(square);
    *sine = y / sqrt(square);
}

/* Draws a point of the torus. Its area element is proportional to the distance from its axis, so points nearer to the
 * axis are rejected more often. */
static void point_of_torus(brio_rng *rng, double *p) {
    double c, s, radius;
    do {
        direction(rng, &c, &s);
        radius = TORUS_MAJOR + TORUS_MINOR * c;
    } while (brio_rng_double(rng) * (TORUS_MAJOR + TORUS_MINOR) > radius);
    p[2] = TORUS_MINOR * s;
    direction(rng, &c, &s);
    p[0] = radius * c;
    p[1] = radius * s;
}

static void point_of_cylinder(brio_rng *rng, double *p) {
    direction(rng, &p[0], &p[1]);
    p[2] = CYLINDER_HEIGHT * (brio_rng_double(rng) - 0.5);
}

/* Returns LARGEST_CLUSTER times CLUSTER_RANGE to a power uniform in [0, 1). Each binary digit of the power decides
 * whether one more square root is multiplied in. pow would need one step, but its bits differ between machines. */
static double cluster_radius(brio_rng *rng) {
    double radius = LARGEST_CLUSTER, root = CLUSTER_RANGE;
    for (int digit = 0; digit < EXPONENT_DIGITS; digit++) {
        root = sqrt(root);
        if (brio_rng_next(rng) & 1) radius *= root;
    }
    return radius;
}

static void point_of_clusters(brio_rng *rng, uint64_t seed, double *p) {
    brio_rng cluster = brio_rng_new(brio_mix(~seed) + brio_rng_below(rng, CLUSTERS));
    double centre[3], radius;
    point_of_cube(&cluster, centre);
    radius = cluster_radius(&cluster);
    point_of_ball(rng, p);
    for (int k = 0; k < 3; k++) p[k] = centre[k] + radius * p[k];
}

static void point_of_moment(brio_rng *rng, double *p) {
    double t = brio_rng_double(rng);
    p[0] = t;
    p[1] = t * t;
    p[2] = t * t * t;
}

static void random_point(brio_kind kind, uint64_t seed, size_t i, double *p) {
    brio_rng rng = brio_rng_new(brio_mix(seed) + i);
    switch (kind) {
    case BRIO_KIND_CUBE:
        point_of_cube(&rng, p);
        break;
    case BRIO_KIND_BALL:
        point_of_ball(&rng, p);
        break;
    case BRIO_KIND_SPHERE:
        point_of_sphere(&rng, p);
        break;
    case BRIO_KIND_TORUS:
        point_of_torus(&rng, p);
        break;
    case BRIO_KIND_CYLINDER:
        point_of_cylinder(&rng, p);
        break;
    case BRIO_KIND_CLUSTERS:
        point_of_clusters(&rng, seed, p);
        break;
    case BRIO_KIND_MOMENT:
        point_of_moment(&rng, p);
        break;
    case BRIO_KIND_GRID:
    case BRIO_KIND_DEPTH:
    case BRIO_KIND_SCAN:
    case BRIO_KIND_END:
        break;
    }
}

/* --- all points --- */

static size_t grid_side(size_t n) {
    size_t side = 1;
    while (side * side * side < n) side++;
    return side;
}

static void grid_point(size_t side, size_t i, double *p) {
    size_t layer = i / (side * side);
    p[0] = (double)layer;
    p[1] = (double)(i / side % side);
    p[2] = (double)(i % side);
}

typedef struct {
    brio_kind kind;
    uint64_t seed;
    size_t side; /* of the grid */
    brio_depth_frame frame;
    size_t start; /* first point of the batch in work */
    double *points;
} generator;

/* Makes points start + begin to start + end - 1. */
static void make_points(void *user, size_t begin, size_t end, int thread) {
    const generator *g = user;
    (void)thread;
    for (size_t i = g->start + begin; i < g->start + end; i++) {
        if (g->kind == BRIO_KIND_GRID)
            grid_point(g->side, i, g->points + 3 * i);
        else if (g->kind == BRIO_KIND_DEPTH)
            brio_depth_point(&g->frame, i, g->points + 3 * i);
        else
            random_point(g->kind, g->seed, i, g->points + 3 * i);
    }
}

static brio_status fill(brio_context *ctx, brio_kind kind, uint64_t seed, brio_mesh *mesh) {
    size_t n = mesh->num_vertices;
    generator g = {.kind = kind, .seed = seed, .points = mesh->vertices};
    if (kind == BRIO_KIND_GRID) g.side = grid_side(n);
    if (kind == BRIO_KIND_DEPTH) g.frame = brio_depth_frame_of(n, seed);
    for (; g.start < n; g.start += BATCH) {
        size_t count = n - g.start < BATCH ? n - g.start : BATCH;
        BRIO_FORWARD(brio_progress(ctx, "generate", (double)g.start / (double)n));
        BRIO_FORWARD(brio_for(ctx, brio_threads(ctx, count, POINTS_A_THREAD), count, make_points, &g));
    }
    return brio_progress(ctx, "generate", 1);
}

/* Fills in the defaults. */
static void settle(brio_generate_options *o) {
    if (!o->seed) o->seed = BRIO_SEED;
    if (o->noise == 0) o->noise = NOISE;
    if (o->noise < 0) o->noise = 0;
    if (!o->views) o->views = VIEWS;
}

static brio_status check_options(brio_context *ctx, const brio_generate_options *options) {
    BRIO_EXPECT(ctx, isfinite(options->noise), BRIO_ERR_ARGUMENT, "noise %g: expected a finite number", options->noise);
    BRIO_EXPECT(ctx, options->views >= 1 && options->views <= UINT16_MAX, BRIO_ERR_ARGUMENT,
                "%d views: expected 1 to %d", options->views, UINT16_MAX);
    return BRIO_OK;
}

brio_status brio_generate(brio_context *ctx, brio_kind kind, size_t n, const brio_generate_options *options,
                          brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_generate_options o = {0};
    brio_mesh *mesh = NULL;
    *out = NULL;
    BRIO_REQUIRE(ctx, (unsigned)kind < BRIO_KIND_END, BRIO_ERR_ARGUMENT, "there is no kind %d of points", (int)kind);
    BRIO_REQUIRE(ctx, n <= MOST_POINTS, BRIO_ERR_NO_MEMORY, "out of memory: %zu points", n);
    BRIO_TRY(BRIO_TAKE(ctx, brio_generate_options, options, &o));
    settle(&o);
    BRIO_TRY(check_options(ctx, &o));
    if (kind == BRIO_KIND_SCAN) return brio_scan(ctx, n, &o, out);
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(brio_mesh_set_vertices(mesh, NULL, n));
    BRIO_TRY(fill(ctx, kind, o.seed, mesh));
    *out = mesh;
    mesh = NULL;
done:
    brio_mesh_free(mesh);
    return status;
}

brio_status brio_generate_truth(brio_context *ctx, size_t resolution, brio_mesh **out) {
    BRIO_DOOR;
    brio_implicit_grid grid = {.value = brio_sculpture};
    double low[3], high[3], side = 0;
    *out = NULL;
    BRIO_EXPECT(ctx, !resolution || (resolution >= LEAST_RESOLUTION && resolution <= MOST_RESOLUTION),
                BRIO_ERR_ARGUMENT, "resolution %zu: expected %d to %d, or 0 for %d", resolution, LEAST_RESOLUTION,
                MOST_RESOLUTION, DEFAULT_RESOLUTION);
    brio_sculpture_box(low, high);
    for (int k = 0; k < 3; k++) side = fmax(side, high[k] - low[k]);
    grid.cell = side / (double)(resolution ? resolution : DEFAULT_RESOLUTION);
    for (int k = 0; k < 3; k++) { /* whole cells, with equal excess on both sides */
        BRIO_FORWARD(brio_implicit_cells(ctx, ceil((high[k] - low[k]) / grid.cell), &grid.cells[k]));
        grid.low[k] = 0.5 * (low[k] + high[k] - grid.cells[k] * grid.cell);
    }
    return brio_marched_surface(ctx, &grid, out);
}

uint64_t brio_estimate_generate(size_t num_points) {
    BRIO_DOOR;
    return num_points < UINT64_MAX / 24 ? 24 * (uint64_t)num_points : UINT64_MAX; /* three coordinates */
}
