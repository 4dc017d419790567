/* Random closed solids.
 *
 * A solid is a tree of shapes, drawn from the seed. Its features are drawn in units of the spacing of a sampling. A
 * coarse mesh gives the area and so the spacing; the tree is built again with that spacing, until both agree. Then the
 * solid is checked. Few places may be thinner than LEAST_THICKNESS; and the level sets a little outside and a little
 * inside must have the surface's Euler characteristic, so that no gap is nearly closed and no bar nearly cut. A solid
 * that fails is dropped, and the next one is drawn, of the same family, so that families that often fail are not rare.
 *
 * The good solid is meshed finely, its crumbs are dropped, its sharp edges are recovered, and it is scaled. The checks
 * do not depend on the resolution that is asked for, so the seed alone determines the solid. */
#include "brio/testdata.h"
#include "base/float_state.h"
#include "base/vector.h"
#include "iso/dual_optimize.h"
#include "mesh/simplify.h"
#include "testdata/csg_blocks.h"
#include "testdata/solid_levels.h"
#include "testdata/solid_maker.h"
#include "testdata/solid_parts.h"
#include <math.h>

/* All chosen. The default resolution and that of the check show walls of 1.6 spacings with 2.5 and 3 cells. */
enum {
    DEFAULT_RESOLUTION = 144,
    LEAST_RESOLUTION = 16,
    MOST_RESOLUTION = 1 << 10,
    COARSE_RESOLUTION = 80,
    PROBE_RESOLUTION = 96, /* of the space in which the solid is looked for */
    MOST_ATTEMPTS = 64,
    ATTEMPTS_A_FAMILY = 8,
    CHECK_RESOLUTION = 192,
    MOST_BUILDS = 4,    /* of a tree, each with the spacing of the one before */
    OPTIMIZE_ROUNDS = 2 /* each time */
};

static const double SPACE = 1.2;                           /* solids lie in [-SPACE, SPACE]^3 */
static const double FIRST_SPACING = 0.0085;                /* that of a body of area 1.25 */
static const double SAMPLES = 20000, AREA_A_SAMPLE = 1.15; /* an even sampling has this spacing squared for a sample */
/* Chosen. */
static const double LEAST_THICKNESS = 1.2; /* in spacings */
static const double MOST_THIN = 0.002;     /* share of vertices at thinner places: tips and creases have some */
static const double LEVEL = 0.4;           /* in spacings, of the level sets that must have the same topology */
static const double LEAST_SPACING = 0.0025, SAME_SPACING = 0.1; /* least spacing of a solid; spacings about equal */
static const double CRUMB = 6;                                  /* least diagonal of a part, in spacings */
static const double KEPT = 0.3;                     /* share of triangles that are kept when short edges collapse */
static const double LONGEST = 1.2, TOLERANCE = 0.3; /* of edges that collapse, and of the error, in cells */
static const double MANY_PARTS = 0.2; /* share of solids that may have several parts, where the family does not say */
static const double CHOICE_SHARE = 0.5,
                    STEP_SHARE = 0.2; /* of the progress bar: of the choice, of a step in what is left */
static const double VOIDS = 0.1;      /* share of solids that keep voids */

typedef struct {
    brio_context *ctx;
    brio_bar bar;
    double done, end; /* shares of the progress bar: of the steps so far, of all steps of this phase */
    brio_solid_kind kind;
    uint64_t seed, family; /* of the attempt */
    brio_csg *tree;
    double spacing;         /* of a sampling of the solid */
    double low[3], high[3]; /* a box that contains the solid */
    brio_solid_parts keep;
} solid;

/* Gives the next step its part of the progress bar: a share of what is left before s->end. */
static void next_step(solid *s) {
    double to = s->done + STEP_SHARE * (s->end - s->done);
    brio_progress_part(s->ctx, s->bar, s->done, to);
    s->done = to;
}

/* --- meshes --- */

static brio_status make_grid(const solid *s, size_t resolution, brio_implicit_grid *grid) {
    double side = 0;
    *grid = (brio_implicit_grid){0};
    for (int k = 0; k < 3; k++) side = fmax(side, s->high[k] - s->low[k]);
    grid->cell = side / (double)resolution;
    for (int k = 0; k < 3; k++) { /* two cells of room on either side */
        BRIO_FORWARD(brio_implicit_cells(s->ctx, ceil((s->high[k] - s->low[k]) / grid->cell) + 4, &grid->cells[k]));
        grid->low[k] = 0.5 * (s->low[k] + s->high[k] - grid->cells[k] * grid->cell);
    }
    return BRIO_OK;
}

static brio_status make_blocks(const solid *s, brio_implicit_grid *grid, brio_csg_blocks *blocks) {
    grid->value = brio_csg_blocks_value;
    grid->user = blocks;
    return brio_csg_blocks_make(s->ctx, s->tree, grid, blocks);
}

