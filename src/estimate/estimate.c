/* Memory estimates.
 *
 * The constants are those of the data structures or measured, as said beside them; measurement adjusts them here and
 * nowhere else. docs/measured/performance.md compares the estimates with the peaks of many inputs. An input that no
 * estimate foresees meets the memory limit of the context, which refuses memory while the work runs. */
#include "base/float_state.h"
#include "base/versioned.h"
#include "estimate/triangulation_size.h"
#include "order/canonical_points.h"
#include "triangulation/triangulation.h"
#include <math.h>

/* While points are inserted: record, index in the input, representative, number in the cavity. */
static const double INSERT_BYTES_A_POINT = 41, INSERT_BYTES_A_TETRAHEDRON = 33;
static const double SEQUENCE_BYTES_A_POINT = 4; /* more, with weights */
/* Then, where points are hidden, what finds the vertices that represent them (autzen and csite4: 32). */
static const double BYTES_A_HIDDEN_POINT = 32;
/* While the result is sorted: index, representative and two buckets; two numbers a tetrahedron. */
static const double SORT_BYTES_A_POINT = 16, SORT_BYTES_A_TETRAHEDRON = 41;
/* With threads: the rank on the curve, and a thirty-second of the result moved at a time, with the lists for it. */
static const double THREADS_BYTES_A_POINT = 4, THREADS_BYTES_A_TETRAHEDRON = 1.25;
/* Other locations than the walk. HISTORY and TRACE: 300,000 points of a scan peak at 892 bytes a point resident, 322 by
 * the walk. An edge takes 8 bytes as a pair and 8 in the graph. */
static const double HISTORY_BYTES_A_POINT = 570, LOCATION_BYTES_A_POINT = 8, BYTES_AN_EDGE = 16;

/* In the plane: record, index in the input, representative, two triangles; with weights two marks, a triangle of each
 * vertex and a list of the points that may be hidden. */
static const double PLANE_BYTES_A_POINT = 88, PLANE_BYTES_A_WEIGHT = 10;

/* Measured, the samples not included: models take 1,460 to 1,570 bytes a sample, a raw scan 1,590, offsets 1,240, the
 * co-cone 540 to 640. */
static const double CRUST_BYTES_A_POINT = 1426, OFFSET_BYTES_A_POINT = 1300, COCONE_BYTES_A_POINT = 616;
/* Measured: a raw scan of a million samples takes 993 bytes a sample, simulated scans of 60,000 and 20,000 samples
 * 1,063 and 1,213. */
static const double LABELED_BYTES_A_POINT = 1110;
static const double TRIANGLE_BYTES_A_POINT = 300;  /* more, triangulated: a scan of 20,000 points 210, bunny 350 */
static const double SIMPLIFY_BYTES_A_POINT = 2150; /* more, simplified: knot2 2,080, bunny 2,150, fandisk 2,200 */
static const double SUBDIVIDE_BYTES_A_FACE = 76;   /* of the result, a certificate included */
static const double ISO_BYTES_A_VERTEX = 71, COORDINATE_BYTES = 24;

/* Returns a number of bytes as an integer, the greatest integer for larger numbers. */
static uint64_t bytes_of(double bytes) {
    return bytes < 0x1p64 ? (uint64_t)bytes : UINT64_MAX;
}

static double location_bytes(double points, const brio_delaunay_options *o) {
    switch (o->locate) {
    case BRIO_LOCATION_WALK:
        return 0;
    case BRIO_LOCATION_HISTORY:
        return HISTORY_BYTES_A_POINT * points;
    case BRIO_LOCATION_TRACE:
        return HISTORY_BYTES_A_POINT * points + BYTES_AN_EDGE * (double)o->num_edges;
    case BRIO_LOCATION_NEIGHBOUR:
        return LOCATION_BYTES_A_POINT * points + BYTES_AN_EDGE * (double)o->num_edges;
    default:
        return LOCATION_BYTES_A_POINT * points;
    }
}

static double sequence_bytes(double points, const brio_delaunay_options *o) {
    return o->order == BRIO_ORDER_BRIO && o->locate == BRIO_LOCATION_WALK ? SEQUENCE_BYTES_A_POINT * points : 0;
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
    BRIO_FORWARD(brio_delaunay_check_options(ctx, num_points, &o));
    BRIO_FORWARD(brio_refuse_points(ctx, points, num_points));
    BRIO_FORWARD(brio_estimate_size(ctx, points, weights, num_points, &size));
    double n = (double)num_points;
    double sequence = weights ? sequence_bytes(n, &o) : 0;
    *bytes = bytes_of(delaunay_bytes(n, &size, sequence, brio_context_threads(ctx) > 1) + location_bytes(n, &o));
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

/* Returns the estimate of a crust.   each  bytes a point of the balls and the faces. */
static uint64_t crust_bytes(size_t num_points, double each, bool triangulate, bool simplify) {
    if (triangulate) each += TRIANGLE_BYTES_A_POINT;
    if (simplify) each += SIMPLIFY_BYTES_A_POINT;
    return bytes_of(each * (double)num_points);
}

/* Returns the estimate of the co-cones. The super co-cone keeps the points and the triangles of all pieces, and works
 * on one piece of up to twice the mean size. Measured on scans of 60,000 and 200,000 points in 3 to 154 pieces, with
 * one thread. */
static double cocone_bytes(double points, double pieces) {
    static const double KEPT_A_POINT = 210, A_PIECE = 180e3;
    double whole = COCONE_BYTES_A_POINT * points;
    return pieces < 2 ? whole : fmin(whole, KEPT_A_POINT * points + whole * 2 / pieces) + A_PIECE * pieces;
}

brio_status brio_estimate_surface(brio_context *ctx, size_t num_points, const brio_surface_options *options,
                                  uint64_t *bytes) {
    BRIO_DOOR;
    brio_surface_options o = {0};
    *bytes = 0;
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_surface_options, options, &o));
    BRIO_EXPECT(ctx, (unsigned)o.method < BRIO_SURFACE_END, BRIO_ERR_ARGUMENT, "no such method: %d", (int)o.method);
    switch (o.method) {
    case BRIO_SURFACE_POWER_CRUST:
        *bytes = crust_bytes(num_points, CRUST_BYTES_A_POINT, !o.polygons, o.simplify);
        break;
    case BRIO_SURFACE_OFFSET:
        *bytes = crust_bytes(num_points, OFFSET_BYTES_A_POINT, !o.polygons, o.simplify);
        break;
    case BRIO_SURFACE_LABELED:
        *bytes = bytes_of(LABELED_BYTES_A_POINT * (double)num_points);
        break;
    case BRIO_SURFACE_COCONE:
    case BRIO_SURFACE_TIGHT_COCONE:
        *bytes = bytes_of(cocone_bytes((double)num_points, (double)o.pieces));
        break;
    case BRIO_SURFACE_END: /* no default: the compiler names the method that was forgotten */
        break;
    }
    return BRIO_OK;
}

brio_status brio_estimate_power_shape(brio_context *ctx, size_t num_points, const brio_power_shape_options *options,
                                      uint64_t *bytes) {
    BRIO_DOOR;
    brio_power_shape_options o = {0};
    brio_status status = BRIO_TAKE(ctx, brio_power_shape_options, options, &o);
    *bytes = status == BRIO_OK ? crust_bytes(num_points, CRUST_BYTES_A_POINT, false, false) : 0;
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

uint64_t brio_estimate_generate(size_t num_points) {
    BRIO_DOOR;
    return bytes_of((double)num_points * COORDINATE_BYTES);
}
