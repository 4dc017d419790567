/* The longest side of a box, divided into cells; the same cells along the other sides. Neither a side beyond doubles
 * nor one of the least doubles loses anything: coordinates times a power of two have the cells of the coordinates. */
#ifndef BRIO_ORDER_RULER_H
#define BRIO_ORDER_RULER_H

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    double half; /* 1, or 1/2 where differences of coordinates overflow */
    double unit; /* 1, or more where cells of these differences would be beyond doubles */
    double scale, last;
} brio_ruler;

/** Divides the longest side into 2^bits cells. Returns false when the box is a single point. */
static inline bool brio_ruler_lay(brio_ruler *r, const double *low, const double *high, int dimension, int bits) {
    double side = 0, half_side = 0, cells = ldexp(1, bits);
    for (int k = 0; k < dimension; k++) {
        side = fmax(side, high[k] - low[k]);
        half_side = fmax(half_side, high[k] * 0.5 - low[k] * 0.5);
    }
    r->half = side < INFINITY ? 1 : 0.5;
    side = side < INFINITY ? side : half_side;
    r->unit = side < 0x1p-500 ? 0x1p500 : 1;
    r->scale = side > 0 ? cells / (side * r->unit) : 0;
    r->last = cells - 1;
    return side > 0;
}

/** Returns the cell of a coordinate of the box; for any other number, some cell. */
static inline uint32_t brio_ruler_cell(const brio_ruler *r, double x, double low) {
    double at = (x * r->half - low * r->half) * r->unit * r->scale;
    assert(r->last >= 0);
    at = at < r->last ? at : r->last;
    return (uint32_t)(int64_t)(at > 0 ? at : 0);
}

#endif
