/* The vertex of least power distance in a regular triangulation of the plane. */
#ifndef BRIO_PLANE_PLANE_NEAREST_H
#define BRIO_PLANE_PLANE_NEAREST_H

#include "plane/plane_walk.h"
#include "predicates/predicates.h"

/** Searches among the vertices of a triangulation. */
typedef struct {
    const brio_plane_view *view;
    const brio_plane_filter *filter;
    size_t num_points;      /* vertices from num_points on are no points and are skipped */
    const uint32_t *corner; /* of each vertex: a triangle that has it */
} brio_plane_nearest;

/** Returns whether record p is nearer to x than record q by power distance; ties are lexicographic. Exact. */
static inline bool brio_plane_is_nearer(const brio_plane_filter *f, const double *x, const double *p, const double *q) {
    int sign = brio_power_compare(x, p, q);
    return (sign ? sign : brio_plane_lexicographic(f, p, q)) < 0;
}

/** Returns the vertex of least power distance from x; ties are lexicographic by the filter's order. Exact.
 *  t  a triangle that holds x. */
uint32_t brio_plane_nearest_vertex(const brio_plane_nearest *n, uint32_t t, const double *x);

#endif
