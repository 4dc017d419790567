/* The vertex of least power distance in a regular triangulation of the plane. */
#ifndef BRIO_PLANE_PLANE_NEAREST_H
#define BRIO_PLANE_PLANE_NEAREST_H

#include "plane/plane_walk.h"

/** Searches among the vertices of a triangulation. */
typedef struct {
    const brio_plane_view *view;
    const brio_plane_filter *filter;
    size_t num_points;      /* vertices from num_points on are no points and are skipped */
    const uint32_t *corner; /* of each vertex: a triangle that has it */
} brio_plane_nearest;

/** Returns the vertex of least power distance from x; ties are lexicographic by the filter's order. Exact.
 *  t  a triangle that holds x. */
uint32_t brio_plane_nearest_vertex(const brio_plane_nearest *n, uint32_t t, const double *x);

#endif
