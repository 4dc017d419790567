/* Points on a common grid as integers, and signed sums of 256 bits: what the integer stages of the predicates share.
 *
 * Where the differences of a call are exact doubles, they are integers times one power of two. */
#ifndef BRIO_PREDICATES_GRID_ROWS_H
#define BRIO_PREDICATES_GRID_ROWS_H

#include "base/scale.h"
#include "base/wide.h"
#include "predicates/span.h"
#include <assert.h>
#include <stdbool.h>

/* Without integers of 128 bits brio_grid_rows declines all points, and the stage of dyadic numbers decides: the same
 * signs, later. */
#if BRIO_HAS_INT128
typedef __int128 brio_wide;
typedef unsigned __int128 brio_unsigned_wide;
#else
typedef int64_t brio_wide;
typedef uint64_t brio_unsigned_wide;
#endif

enum { BRIO_WIDE_BITS = 8 * sizeof(brio_wide), BRIO_HALF_BITS = BRIO_WIDE_BITS / 2 };

/* Sets *d = a - b, rounded. Returns whether *d is exact. */
static inline bool brio_exact_difference(double a, double b, double *d) {
    double s = a - b, t = s - a;
    *d = s;
    return (a - (s - t)) - (b + t) == 0;
}

/** Writes the rows p[i] - origin as integers of at most `bits` bits, and the differences of weights in units of the
 *  grid's square, of at most 2 `bits` bits. Returns false when the points are on no such grid.
 *  count  at most 4.   bits  at most 61.   weight  NULL for points without weights. */
static inline bool brio_grid_rows(const double *const *p, int count, const double *origin, int bits, int64_t (*row)[3],
                                  brio_wide *weight) {
    double d[4][3], w[4];
    brio_span s = BRIO_NO_SPAN;
    assert(0 < count && count <= 4 && 0 < bits && bits <= 61);
    if (!BRIO_HAS_INT128) return false;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            if (!brio_exact_difference(p[i][k], origin[k], &d[i][k])) return false;
            brio_span_add(&s, d[i][k]);
        }
    if (s.low == INT32_MAX) s.low = s.high = 0; /* all rows zero */
    int grid = s.low;
    if (weight) { /* weights are in units of the grid's square */
        brio_span of_weights = BRIO_NO_SPAN;
        for (int i = 0; i < count; i++) {
            if (!brio_exact_difference(p[i][3], origin[3], &w[i])) return false;
            brio_span_add(&of_weights, w[i]);
        }
        if (of_weights.low != INT32_MAX) {
            int half = brio_half_exponent(of_weights.low);
            grid = half < grid ? half : grid;
            if (of_weights.high - 2 * grid > 2 * bits) return false;
        }
    }
    if (s.high - grid > bits || grid < -500 || grid > 400) return false;
    double unit = brio_power_of_two(-grid);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            assert(fabs(d[i][k] * unit) < ldexp(1, bits) && d[i][k] * unit == trunc(d[i][k] * unit)); /* on the grid */
            row[i][k] = (int64_t)(d[i][k] * unit);
        }
        if (weight) weight[i] = (brio_wide)(w[i] * unit * unit);
    }
    return true;
}

/** Returns the bits of the largest number in the rows. */
static inline int brio_bits_of(const int64_t (*row)[3], int count) {
    uint64_t all = 0;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) all |= (uint64_t)(row[i][k] < 0 ? -row[i][k] : row[i][k]);
    return all ? 64 - __builtin_clzll(all) : 0;
}

static inline int brio_sign_of_wide(brio_wide x) {
    return (x > 0) - (x < 0);
}

/** A number of 256 bits in two's complement. */
typedef struct {
    brio_unsigned_wide low, high;
} brio_sum256;

/** Adds s x y to *sum; s is 1 or -1. */
static inline void brio_add_product(brio_sum256 *sum, brio_wide x, brio_wide y, int s) {
    bool negative = (x < 0) != (y < 0);
    brio_unsigned_wide a = x < 0 ? -(brio_unsigned_wide)x : (brio_unsigned_wide)x;
    brio_unsigned_wide b = y < 0 ? -(brio_unsigned_wide)y : (brio_unsigned_wide)y;
    uint64_t a0 = (uint64_t)a, a1 = (uint64_t)(a >> BRIO_HALF_BITS), b0 = (uint64_t)b,
             b1 = (uint64_t)(b >> BRIO_HALF_BITS);
    brio_unsigned_wide p00 = (brio_unsigned_wide)a0 * b0, p01 = (brio_unsigned_wide)a0 * b1;
    brio_unsigned_wide p10 = (brio_unsigned_wide)a1 * b0;
    brio_unsigned_wide middle = (p00 >> BRIO_HALF_BITS) + (uint64_t)p01 + (uint64_t)p10;
    brio_unsigned_wide low = middle << BRIO_HALF_BITS | (uint64_t)p00;
    brio_unsigned_wide high =
        (brio_unsigned_wide)a1 * b1 + (p01 >> BRIO_HALF_BITS) + (p10 >> BRIO_HALF_BITS) + (middle >> BRIO_HALF_BITS);
    if (negative != (s < 0)) {
        low = -low;
        high = ~high + (low == 0);
    }
    sum->low += low;
    sum->high += high + (sum->low < low);
}

static inline int brio_sum256_sign(brio_sum256 sum) {
    if (sum.high >> (BRIO_WIDE_BITS - 1)) return -1;
    return (sum.high | sum.low) != 0;
}

#endif
