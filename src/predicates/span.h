/* The powers of two between which the bits of numbers lie. They show whether points are on a common grid, and how
 * fine. Also records times a power of two: in far too large or too small a unit the products of a predicate overflow or
 * vanish, and each call would be exact. */
#ifndef BRIO_PREDICATES_SPAN_H
#define BRIO_PREDICATES_SPAN_H

#include "base/scale.h"
#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/** The span of a set of numbers that are multiples of 2^low and less than 2^high in magnitude. */
typedef struct {
    int low, high;
} brio_span;

/** The span of the empty set. Every number except 0 widens it: 0 has no bits and leaves a span unchanged. */
static const brio_span BRIO_NO_SPAN = {INT32_MAX, INT32_MIN};

/** Returns the span of a finite number. */
static inline brio_span brio_span_of(double x) {
    assert(isfinite(x));
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int exponent = (int)(bits >> 52 & 0x7ff);
    uint64_t mantissa = bits & ((UINT64_C(1) << 52) - 1);
    if (exponent == 0)
        exponent = 1; /* subnormal, or zero */
    else
        mantissa |= UINT64_C(1) << 52;
    if (!mantissa) return BRIO_NO_SPAN;
    return (brio_span){exponent - 1075 + __builtin_ctzll(mantissa), exponent - 1075 + 64 - __builtin_clzll(mantissa)};
}

static inline void brio_span_add(brio_span *s, double x) {
    brio_span own = brio_span_of(x);
    s->low = own.low < s->low ? own.low : s->low;
    s->high = own.high > s->high ? own.high : s->high;
}

/** Returns the largest integer h with 2 h <= exponent. Weights are in units of 2^(2 h) on a grid with unit 2^h. */
static inline int brio_half_exponent(int exponent) {
    return exponent >= 0 ? exponent / 2 : -((1 - exponent) / 2);
}

typedef struct {
    double row[5][4];
    double most_weight; /* the greatest difference of weights */
} brio_near_one;

/** Brings the greatest difference of the records from the last one to between 1/2 and 1. A coordinate may lose 2^-1073
 *  by underflow. Returns false where all records are at one position, or where a weight is over most_weight then.
 *  count  2 to 5.   weighted  false: all weights become 0. */
static inline bool brio_bring_near_one(const double *const *row, int count, bool weighted, double most_weight,
                                       brio_near_one *out) {
    const double *last = row[count - 1];
    double half = 0; /* of the greatest difference, which may not be finite */
    int exponent;
    for (int i = 0; i < count - 1; i++)
        for (int k = 0; k < 3; k++) half = fmax(half, fabs(row[i][k] / 2 - last[k] / 2));
    if (half == 0) return false;
    frexp(half, &exponent);
    int first = -(exponent + 1) / 2; /* 2^-(exponent + 1) may be no double */
    double s = brio_power_of_two(first), t = brio_power_of_two(-(exponent + 1) - first);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) out->row[i][k] = row[i][k] * s * t;
        out->row[i][3] = weighted ? row[i][3] * s * s * t * t : 0;
        if (!(fabs(out->row[i][3]) <= most_weight)) return false;
    }
    out->most_weight = 0;
    for (int i = 0; i < count - 1; i++)
        out->most_weight = fmax(out->most_weight, fabs(out->row[i][3] - out->row[count - 1][3]));
    return true;
}

/** Returns whether overflow or underflow, which costs `floor` at most, may cost more than the rounding of
 *  double-doubles does. */
static inline bool brio_floor_matters(double permanent, double floor) {
    return !(floor < 0x1p-99 * permanent && permanent < INFINITY);
}

#endif
