/* The smallest cube around points, cut into a grid of cells. A coordinate that is not finite, or that was changed after
 * the cube was found, falls in some cell. */
#ifndef BRIO_ORDER_CUBE_H
#define BRIO_ORDER_CUBE_H

#include "base/context.h"
#include "order/ruler.h"
#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    double low[3], high[3];
    brio_ruler ruler;
} brio_cube;

static inline void brio_cube_new(brio_cube *c, const double *p) {
    for (int k = 0; k < 3; k++) c->low[k] = c->high[k] = p[k];
}

static inline void brio_cube_add(brio_cube *c, const double *p) {
    for (int k = 0; k < 3; k++) {
        double x = p[k];
        c->low[k] = x < c->low[k] ? x : c->low[k];
        c->high[k] = x > c->high[k] ? x : c->high[k];
    }
}

static inline void brio_cube_join(brio_cube *c, const brio_cube *other) {
    for (int k = 0; k < 3; k++) {
        c->low[k] = fmin(c->low[k], other->low[k]);
        c->high[k] = fmax(c->high[k], other->high[k]);
    }
}

/** Returns the cube of n > 0 points: the first n points or, unless `items` is NULL, the points whose indices are the
 *  low halves of items[0 .. n).   threads  a result of brio_threads. */
brio_status brio_cube_of(brio_context *ctx, const double *points, const uint64_t *items, size_t n, int threads,
                         brio_cube *out);

/** Divides each side of the cube into 2^bits cells. Returns false when the cube is a single point. */
static inline bool brio_cube_divide(brio_cube *c, int bits) {
    return brio_ruler_lay(&c->ruler, c->low, c->high, 3, bits);
}

/** Returns coordinate k of the cell that holds a point of the cube; for any other point, that of some cell. */
static inline uint32_t brio_cube_cell(const brio_cube *c, const double *p, int k) {
    assert(0 <= k && k < 3);
    return brio_ruler_cell(&c->ruler, p[k], c->low[k]);
}

#endif
