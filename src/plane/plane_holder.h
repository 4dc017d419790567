/* The triangles that hold a query. */
#ifndef BRIO_PLANE_PLANE_HOLDER_H
#define BRIO_PLANE_PLANE_HOLDER_H

#include "plane/plane_queries.h"

/** A triangle that holds a query, and where in it the query lies. */
typedef struct {
    uint32_t triangle; /* a finite triangle whose closure holds the query; BRIO_INFINITE outside the hull */
    unsigned zeros;    /* bit i: the query is on the line of the edge opposite to vertex i. Two bits: at a vertex. */
} brio_plane_holder;

/** Returns the triangle of lowest index that holds x. Exact. */
brio_plane_holder brio_plane_find_holder(brio_plane_querent *q, const double *x);

/** Returns whether the query is on an edge of the hull.   h  not outside, and not at a vertex. */
bool brio_plane_holder_on_hull(const brio_locator2 *l, const brio_plane_holder *h);

#endif
