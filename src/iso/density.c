/* The surface of a molecule: an iso-surface of a sum of Gaussians.
 *
 * Each atom contributes its Gaussian less a thousandth of the level, where this is positive. Atoms are sorted into
 * cubic buckets as wide as the largest reach, so a point needs the atoms of 27 buckets only. Where atoms are far
 * apart, buckets grow until there are at most BUCKETS_AN_ATOM of them for each atom.
 *
 * Based on: Blinn. A generalization of algebraic surface drawing. ACM Transactions on Graphics 1982. */
#include "iso/density.h"
#include "iso/iso_surface.h"
#include <math.h>

enum { MOST_RESOLUTION = 1 << 15, MOST_DEFAULT_RESOLUTION = 1024, BUCKETS_AN_ATOM = 4 };

static const double NEGLIGIBLE = 1e-3; /* share of the level at which a Gaussian ends; chosen */
static const double DEFAULT_CELL = 0.5;
static const double MOST_BLOBBINESS = 100; /* chosen: e^100 is still a double, and the atoms already look like balls */

typedef struct {
    brio_atom *atoms; /* bucket by bucket */
    uint32_t *start;  /* first atom of each bucket; then the end of the last bucket */
    double low[3];    /* low corner of the box of the atoms' centres */
    double side;      /* side of a bucket */
    size_t size[3];   /* number of buckets along each axis */
    double level, blobbiness;
    double reach; /* square of the distance at which a Gaussian ends, in radii */
} density;

/* --- the field --- */

static double of_bucket(const density *d, size_t bucket, const double *p) {
    double sum = 0;
    for (uint32_t i = d->start[bucket]; i < d->start[bucket + 1]; i++) {
        const brio_atom *a = &d->atoms[i];
        double x = p[0] - a->position[0], y = p[1] - a->position[1], z = p[2] - a->position[2];
        double square = (x * x + y * y + z * z) / (a->radius * a->radius);
        if (square < d->reach) sum += exp(d->blobbiness * (1 - square)) - NEGLIGIBLE * d->level;
    }
    return sum;
}

/* Finds the buckets along an axis that can reach a coordinate: *first to *end - 1. */
static void bucket_range(const density *d, int axis, double coordinate, size_t *first, size_t *end) {
    double at = floor((coordinate - d->low[axis]) / d->side), last = (double)d->size[axis];
    *first = (size_t)fmin(fmax(at - 1, 0), last);
    *end = (size_t)fmin(fmax(at + 2, 0), last);
}

static double below_level(const double *p, const void *user) {
    const density *d = user;
    size_t first[3], end[3];
    double sum = 0;
    for (int k = 0; k < 3; k++) bucket_range(d, k, p[k], &first[k], &end[k]);
    for (size_t z = first[2]; z < end[2]; z++)
        for (size_t y = first[1]; y < end[1]; y++)
            for (size_t x = first[0]; x < end[0]; x++) sum += of_bucket(d, (z * d->size[1] + y) * d->size[0] + x, p);
    return d->level - sum;
}

/* --- buckets --- */

static size_t bucket_of(const density *d, const brio_atom *atom) {
    size_t at[3];
    for (int k = 0; k < 3; k++) {
        at[k] = (size_t)((atom->position[k] - d->low[k]) / d->side);
        if (at[k] >= d->size[k]) at[k] = d->size[k] - 1;
    }
    return (at[2] * d->size[1] + at[1]) * d->size[0] + at[0];
}

static void choose_buckets(density *d, const double *extent, double reach, size_t num_atoms) {
    double count;
    d->side = reach;
    do {
        count = 1;
        for (int k = 0; k < 3; k++) count *= floor(extent[k] / d->side) + 1;
        if (count > (double)(BUCKETS_AN_ATOM * num_atoms)) d->side *= 1.25;
    } while (count > (double)(BUCKETS_AN_ATOM * num_atoms));
    for (int k = 0; k < 3; k++) d->size[k] = (size_t)floor(extent[k] / d->side) + 1;
}

/* Sorts the atoms by bucket; keeps their order inside each bucket. */
static brio_status fill_buckets(brio_context *ctx, density *d, const brio_atom *atoms, size_t num_atoms) {
    size_t buckets = d->size[0] * d->size[1] * d->size[2];
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, d->start, buckets + 2));
    BRIO_FORWARD(BRIO_ALLOC(ctx, d->atoms, num_atoms));
    for (size_t i = 0; i < num_atoms; i++) d->start[bucket_of(d, &atoms[i]) + 2]++;
    for (size_t b = 0; b < buckets; b++) d->start[b + 2] += d->start[b + 1];
    for (size_t i = 0; i < num_atoms; i++) d->atoms[d->start[bucket_of(d, &atoms[i]) + 1]++] = atoms[i];
    return BRIO_OK;
}

