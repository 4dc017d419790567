/* Memory estimates.
 *
 * The constants are those of the data structures or measured, as said beside them; measurement adjusts them here, or in
 * the table of methods for surfaces, and nowhere else. docs/measured/performance.md compares the estimates with the
 * peaks of many inputs. An input that no estimate foresees meets the memory limit of the context, which refuses memory
 * while the work runs. */
#include "base/float_state.h"
#include "base/versioned.h"
#include "estimate/triangulation_size.h"
#include "order/canonical_points.h"
#include "periodic/periodic.h"
#include "reconstruct/surface/method.h"
#include "triangulation/insertion_part.h"
#include "triangulation/triangulation.h"
#include <math.h>

/* While points are inserted: record, index in the input, representative, number in the cavity. */
static const double INSERT_BYTES_A_POINT = 41, INSERT_BYTES_A_TETRAHEDRON = 33;
static const double SEQUENCE_BYTES_A_POINT = 4; /* more, with weights */
/* Then, where points are hidden, what finds the vertices that represent them (autzen and csite4: 32). */
static const double BYTES_A_HIDDEN_POINT = 32;
/* While the result is sorted: index, representative and two buckets; two numbers a tetrahedron. */
static const double SORT_BYTES_A_POINT = 16, SORT_BYTES_A_TETRAHEDRON = 41;
/* With threads: the rank on the curve, and at most a sixteenth of the result moved at a time, with the lists for it. */
static const double THREADS_BYTES_A_POINT = 4, THREADS_BYTES_A_TETRAHEDRON = 1.25;
/* In the plane: record, index in the input, representative, two triangles; with weights two marks, a triangle of each
 * vertex and a list of the points that may be hidden. */
static const double PLANE_BYTES_A_POINT = 88, PLANE_BYTES_A_WEIGHT = 10;

/* In space that repeats: a translate with its position; a point in the domain and the shift to it. Measured. Classes
 * take the place of the tetrahedra, with less beside them than the sort has. */
static const double IMAGE_BYTES = 60, HOME_BYTES_A_POINT = 36;

static const double SUBDIVIDE_BYTES_A_FACE = 76; /* of the result, a certificate included */
static const double ISO_BYTES_A_VERTEX = 71;

/* Returns a number of bytes as an integer, the greatest integer for larger numbers. */
static uint64_t bytes_of(double bytes) {
    return bytes < 0x1p64 ? (uint64_t)bytes : UINT64_MAX;
}

/* Returns the bytes of the sequence by weights, which an experiment may have no use for. */
static double sequence_bytes(const brio_context *ctx, double points, const brio_delaunay_options *o) {
    const struct brio_insertion_part *part = BRIO_PART(ctx, insertion);
    bool made = o->order == BRIO_ORDER_BRIO && !BRIO_PART(ctx, order) && (!part || part->walks);
    return made ? SEQUENCE_BYTES_A_POINT * points : 0;
}

static double delaunay_bytes(double points, const brio_triangulation_size *size, double sequence, bool threads) {
    double insert = sequence + INSERT_BYTES_A_POINT * points + INSERT_BYTES_A_TETRAHEDRON * size->tetrahedra +
                    BYTES_A_HIDDEN_POINT * size->hidden;
    double sort = SORT_BYTES_A_POINT * points + SORT_BYTES_A_TETRAHEDRON * size->tetrahedra;
    if (threads) sort += THREADS_BYTES_A_TETRAHEDRON * size->tetrahedra;
    return fmax(insert, sort) + (threads ? THREADS_BYTES_A_POINT * points : 0);
}

