/* Sorting of points along a Hilbert curve. */
#ifndef BRIO_ORDER_CURVE_H
#define BRIO_ORDER_CURVE_H

#include "base/context.h"

/** Sorts items, whose low halves are indices of points, along the curve through their cube; the high halves are left
 *  with keys.   spare  room for n items.   threads  what brio_threads gave. */
brio_status brio_sort_along_curve(brio_context *ctx, const double *points, uint64_t *items, uint64_t *spare, size_t n,
                                  int threads);

#endif
