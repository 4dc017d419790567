/* Keys of points along a Hilbert curve: near in the order means near in space. */
#ifndef BRIO_ORDER_HILBERT_H
#define BRIO_ORDER_HILBERT_H

#include "base/context.h"

enum { BRIO_HILBERT_MAX_BITS = 21 };

/** Position of cell (x, y, z), each below 2^bits, along the curve through the grid of 2^bits cells a side. */
uint64_t brio_hilbert_key(uint32_t x, uint32_t y, uint32_t z, int bits);

/** keys[i] = key of point i in the smallest cube that holds the #P by 3 points; bits at most BRIO_HILBERT_MAX_BITS. Any
 *  finite coordinates. */
void brio_hilbert_keys(brio_context *ctx, const double *points, size_t num_points, int bits, uint64_t *keys);

/** The same for some of the points: the low half of items[i] is an index of a point, the high half becomes its key in
 *  the smallest cube that holds them all; bits at most 10. False when they are all at one position.
 *  threads  what brio_threads gave. */
bool brio_hilbert_items(brio_context *ctx, const double *points, uint64_t *items, size_t n, int bits, int threads);

#endif
