/* Sorts points along a Hilbert curve. */
#ifndef BRIO_ORDER_CURVE_H
#define BRIO_ORDER_CURVE_H

#include "base/context.h"

/** Sorts items along the curve through the cube of their points. The low half of an item is the index of a point; the
 *  high half receives a key.   spare  room for n items.   threads  a result of brio_threads. */
brio_status brio_sort_along_curve(brio_context *ctx, const double *points, uint64_t *items, uint64_t *spare, size_t n,
                                  int threads);

#endif
