/* The powers of two between which the bits of numbers lie. They show whether points are on a common grid, and how
 * fine. */
#ifndef BRIO_PREDICATES_SPAN_H
#define BRIO_PREDICATES_SPAN_H

#include <assert.h>
#include <math.h>
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

#endif
