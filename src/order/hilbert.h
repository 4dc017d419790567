/* Keys of points along a Hilbert curve. Points with near keys are near in space. */
#ifndef BRIO_ORDER_HILBERT_H
#define BRIO_ORDER_HILBERT_H

#include "base/context.h"

enum { BRIO_HILBERT_MAX_BITS = 21 };

/** Returns the position of cell (x, y, z) along the curve through a grid of 2^bits cells a side; x, y, z < 2^bits. */
uint64_t brio_hilbert_key(uint32_t x, uint32_t y, uint32_t z, int bits);

/** Writes keys[i], the key of point i in the smallest cube that holds the points.
 *  points  #P by 3, finite.   bits  at most BRIO_HILBERT_MAX_BITS. */
brio_status brio_hilbert_keys(brio_context *ctx, const double *points, size_t num_points, int bits, uint64_t *keys);

/** Writes to the high half of items[i] the key of the point whose index is the low half, in the smallest cube that
 *  holds the points of all n items. Changes no item, and sets *bits to 0, when n is 0 or all points have one position.
 *  *bits  from 1 to 10.   threads  a result of brio_threads. */
brio_status brio_hilbert_items(brio_context *ctx, const double *points, uint64_t *items, size_t n, int *bits,
                               int threads);

#endif
