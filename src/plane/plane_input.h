/* The points that a caller gave for a triangulation of the plane. */
#ifndef BRIO_PLANE_PLANE_INPUT_H
#define BRIO_PLANE_PLANE_INPUT_H

#include "order/plane_curve.h"
#include "predicates/plane.h"

typedef double brio_plane_record[4];

/** Points of the plane, or points of a plane in space. The caller's arrays may change while the library works, so their
 *  numbers decide nothing until they have been copied: points of the plane into records, once they are ordered; points
 *  of a plane in space into `own` first, because all of them decide what the plane is. */
typedef struct {
    const double *points;  /* count by `coordinates`: the caller's */
    const double *weights; /* count, or NULL */
    size_t count;
    int coordinates;        /* 2 or 3 */
    int axis[3];            /* which coordinates become u, v and rest of a record (predicates/plane.h) */
    uint64_t hash;          /* of what was read of the points (base/points_hash.h); set with their first copy */
    brio_plane_record *own; /* of points in space: coordinates and weight; NULL for points of the plane */
} brio_plane_input;

/** Sets *input. Three coordinates: copies the points and chooses the axes such that (u, v) names a point of the plane,
 *  and such that triangles that are counterclockwise by the rule of brio_delaunay2_flat are counterclockwise in (u, v).
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE (the message names the first bad point), BRIO_ERR_NO_ANSWER (points off the
 *  plane; the message names one), BRIO_ERR_NO_MEMORY. The caller frees the input in either case. */
brio_status brio_plane_input_set(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                 int coordinates, brio_plane_input *input);

/** Frees the input's copy. The axes stay. */
void brio_plane_input_free(brio_context *ctx, brio_plane_input *input);

/** Returns whether the input has numbers that plain records ignore (brio_plane_filter). */
static inline bool brio_plane_general(const brio_plane_input *input) {
    return input->weights || input->coordinates == 3;
}

/** Sets the filter's lexicographic order to that of the caller's coordinates. */
void brio_plane_input_key(const brio_plane_input *input, brio_plane_filter *filter);

/** Returns the numbers that order the points. */
static inline brio_plane_points brio_plane_input_points(const brio_plane_input *input) {
    return input->own ? (brio_plane_points){*input->own, 4, {input->axis[0], input->axis[1]}}
                      : (brio_plane_points){input->points, (size_t)input->coordinates, {0, 1}};
}

/** Makes the records of all points; -0 becomes 0. Reads each number of the caller once.
 *  order  the input's index of each record; NULL for the input's own order.
 *  room   further records at the end, which are 0.
 *  out    owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE (the message names the first bad point), BRIO_ERR_NO_MEMORY. */
brio_status brio_plane_records_new(brio_context *ctx, brio_plane_input *input, const uint32_t *order, size_t room,
                                   brio_plane_record **out);

#endif