/* Makes a mesh of the solid. `blocks` receives the values that the grid refers to. */
static brio_status make_mesh(solid *s, size_t resolution, brio_implicit_grid *grid, brio_csg_blocks *blocks,
                             brio_mesh **out) {
    BRIO_FORWARD(make_grid(s, resolution, grid));
    next_step(s);
    BRIO_FORWARD(make_blocks(s, grid, blocks));
    next_step(s);
    return brio_marched_surface(s->ctx, grid, out);
}

/* --- choice of a solid --- */

static void build(solid *s) {
    brio_solid_maker m = {s->tree, brio_rng_new(s->seed), s->spacing, s->family, 1};
    brio_csg_clear(s->tree);
    s->keep = (brio_solid_parts){.least = CRUMB * s->spacing};
    s->keep.voids = brio_solid_chance(&m, VOIDS);
    m.parts = brio_solid_chance(&m, MANY_PARTS) ? BRIO_SOLID_MOST_PARTS : 1;
    if (s->kind == BRIO_SOLID_IMPLICIT)
        brio_solid_implicit(&m);
    else
        brio_solid_machined(&m);
    s->keep.most = m.parts;
}

/* Finds a box that contains the solid, from the values at the centres of blocks. */
static brio_status find_box(solid *s) {
    brio_status status = BRIO_OK;
    brio_csg_blocks b = {0};
    brio_implicit_grid grid = {.cell = 2 * SPACE / PROBE_RESOLUTION, .low = {-SPACE, -SPACE, -SPACE}};
    for (int k = 0; k < 3; k++) {
        grid.cells[k] = PROBE_RESOLUTION;
        s->low[k] = SPACE;
        s->high[k] = -SPACE;
    }
    next_step(s);
    BRIO_TRY(brio_csg_blocks_find(s->ctx, s->tree, &grid, &b));
    for (size_t i = 0; i < (size_t)b.count[0] * b.count[1] * b.count[2]; i++) {
        size_t index[3] = {i % b.count[0], i / b.count[0] % b.count[1], i / b.count[0] / b.count[1]};
        if (b.slot[i] == BRIO_CSG_FAR && b.centre[i] > 0) continue;
        for (int k = 0; k < 3; k++) {
            s->low[k] = fmin(s->low[k], b.low[k] + (double)index[k] * b.side);
            s->high[k] = fmax(s->high[k], b.low[k] + ((double)index[k] + 1) * b.side);
        }
    }
done:
    brio_csg_blocks_free(s->ctx, &b);
    return status;
}

/* Meshes the solid coarsely. Writes the spacing of its samples, 0 if it is no solid at all, and the share of its thin
 * places, which takes most of the time, if the solid was built for about this spacing. */
static brio_status measure(solid *s, double *spacing, double *thin) {
    brio_status status = BRIO_OK;
    brio_csg_blocks blocks = {0};
    brio_implicit_grid grid;
    brio_mesh *mesh = NULL;
    *spacing = *thin = 0;
    BRIO_TRY(find_box(s));
    if (!(s->low[0] < s->high[0])) return BRIO_OK;
    BRIO_TRY(make_mesh(s, COARSE_RESOLUTION, &grid, &blocks, &mesh));
    brio_solid_box_of(mesh, s->low, s->high);
    for (int k = 0; k < 3; k++) { /* a tip may end within a cell */
        s->low[k] -= grid.cell;
        s->high[k] += grid.cell;
    }
    BRIO_TRY(brio_solid_keep_parts(s->ctx, mesh, &s->keep));
    *spacing = sqrt(AREA_A_SAMPLE * brio_solid_area(mesh) / SAMPLES);
    if (fabs(*spacing / s->spacing - 1) <= 2 * SAME_SPACING)
        BRIO_TRY(brio_solid_thin_share(s->ctx, &grid, mesh, LEAST_THICKNESS * *spacing, thin));
done:
    brio_csg_blocks_free(s->ctx, &blocks);
    brio_mesh_free(mesh);
    return status;
}

/* Finds out whether the solid a little thicker and a little thinner has the same topology: then no gap, tunnel, wall or
 * bar is nearly closed or nearly cut. */
static brio_status check_topology(solid *s, bool *same) {
    brio_status status = BRIO_OK;
    brio_csg_blocks blocks = {0};
    brio_implicit_grid grid;
    double step = LEVEL * s->spacing, levels[BRIO_SOLID_LEVELS] = {-step, 0, step};
    int64_t euler[BRIO_SOLID_LEVELS];
    BRIO_TRY(make_grid(s, CHECK_RESOLUTION, &grid));
    next_step(s);
    BRIO_TRY(make_blocks(s, &grid, &blocks));
    next_step(s);
    BRIO_TRY(brio_solid_euler(s->ctx, &grid, levels, euler));
    *same = euler[0] == euler[1] && euler[1] == euler[2];
done:
    brio_csg_blocks_free(s->ctx, &blocks);
    return status;
}

