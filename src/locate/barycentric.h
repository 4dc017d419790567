/* Coordinates of a query in the tetrahedron that holds it. */
#ifndef BRIO_LOCATE_BARYCENTRIC_H
#define BRIO_LOCATE_BARYCENTRIC_H

#include "locate/holder.h"

/** Sets share[i] to the barycentric coordinate of x at vertex i of the tetrahedron. The shares are at least 0 and sum to
 *  1. They are exactly 0 for vertices opposite to a facet whose plane holds x.   h  not outside. */
void brio_barycentric(const brio_locator *l, const brio_holder *h, const double *x, double share[4]);

/** Returns a power of two that scales the offsets from x to these places to at most 1, or 0 if doubles cannot hold the
 *  offsets. */
double brio_offset_scale(const brio_locator *l, const uint32_t *places, size_t count, const double *x);

/** Sets row to scale (position of the place - x). */
static inline void brio_offset(const brio_locator *l, uint32_t place, const double *x, double scale, double *row) {
    for (int k = 0; k < 3; k++) row[k] = (l->record[place][k] - x[k]) * scale;
}

#endif
