/* Sorts points of the plane along a Hilbert curve. */
#ifndef BRIO_ORDER_PLANE_CURVE_H
#define BRIO_ORDER_PLANE_CURVE_H

#include "base/context.h"

/** Rows of doubles, and which two numbers of a row are the coordinates in the plane. */
typedef struct {
    const double *rows;
    size_t stride; /* doubles in a row */
    int axis[2];
} brio_plane_points;

/** Sorts items along the curve through the square of their points. The low half of an item is the index of a row; the
 *  high half receives a key.   spare  room for n items.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_sort_along_plane_curve(brio_context *ctx, const brio_plane_points *points, uint64_t *items,
                                        uint64_t *spare, size_t n);

#endif
