/* A triangulation of the plane in the form that queries read: copies of its triangles and of its points, and a grid of
 * squares, each with a triangle nearby where a walk begins.
 *
 * I1  triangle[t] is triangle t of the triangulation; vertices are the caller's indices or BRIO_INFINITE.
 * I2  corner[v] is the finite triangle of lowest index that has vertex v; it is not set for other points.
 * I3  start[s] is a finite triangle, for each square s.
 * I4  Nothing changes after brio_locator2_new: any number of threads may read a locator. */
#ifndef BRIO_PLANE_LOCATOR2_H
#define BRIO_PLANE_LOCATOR2_H

#include "plane/plane_walk.h"
#include <assert.h>

struct brio_locator2 {
    brio_context *ctx;
    size_t num_points;
    size_t num_finite, num_triangles; /* without and with infinite ones; 0 for points of dimension 1 or less */
    bool weighted;
    brio_triangle *triangle;
    brio_plane_record *record; /* of each point */
    uint32_t *corner;          /* of each point; NULL without triangles */
    uint32_t *start;           /* side by side squares, row after row; NULL without triangles */
    size_t side;
    double low[2], high[2], scale[2]; /* of the grid: the box of the points; squares per unit of length */
    uint32_t *line;  /* the vertices of points on a line or at one place, up to rounding, in the order along the line */
    size_t num_line; /* 0 for other points. With triangles, these are flat up to rounding. */
    brio_plane_filter filter; /* for queries in the box: a thread works with its own copy */
};

static inline brio_plane_view brio_locator2_view(const brio_locator2 *l) {
    return (brio_plane_view){l->triangle, (const brio_plane_record *)l->record, BRIO_INFINITE};
}

/** Returns whether x is in the box of the points, where the locator's filter holds. */
static inline bool brio_locator2_boxes(const brio_locator2 *l, const double *x) {
    return x[0] >= l->low[0] && x[0] <= l->high[0] && x[1] >= l->low[1] && x[1] <= l->high[1];
}

/** Returns where the grid keeps the triangle for x. There are triangles. */
static inline uint32_t *brio_locator2_square(const brio_locator2 *l, const double *x) {
    size_t at[2];
    for (int k = 0; k < 2; k++) {
        double place = (x[k] - l->low[k]) * l->scale[k];
        at[k] = !(place > 0) ? 0 : place < (double)l->side ? (size_t)place : l->side - 1;
    }
    assert(l->start && at[0] < l->side && at[1] < l->side);
    return &l->start[at[1] * l->side + at[0]];
}

#endif
