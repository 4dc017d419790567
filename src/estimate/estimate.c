/* Memory estimates.
 *
 * The constants are those of the data structures or measured, as said beside them; measurement adjusts them here, or in
 * the table of methods for surfaces, and nowhere else. docs/measured/performance.md compares the estimates with the
 * peaks of many inputs. An input that no estimate foresees meets the memory limit of the context, which refuses memory
 * while the work runs. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "estimate/triangulation_size.h"
#include "order/canonical_points.h"
#include "periodic/periodic.h"
#include "reconstruct/surface/method.h"
#include "triangulation/insertion_part.h"
#include "triangulation/triangulation.h"
#include <math.h>

/* While points are inserted: record, index in the input, representative, number in the cavity. Tetrahedra have room
 * for an eighth more, which the context counts. */
static const double INSERT_BYTES_A_POINT = 41, INSERT_BYTES_A_TETRAHEDRON = 33, ROOM = 1.125;
static const double TETRAHEDRON_BYTES = sizeof(brio_tetrahedron);
static const double SEQUENCE_BYTES_A_POINT = 4; /* more, with weights */
/* Then, where points are hidden, what finds the vertices that represent them (autzen and csite4: 32). */
static const double BYTES_A_HIDDEN_POINT = 32;
/* While the result is sorted: index, representative and two buckets; two numbers a tetrahedron. */
static const double SORT_BYTES_A_POINT = 16, SORT_BYTES_A_TETRAHEDRON = 41;
/* Whatever the number of points: an inserter, of which 262,144 bytes are the table of a cavity's edges; with threads
 * one each, and the slots that a thread takes at once; where the result is sorted, what moves at a time. Measured. */
static const double INSERTER_BYTES = 335e3, SLOTS_A_THREAD = 8192, MOVED_BYTES_A_THREAD = 328e3;
/* Points from which threads insert together; that are worth one then; tetrahedra whose order is. */
static const double TOGETHER = 4096, POINTS_A_THREAD = 512, SORTED_A_THREAD = 8192;
/* Points in a plane or on a line have no tetrahedra in the end; while they are inserted, up to 4 each. */
static const double FLAT_TETRAHEDRA = 4;
/* With threads: the rank on the curve, and at most a sixteenth of the result moved at a time, with the lists for it. */
static const double THREADS_BYTES_A_POINT = 4, THREADS_BYTES_A_TETRAHEDRON = 1.25;
/* In the plane: record, index in the input, representative, two triangles; with weights two marks, a triangle of each
 * vertex and a list of the points that may be hidden. */
static const double PLANE_BYTES_A_POINT = 88, PLANE_BYTES_A_WEIGHT = 10;

/* In space that repeats: a translate with its position; a point in the domain and the shift to it. Measured. Classes
 * take the place of the tetrahedra, with less beside them than the sort has.
 * While points are completed: boxes about the points; a tetrahedron and its mark; what a round has of a point that it
 * triangulates, with its final tetrahedra, beside the triangulation. Measured on slabs, shells and clusters. */
static const double IMAGE_BYTES = 60, HOME_BYTES_A_POINT = 36;
static const double BOXES_BYTES_A_POINT = 45, KNOWN_BYTES_A_TETRAHEDRON = 33, COMPLETED_BYTES = 360,
                    ASKED_BYTES = BRIO_COMPLETION_BALLS * sizeof(brio_ball);
static const double USUAL = 6.8; /* tetrahedra a point */

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

/* Returns how many threads n items occupy of those that there are, as brio_threads does. */
static double threads_for(double n, double worth, int threads) {
    return fmin(fmax(floor(n / worth), 1), threads);
}