brio_status brio_estimate_delaunay(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const brio_delaunay_options *options, uint64_t *bytes) {
    BRIO_DOOR;
    brio_delaunay_options o = {0};
    brio_triangulation_size size = {0};
    *bytes = 0;
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_delaunay_options, options, &o));
    BRIO_FORWARD(brio_delaunay_begin(ctx, num_points, &o));
    BRIO_FORWARD(brio_refuse_points(ctx, points, num_points));
    BRIO_FORWARD(brio_estimate_size(ctx, points, weights, num_points, &size));
    const struct brio_insertion_part *part = BRIO_PART(ctx, insertion);
    double n = (double)num_points;
    double sequence = weights ? sequence_bytes(ctx, n, &o) : 0;
    double location = part ? part->bytes(part->user, n) : 0;
    *bytes = bytes_of(delaunay_bytes(n, &size, sequence, brio_context_threads(ctx) > 1) + location);
    return BRIO_OK;
}

brio_status brio_estimate_periodic(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const brio_periodic_options *options, uint64_t *bytes) {
    BRIO_DOOR;
    brio_triangulation_size size = {0};
    double images = 0, n = (double)num_points;
    *bytes = 0;
    BRIO_FORWARD(brio_refuse_points(ctx, points, num_points));
    BRIO_FORWARD(brio_periodic_count(ctx, points, num_points, options, &images));
    BRIO_FORWARD(brio_estimate_size(ctx, points, weights, num_points, &size));
    double share = n > 0 ? images / n : 0;
    const brio_triangulation_size all = {share * size.tetrahedra, share * size.hidden};
    double image = IMAGE_BYTES + (weights ? sizeof(double) : 0);
    double work =
        delaunay_bytes(images, &all, weights ? SEQUENCE_BYTES_A_POINT * images : 0, brio_context_threads(ctx) > 1);
    *bytes = bytes_of(HOME_BYTES_A_POINT * n + image * images + work);
    return BRIO_OK;
}

brio_status brio_estimate_tetrahedra(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                     uint64_t *tetrahedra) {
    BRIO_DOOR;
    brio_triangulation_size size = {0};
    *tetrahedra = 0;
    BRIO_FORWARD(brio_refuse_points(ctx, points, num_points));
    BRIO_FORWARD(brio_estimate_size(ctx, points, weights, num_points, &size));
    *tetrahedra = (uint64_t)size.tetrahedra;
    return BRIO_OK;
}

brio_status brio_estimate_surface(brio_context *ctx, size_t num_points, const brio_surface_options *options,
                                  uint64_t *bytes) {
    BRIO_DOOR;
    brio_surface_options o = {0};
    *bytes = 0;
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_surface_options, options, &o));
    const brio_method_row *row = brio_method_row_of(o.method);
    BRIO_EXPECT(ctx, row, BRIO_ERR_ARGUMENT, "no such method: %d", (int)o.method);
    *bytes = bytes_of(brio_method_bytes(row, (double)num_points, &o));
    return BRIO_OK;
}

brio_status brio_estimate_power_shape(brio_context *ctx, size_t num_points, const brio_power_shape_options *options,
                                      uint64_t *bytes) {
    BRIO_DOOR;
    brio_power_shape_options o = {0};
    brio_status status = BRIO_TAKE(ctx, brio_power_shape_options, options, &o);
    *bytes = status == BRIO_OK
                 ? bytes_of((double)num_points * brio_method_row_of(BRIO_SURFACE_POWER_CRUST)->bytes_a_point)
                 : 0;
    return status;
}

uint64_t brio_estimate_mesh_subdivide(size_t num_faces, int levels) {
    BRIO_DOOR;
    enum { MOST_LEVELS = 15 }; /* of brio_mesh_subdivide */
    levels = levels < 1 ? 1 : levels > MOST_LEVELS ? MOST_LEVELS : levels;
    return bytes_of(ldexp((double)num_faces, 2 * levels) * SUBDIVIDE_BYTES_A_FACE);
}

uint64_t brio_estimate_iso_surface(size_t num_vertices) {
    BRIO_DOOR;
    return bytes_of((double)num_vertices * ISO_BYTES_A_VERTEX);
}

uint64_t brio_estimate_delaunay2(size_t num_points, int weighted) {
    BRIO_DOOR;
    return bytes_of((double)num_points * (PLANE_BYTES_A_POINT + (weighted ? PLANE_BYTES_A_WEIGHT : 0)));
}