/* --- all of it --- */

/* Chooses a grid round the box of the centres, with room for the reach of the largest atom. */
static brio_status choose_grid(brio_context *ctx, const density *d, const double *extent, double reach,
                               size_t resolution, brio_implicit_grid *grid) {
    double room = reach * 1.01 + 1e-9, longest = 0;
    for (int k = 0; k < 3; k++) longest = fmax(longest, extent[k] + 2 * room);
    double cells = resolution ? (double)resolution : fmin(ceil(longest / DEFAULT_CELL), MOST_DEFAULT_RESOLUTION);
    grid->cell = longest / cells;
    for (int k = 0; k < 3; k++) { /* whole cells, with equal excess on both sides */
        BRIO_FORWARD(brio_implicit_cells(ctx, ceil((extent[k] + 2 * room) / grid->cell), &grid->cells[k]));
        grid->low[k] = d->low[k] + 0.5 * (extent[k] - grid->cells[k] * grid->cell);
    }
    return BRIO_OK;
}

static brio_status check_arguments(brio_context *ctx, const density *d, size_t num_atoms, size_t resolution) {
    BRIO_EXPECT(ctx, num_atoms > 0, BRIO_ERR_ARGUMENT, "no atoms");
    BRIO_EXPECT(ctx, num_atoms < UINT32_MAX / BUCKETS_AN_ATOM, BRIO_ERR_TOO_LARGE, "%zu atoms", num_atoms);
    BRIO_EXPECT(ctx, d->level > 0 && isfinite(d->level), BRIO_ERR_ARGUMENT, "level %g: a density is positive",
                d->level);
    BRIO_EXPECT(ctx, d->blobbiness > 0 && d->blobbiness <= MOST_BLOBBINESS, BRIO_ERR_ARGUMENT,
                "blobbiness %g: expected a number above 0, up to %g", d->blobbiness, MOST_BLOBBINESS);
    BRIO_EXPECT(ctx, resolution <= MOST_RESOLUTION, BRIO_ERR_ARGUMENT, "resolution %zu: expected 0 to %d", resolution,
                MOST_RESOLUTION);
    return BRIO_OK;
}

brio_status brio_density_surface(brio_context *ctx, const brio_atom *atoms, size_t num_atoms,
                                 const brio_density_options *o, brio_mesh **out) {
    brio_status status = BRIO_OK;
    density d = {.level = o->level, .blobbiness = o->blobbiness, .low = {INFINITY, INFINITY, INFINITY}};
    brio_implicit_grid grid = {.value = below_level, .user = &d};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY}, extent[3], largest = 0;
    *out = NULL;
    BRIO_TRY(check_arguments(ctx, &d, num_atoms, o->resolution));
    for (size_t i = 0; i < num_atoms; i++) {
        largest = fmax(largest, atoms[i].radius);
        for (int k = 0; k < 3; k++) {
            d.low[k] = fmin(d.low[k], atoms[i].position[k]);
            high[k] = fmax(high[k], atoms[i].position[k]);
        }
    }
    for (int k = 0; k < 3; k++) extent[k] = high[k] - d.low[k];
    d.reach = 1 - log(NEGLIGIBLE * o->level) / o->blobbiness; /* not positive when the level is above all densities */
    double reach = sqrt(fmax(d.reach, 0.01)) * largest;
    BRIO_REQUIRE(ctx, isfinite(reach) && isfinite(extent[0] + extent[1] + extent[2]), BRIO_ERR_ARGUMENT,
                 "level %g with blobbiness %g: the atoms reach too far for a grid", o->level, o->blobbiness);
    choose_buckets(&d, extent, reach, num_atoms);
    BRIO_TRY(fill_buckets(ctx, &d, atoms, num_atoms));
    BRIO_TRY(choose_grid(ctx, &d, extent, reach, o->resolution, &grid));
    BRIO_TRY(o->conforming ? brio_conforming_surface(ctx, &grid, out) : brio_marched_surface(ctx, &grid, out));
done:
    brio_release(ctx, d.atoms);
    brio_release(ctx, d.start);
    return status;
}
