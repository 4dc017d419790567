/* The points that a caller gave for a triangulation of the plane. */
#ifndef BRIO_PLANE_PLANE_INPUT_H
#define BRIO_PLANE_PLANE_INPUT_H

#include "order/plane_curve.h"
#include "predicates/plane.h"

typedef double brio_plane_record[4];

/** Points of the plane, or points of a plane in space. */
typedef struct {
    const double *points;  /* count by `coordinates` */
    const double *weights; /* count, or NULL */
    size_t count;
    int coordinates; /* 2 or 3 */
    int axis[3];     /* which coordinates become u, v and rest of a record (predicates/plane.h) */
} brio_plane_input;

/** Sets *input. Three coordinates: chooses the axes such that (u, v) names a point of the plane, and such that triangles
 *  that are counterclockwise by the rule of brio_delaunay2_flat are counterclockwise in (u, v).
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE (the message names the first bad point), BRIO_ERR_NO_ANSWER (points off the
 *  plane; the message names one). */
brio_status brio_plane_input_set(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                 int coordinates, brio_plane_input *input);

/** Returns whether the input has numbers that plain records ignore (brio_plane_filter). */
static inline bool brio_plane_general(const brio_plane_input *input) {
    return input->weights || input->coordinates == 3;
}

/** Sets the filter's lexicographic order to that of the caller's coordinates. */
void brio_plane_input_key(const brio_plane_input *input, brio_plane_filter *filter);

/** Writes point i as a record; -0 becomes 0. */
static inline void brio_plane_input_record(const brio_plane_input *input, size_t i, double *record) {
    const double *p = input->points + (size_t)input->coordinates * i;
    record[0] = p[input->axis[0]] + 0.0;
    record[1] = p[input->axis[1]] + 0.0;
    record[2] = input->coordinates == 3 ? p[input->axis[2]] + 0.0 : 0;
    record[3] = input->weights ? input->weights[i] + 0.0 : 0;
}

/** Makes records of all points in their own order, with `room` more that are not set. */
brio_status brio_plane_records_new(brio_context *ctx, const brio_plane_input *input, size_t room,
                                   brio_plane_record **out);

#endif
