/* Parts of the exact check of a triangulation of the plane; plane_check.c says what they establish together. */
#ifndef BRIO_PLANE_PLANE_CHECK_H
#define BRIO_PLANE_PLANE_CHECK_H

#include "plane/plane_walk.h"
#include "plane/triangulation2.h"

/** A running check. */
typedef struct {
    brio_context *ctx;
    const brio_triangulation2 *t;
    brio_plane_view view; /* vertices are rows of view.record or BRIO_INFINITE */
    size_t count;         /* of triangles, infinite ones included */
    size_t num_points;
    bool weighted;
    brio_plane_filter filter;
} brio_plane_judge;

/** Runs test 6 on one point: point p must not be inside the (ortho)circle of finite triangle t, and ties must be broken
 *  by the perturbation. */
brio_status brio_plane_check_circle(brio_plane_judge *j, uint32_t t, uint32_t p);

/** Runs test 7 on the points that are no vertex, and checks every representative and the counts of vertices, duplicates
 *  and hidden points. The triangles have passed tests 1 to 6. */
brio_status brio_plane_check_points(brio_plane_judge *j);

/** Checks a triangulation of dimension 1 or less: the vertices along the line, every representative and the counts.
 *  record  the points and room for one more record, which is written. */
brio_status brio_plane_check_line(brio_plane_judge *j, brio_plane_record *record);

#endif
