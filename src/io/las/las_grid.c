/* Finds scale and offset for the coordinates of a LAS file.
 *
 * A grid is accepted if for every coordinate x the nearest whole number n gives x = n * step + origin in doubles, the
 * way a reader computes it. Most grids that do not fit fail at one of the first points, or at one of the witnesses: a
 * candidate that fails behind the first block costs another pass. */
#include "io/las/las_grid.h"
#include "base/memory.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* Powers of 1/10 and of 1/2 that are tried: a nanometre, and the last bits of singles near 1. ORIGINS: whole numbers
 * within the range that are tried as origins of the first COARSE decimals. MOST_PASSES: after these, coordinates are
 * rounded. WITNESSES_A_BLOCK: points of a block that become witnesses. All chosen. */
enum { DECIMALS = 9, HALVES = 24, ORIGINS = 1024, COARSE = 4, MOST_PASSES = 16, WITNESSES_A_BLOCK = 16 };

static const double tenths[] = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9};

static double number_of(double x, double step, double origin) {
    return rint((x - origin) / step);
}

/* Returns whether an axis' candidate gives back coordinates. */
static bool gives_back(const brio_las_grid *g, int axis, const double *points, size_t count) {
    double step = g->step[axis], origin = g->origin[axis];
    if (!(step != 0) || !isfinite(step) || !isfinite(origin)) return false;
    for (size_t v = 0; v < count; v++) {
        double x = points[3 * v + (size_t)axis], n = number_of(x, step, origin);
        if (!(n >= INT32_MIN && n <= INT32_MAX) || n * step + origin != x) return false;
    }
    return true;
}

/* --- candidates --- */

/* Sets whole numbers within the range as origins. Near an origin products with the step are small, so their sums with
 * the origin round to the double nearest to the decimal number. The doubles of most texts are such. */
static bool set_origin(brio_las_grid *g, int axis, size_t which) {
    double low = g->low[axis], high = g->high[axis], first = floor(low), count = ceil(high) - first;
    if (!(count > 0 && fabs(low) + fabs(high) < 0x1p53)) return false;
    double stride = count > ORIGINS ? ceil(count / ORIGINS) : 1;
    size_t origins = (size_t)((high - first) / stride) + 1, decimals = which / origins;
    if (decimals > COARSE) return false;
    g->step[axis] = tenths[decimals];
    g->origin[axis] = first + (double)(which % origins) * stride;
    return true;
}

/* Sets the candidate of an axis by its number. Returns false behind the last one. */
static bool set_candidate(brio_las_grid *g, int axis) {
    const double origins[] = {0, floor(g->low[axis])};
    size_t which = g->candidate[axis] - 1;
    if (which < 2 * (DECIMALS + 1)) {
        g->step[axis] = tenths[which % (DECIMALS + 1)];
        g->origin[axis] = origins[which / (DECIMALS + 1)];
        return true;
    }
    which -= 2 * (DECIMALS + 1);
    if (which < 2 * HALVES) {
        g->step[axis] = ldexp(1, -(int)(which % HALVES) - 1);
        g->origin[axis] = origins[which / HALVES];
        return true;
    }
    return set_origin(g, axis, which - 2 * HALVES);
}

/* Returns the least power of ten by which half the width of an axis is a whole number of 32 bits. Below the powers of ten
 * that doubles hold well it is the least double, or that times a power of two. */
static double rounding_step(double half) {
    double step = pow(10, ceil(log10(half / (INT32_MAX - 1))));
    if (!(step > 0)) step = DBL_TRUE_MIN;
    while (half / step > INT32_MAX) step *= 2;
    return step;
}

/* Takes a grid on which coordinates are rounded. The least double as step rounds nothing. */
static void round_axis(brio_las_grid *g, int axis) {
    double low = g->low[axis], high = g->high[axis];
    double half = isfinite(high - low) ? (high - low) / 2 : high / 2 - low / 2;
    g->origin[axis] = low / 2 + high / 2;
    g->step[axis] = high > low ? rounding_step(half) : 1;
    g->found[axis] = true;
    g->rounds[axis] = g->step[axis] > DBL_TRUE_MIN;
}

