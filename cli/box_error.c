/* How far the cells in a box are from filling it, see box_error.h.
 *
 * A box of side 2^-400 has the volume 0 in doubles, and so have its cells. Their volumes are then computed once more with
 * all lengths times a power of two by which the box has a volume near 1: cells of such points are the same cells. */
#include "box_error.h"
#include <math.h>
#include <stdlib.h>

/* Exponents of volumes of which doubles hold a share of 2^-53 and sums of cells. */
enum { LEAST_VOLUME = -900, MOST_VOLUME = 1020 };

static bool is_held(double volume) {
    return volume > 0 && isfinite(volume) && ilogb(volume) >= LEAST_VOLUME && ilogb(volume) <= MOST_VOLUME;
}

static double error_of(const brio_cells *cells) {
    return fabs(cells->volume_sum / cells->region_volume - 1);
}

/* Returns the exponent of the power of two that makes the volume of a box about 1. */
static int exponent_of(const double box[6]) {
    int sum = 0;
    for (int k = 0; k < 3; k++) sum += ilogb(box[3 + k] / 2 - box[k] / 2) + 1;
    return -sum / 3;
}

/* Multiplies numbers by 2^exponent. Returns NULL without memory, or without numbers. */
static double *scaled(const double *x, size_t count, int exponent) {
    double *out = x ? malloc((count + 1) * sizeof *out) : NULL;
    if (!out) return NULL;
    for (size_t i = 0; i < count; i++) out[i] = ldexp(x[i], exponent);
    return out;
}

static bool are_finite(const double *x, size_t count) {
    for (size_t i = 0; i < count && x; i++)
        if (!isfinite(x[i])) return false;
    return true;
}

static brio_status scaled_error(run *r, const boxed_diagram *d, double *error) {
    brio_status status = BRIO_OK;
    brio_cells_options o = *d->options;
    brio_cells *cells = NULL;
    size_t n = d->mesh->num_vertices;
    int exponent = exponent_of(o.box);
    double *box = scaled(o.box, 6, exponent), *points = scaled(d->mesh->vertices, 3 * n, exponent);
    double *weights = scaled(d->weights, n, 2 * exponent);
    if (!box || (n && !points) || (d->weights && !weights))
        FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory: %zu scaled points", n);
    if (!are_finite(box, 6) || !are_finite(points, 3 * n) || !are_finite(weights, n)) goto done;
    o.areas = o.centroids = o.faces = o.vertices = 0;
    o.box = box;
    TRY(brio_voronoi_cells(r->ctx, d->t, points, weights, n, &o, &cells));
    *error = error_of(cells);
done:
    brio_cells_free(cells);
    free(box), free(points), free(weights);
    return status;
}

brio_status cli_box_error(run *r, const boxed_diagram *d, const brio_cells *cells, double *error) {
    *error = NAN;
    if (!is_held(cells->region_volume)) return scaled_error(r, d, error);
    *error = error_of(cells);
    return BRIO_OK;
}
