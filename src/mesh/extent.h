/* The extent of a surface, and the power of two by which products of its sides neither overflow nor vanish. */
#ifndef BRIO_MESH_EXTENT_H
#define BRIO_MESH_EXTENT_H

#include "base/vector.h"
#include <brio/brio.h>

/** Widens the box low to high to the vertices at corners begin to end - 1 of the mesh's faces. A box of infinities,
 *  from INFINITY to -INFINITY, is empty. */
void brio_box_add_corners(const brio_mesh *mesh, uint64_t begin, uint64_t end, double low[3], double high[3]);

/** Returns the exponent of the least power of two above half the longest side of a box, between -1000 and 1000. 0 for a
 *  box without sides, and for one that is not finite. */
int brio_box_exponent(const double low[3], const double high[3]);

/** Returns the power of two that makes the box of the vertices that faces use about as large as 1. The mesh passes
 *  brio_mesh_check_faces. */
double brio_surface_scale(const brio_mesh *mesh);

/** Writes the normal of triangle abc, whose corners are multiplied by `scale`; the normal's length is twice the area.
 *  With a power of two the result is exactly scale^2 times what it is without, where doubles hold both. */
static inline void brio_scaled_normal(const double *a, const double *b, const double *c, double scale, double *n) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] * scale - a[k] * scale, v[k] = c[k] * scale - a[k] * scale;
    brio_cross(u, v, n);
}

#endif