/* Builds the solid of one attempt. Its sizes are in spacings of its own samples. *good tells whether to keep it. */
static brio_status try_solid(solid *s, bool *good) {
    double spacing = FIRST_SPACING, thin = 0;
    *good = false;
    for (int i = 0; i < MOST_BUILDS && fabs(spacing / s->spacing - 1) > SAME_SPACING; i++) {
        s->spacing = spacing;
        build(s);
        if (s->tree->full) return BRIO_OK;
        BRIO_FORWARD(measure(s, &spacing, &thin));
        if (spacing < LEAST_SPACING) return BRIO_OK;
    }
    if (fabs(spacing / s->spacing - 1) > 2 * SAME_SPACING || thin > MOST_THIN) return BRIO_OK;
    return check_topology(s, good);
}

/* Draws solids until one is good. The last one is taken as it is. */
static brio_status choose_solid(solid *s, uint64_t seed) {
    bool good = false;
    for (uint64_t attempt = 0; attempt < MOST_ATTEMPTS && !good; attempt++) {
        s->seed = brio_hash(brio_mix(seed) + (uint64_t)s->kind, attempt);
        s->family = brio_mix(~seed) + attempt / ATTEMPTS_A_FAMILY;
        s->spacing = INFINITY;
        BRIO_FORWARD(try_solid(s, &good));
    }
    return BRIO_OK;
}

/* --- the result --- */

static void scale_to_diagonal_1(brio_mesh *mesh) {
    double low[3], high[3];
    brio_solid_box_of(mesh, low, high);
    double diagonal = sqrt(brio_square_distance(low, high));
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++)
        mesh->vertices[i] = (mesh->vertices[i] - 0.5 * (low[i % 3] + high[i % 3])) / diagonal;
}

/* Collapses short edges: marching tetrahedra make three times the triangles that the grid needs. On edges and corners
 * that are sharp already, the collapses that keep them sharp cost least. */
static brio_status collapse_short_edges(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    double *spacing = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, spacing, mesh->num_vertices));
    for (size_t v = 0; v < mesh->num_vertices; v++) spacing[v] = grid->cell;
    brio_collapse_options options = {.target_faces = (size_t)((double)mesh->num_faces * KEPT),
                                     .spacing = spacing,
                                     .longest = LONGEST,
                                     .tolerance = TOLERANCE};
    BRIO_TRY(brio_collapse_edges(ctx, mesh, &options));
done:
    brio_release(ctx, spacing);
    return status;
}

static brio_status make_result(solid *s, size_t resolution, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_csg_blocks blocks = {0};
    brio_implicit_grid grid;
    BRIO_TRY(make_mesh(s, resolution, &grid, &blocks, out));
    BRIO_TRY(brio_solid_keep_parts(s->ctx, *out, &s->keep));
    BRIO_REQUIRE(s->ctx, (*out)->num_faces, BRIO_ERR_NO_ANSWER, "at this resolution nothing of the solid is left");
    next_step(s);
    BRIO_TRY(brio_dual_optimize(s->ctx, &grid, *out, OPTIMIZE_ROUNDS));
    next_step(s);
    BRIO_TRY(collapse_short_edges(s->ctx, &grid, *out));
    next_step(s);
    BRIO_TRY(brio_dual_optimize(s->ctx, &grid, *out, OPTIMIZE_ROUNDS));
    scale_to_diagonal_1(*out);
    brio_progress_part(s->ctx, s->bar, 0, 1);
    BRIO_TRY(brio_progress(s->ctx, "optimize", 1));
done:
    brio_csg_blocks_free(s->ctx, &blocks);
    if (status != BRIO_OK) {
        brio_mesh_free(*out);
        *out = NULL;
    }
    return status;
}

brio_status brio_generate_solid(brio_context *ctx, brio_solid_kind kind, uint64_t seed, size_t resolution,
                                brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    solid s = {.ctx = ctx, .bar = brio_progress_bar(ctx), .kind = kind};
    *out = NULL;
    BRIO_REQUIRE(ctx, (unsigned)kind < BRIO_SOLID_END, BRIO_ERR_ARGUMENT, "there is no kind %d of solids", (int)kind);
    BRIO_REQUIRE(ctx, !resolution || (resolution >= LEAST_RESOLUTION && resolution <= MOST_RESOLUTION),
                 BRIO_ERR_ARGUMENT, "resolution %zu: expected 0, or %d to %d", resolution, LEAST_RESOLUTION,
                 MOST_RESOLUTION);
    BRIO_TRY(BRIO_ALLOC(ctx, s.tree, 1));
    s.end = CHOICE_SHARE;
    BRIO_TRY(choose_solid(&s, seed));
    s.end = 1;
    BRIO_TRY(make_result(&s, resolution ? resolution : DEFAULT_RESOLUTION, out));
done:
    brio_progress_part(ctx, s.bar, 0, 1);
    brio_release(ctx, s.tree);
    return status;
}