static double delaunay_bytes(double points, const brio_triangulation_size *size, double sequence, int threads) {
    double tets = size->tetrahedra, held = tets > 0 ? tets : FLAT_TETRAHEDRA * points;
    double hands = threads > 1 && points >= TOGETHER ? threads_for(points, POINTS_A_THREAD, threads) : 0;
    double slots = held + SLOTS_A_THREAD * hands, inserters = INSERTER_BYTES * (1 + hands);
    double insert = sequence + INSERT_BYTES_A_POINT * points + INSERT_BYTES_A_TETRAHEDRON * ROOM * slots +
                    BYTES_A_HIDDEN_POINT * size->hidden + inserters;
    double sort = SORT_BYTES_A_POINT * points + SORT_BYTES_A_TETRAHEDRON * slots + INSERTER_BYTES;
    /* a block that becomes a mapping is copied: then there are two */
    if (TETRAHEDRON_BYTES * ROOM * slots > BRIO_MAP_FROM)
        insert = fmax(insert, INSERT_BYTES_A_POINT * points + (1 + ROOM) * BRIO_MAP_FROM + inserters);
    if (tets > 0) sort += MOVED_BYTES_A_THREAD * threads_for(tets, SORTED_A_THREAD, threads);
    if (threads > 1) sort += THREADS_BYTES_A_TETRAHEDRON * tets;
    return fmax(insert, sort) + (threads > 1 ? THREADS_BYTES_A_POINT * points : 0);
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
    *bytes = bytes_of(delaunay_bytes(n, &size, sequence, brio_context_threads(ctx)) + location);
    return BRIO_OK;
}

/* Returns the bytes of a triangulation that repeats.   images  how many points and translates are triangulated. */
static double periodic_bytes(const brio_context *ctx, double points, double images, bool weighted,
                             const brio_triangulation_size *size, const brio_completion_size *completion) {
    int threads = brio_context_threads(ctx);
    double share = points > 0 ? images / points : 0, completed = fmin(completion->points, images);
    brio_triangulation_size all = {share * size->tetrahedra, share * size->hidden};
    const brio_triangulation_size round = {USUAL * completed, 0};
    if (!completion->flat && !size->tetrahedra) all.tetrahedra = USUAL * images; /* of 1 to 3 points */
    double kept = HOME_BYTES_A_POINT * points + (IMAGE_BYTES + (weighted ? sizeof(double) : 0)) * images;
    double first = delaunay_bytes(images, &all, weighted ? SEQUENCE_BYTES_A_POINT * images : 0, threads);
    if (!completed) return kept + first;
    double then = ASKED_BYTES + BOXES_BYTES_A_POINT * points + KNOWN_BYTES_A_TETRAHEDRON * all.tetrahedra +
                  COMPLETED_BYTES * completed + delaunay_bytes(completed, &round, 0, threads);
    return kept + fmax(first, then);
}

brio_status brio_estimate_periodic(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const brio_periodic_options *options, uint64_t *bytes) {
    BRIO_DOOR;
    brio_triangulation_size size = {0};
    brio_completion_size completion = {0};
    double images = 0, n = (double)num_points, most = (double)brio_memory_limit(ctx);
    *bytes = 0;
    BRIO_FORWARD(brio_refuse_points(ctx, points, num_points));
    BRIO_FORWARD(brio_periodic_count(ctx, points, num_points, options, false, &images));
    BRIO_FORWARD(brio_estimate_size(ctx, points, weights, num_points, &size));
    double needed = periodic_bytes(ctx, n, images, weights, &size, &completion);
    if (needed <= most) { /* else it is too much, whatever is completed, and the samples may be, too */
        BRIO_FORWARD(brio_estimate_completion(ctx, points, weights, num_points, options, &completion));
        if (completion.flat) BRIO_FORWARD(brio_periodic_count(ctx, points, num_points, options, true, &images));
        needed = periodic_bytes(ctx, n, images, weights, &size, &completion);
    }
    *bytes = bytes_of(needed);
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
    double n = (double)num_points / (o.pieces > 1 ? (double)o.pieces : 1);
    const brio_triangulation_size size = {USUAL * n, 0};
    double triangulation = delaunay_bytes(n, &size, 0, brio_context_threads(ctx)); /* most, where points are few */
    *bytes = bytes_of(fmax(brio_method_bytes(row, (double)num_points, &o), triangulation));
    return BRIO_OK;
}

brio_status brio_estimate_power_shape(brio_context *ctx, size_t num_points, const brio_power_shape_options *options,
                                      uint64_t *bytes) {
    BRIO_DOOR;
    brio_power_shape_options o = {0};
    brio_status status = BRIO_TAKE(ctx, brio_power_shape_options, options, &o);
    const brio_triangulation_size size = {USUAL * (double)num_points, 0};
    double triangulation = delaunay_bytes((double)num_points, &size, 0, brio_context_threads(ctx));
    double shape = (double)num_points * brio_method_row_of(BRIO_SURFACE_POWER_CRUST)->bytes_a_point;
    *bytes = status == BRIO_OK ? bytes_of(fmax(shape, triangulation)) : 0;
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
