/* Coordinates of a query in the triangle that holds it. */
#ifndef BRIO_PLANE_PLANE_BARYCENTRIC_H
#define BRIO_PLANE_PLANE_BARYCENTRIC_H

#include "plane/plane_holder.h"

/** Sets share[i] to the barycentric coordinate of x at vertex i of the triangle. The shares are at least 0 and sum to 1. They
 *  are exactly 0 for vertices opposite to an edge whose line holds x.   h  not outside. */
void brio_plane_barycentric(const brio_locator2 *l, const brio_plane_holder *h, const double *x, double share[3]);

/** Returns a power of two that scales the offsets from x to these points to at most 1, or 0 if doubles cannot hold the
 *  offsets. */
double brio_plane_offset_scale(const brio_locator2 *l, const uint32_t *points, size_t count, const double *x);

/** Sets row to scale (point - x). */
static inline void brio_plane_offset(const brio_locator2 *l, uint32_t point, const double *x, double scale,
                                     double *row) {
    for (int k = 0; k < 2; k++) row[k] = (l->record[point][k] - x[k]) * scale;
}

static inline double brio_plane_cross(const double *a, const double *b) {
    return a[0] * b[1] - a[1] * b[0];
}

#endif