/* Goes on to the next candidate that gives back the witnesses. */
static void next_candidate(brio_las_grid *g, int axis) {
    do {
        g->candidate[axis]++;
        if (set_candidate(g, axis)) continue;
        round_axis(g, axis);
        return;
    } while (!gives_back(g, axis, *g->witnesses, g->num_witnesses));
}

/* --- passes --- */

static void take_box(brio_las_grid *g, const brio_mesh *block) {
    for (size_t v = 0; v < block->num_vertices; v++)
        for (int k = 0; k < 3; k++) {
            double x = block->vertices[3 * v + (size_t)k];
            bool first = v == 0 && g->points == 0;
            if (first || x < g->low[k]) g->low[k] = x;
            if (first || x > g->high[k]) g->high[k] = x;
        }
    g->points += block->num_vertices;
}

static void take_witnesses(brio_las_grid *g, const brio_mesh *block) {
    size_t stride = block->num_vertices / WITNESSES_A_BLOCK + 1;
    for (size_t v = 0; v < block->num_vertices && g->num_witnesses < BRIO_LAS_WITNESSES; v += stride)
        memcpy(g->witnesses[g->num_witnesses++], block->vertices + 3 * v, sizeof *g->witnesses);
}

/* The first pass: `failed` says whether the source's grid failed anywhere. */
static void try_source(brio_las_grid *g, int axis, const brio_mesh *block) {
    if (!g->begun) {
        g->step[axis] = block->coordinate_step[axis];
        g->origin[axis] = block->coordinate_origin[axis];
    }
    if (!g->failed[axis]) g->failed[axis] = !gives_back(g, axis, block->vertices, block->num_vertices);
}

static void try_candidates(brio_las_grid *g, int axis, const brio_mesh *block) {
    while (!g->found[axis] && !gives_back(g, axis, block->vertices, block->num_vertices)) {
        next_candidate(g, axis);
        g->failed[axis] |= g->begun;
    }
}

brio_status brio_las_grid_survey(brio_context *ctx, brio_las_grid *g, const brio_mesh *block) {
    brio_status status = BRIO_OK;
    if (!g->witnesses) BRIO_TRY(BRIO_ALLOC(ctx, g->witnesses, BRIO_LAS_WITNESSES));
    if (g->pass == 0) {
        take_box(g, block);
        take_witnesses(g, block);
    }
    for (int k = 0; k < 3; k++) {
        if (g->pass == 0)
            try_source(g, k, block);
        else
            try_candidates(g, k, block);
    }
    g->begun = true;
done:
    return status;
}

bool brio_las_grid_end_pass(brio_las_grid *g) {
    g->pass++;
    g->begun = false;
    for (int k = 0; k < 3; k++) {
        if (!g->failed[k]) g->found[k] = true;
        if (!g->found[k] && g->pass == 1) next_candidate(g, k);
        if (!g->found[k] && g->pass == MOST_PASSES) round_axis(g, k);
        g->failed[k] = false;
    }
    return g->found[0] && g->found[1] && g->found[2];
}

void brio_las_grid_free(brio_context *ctx, brio_las_grid *g) {
    brio_release(ctx, g->witnesses);
    g->witnesses = NULL;
}

/* A whole step beside the largest double can lead to infinity: then the number nearer to the origin is taken. */
int32_t brio_las_grid_number(const brio_las_grid *g, int axis, double x) {
    double step = g->step[axis], origin = g->origin[axis], n = number_of(x, step, origin);
    if (!isfinite(n * step + origin)) n -= copysign(1, n);
    return n <= INT32_MIN ? INT32_MIN : n >= INT32_MAX ? INT32_MAX : (int32_t)n;
}

double brio_las_grid_moved(const brio_las_grid *grid, const brio_mesh *m) {
    double most = 0;
    for (size_t v = 0; v < m->num_vertices; v++) {
        double by[3];
        for (int k = 0; k < 3; k++) {
            double x = m->vertices[3 * v + (size_t)k];
            by[k] = x - (brio_las_grid_number(grid, k, x) * grid->step[k] + grid->origin[k]);
        }
        if (by[0] != 0 || by[1] != 0 || by[2] != 0) most = fmax(most, hypot(by[0], hypot(by[1], by[2])));
    }
    return most;
}
