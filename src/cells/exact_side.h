/* On which side of a plane a vertex of a clipped cell is, exactly.
 *
 * Planes are those between two sites, on which power distances are equal, and the walls of the region as the caller
 * gave them. Their names are numbers:
 *     -1 - i                            wall i of the region
 *     0 .. 2^32 - 1                     the plane between the cell's site and this site
 *     brio_plane_of_tetrahedron(t, k)   the plane between vertices 0 and 1 + k of tetrahedron t
 *
 * A vertex is the point of three planes. Its height over a fourth is a quotient of determinants: with rows (n, d) for
 * the planes n . x = d, that of all four planes with its sign changed, divided by that of the three normals.
 *
 * The sign comes from doubles, against a bound of the rounding errors, or else from dyadic numbers. */
#ifndef BRIO_CELLS_EXACT_SIDE_H
#define BRIO_CELLS_EXACT_SIDE_H

#include "cells/diagram.h"
#include <assert.h>

typedef struct brio_exact_planes {
    const brio_diagram *d;
    const brio_region *region;
    uint32_t site; /* of the cell */
} brio_exact_planes;

static inline int64_t brio_plane_of_tetrahedron(uint32_t t, int k) {
    assert(0 <= k && k < 3);
    return ((int64_t)1 << 32) + 3 * (int64_t)t + k;
}

/** Return what brio_judge says.   user  a brio_exact_planes. */
int brio_exact_orientation(const void *user, const int64_t planes[3]);
int brio_exact_side(const void *user, const int64_t planes[3], int orientation, int64_t plane);

#endif
