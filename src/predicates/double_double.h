/* Double-double arithmetic, the third stage of the predicates. A number is an unevaluated sum hi + lo of two doubles,
 * about 106 bits. With u = 2^-53, and without overflow and underflow:
 *   |product - x y| <= 7 u^2 |x y|,   |sum - (x + y)| <= 3 u^2 (|x| + |y|) (1 + u).
 * dd_add has no error bound relative to the result. The predicates need only a bound relative to the permanent.
 *
 * `fma` is a compile-time constant. With fma the error of a product takes one instruction, otherwise Dekker's 17.
 *
 * Based on: Dekker. A floating-point technique for extending the available precision. Numer. Math. 1971.
 *           Joldes, Muller, Popescu. Tight and rigorous error bounds for basic building blocks of double-word
 *           arithmetic. TOMS 2017. */
#ifndef BRIO_PREDICATES_DOUBLE_DOUBLE_H
#define BRIO_PREDICATES_DOUBLE_DOUBLE_H

#include "base/instruction_set.h"
#include <stdbool.h>

#define BRIO_INLINE static inline __attribute__((always_inline))

/* Whether every processor of the compilation target has fused multiply-add. */
#if defined(__FMA__) || defined(__aarch64__)
#define DD_TARGET_HAS_FMA true
#else
#define DD_TARGET_HAS_FMA false
#endif

typedef struct {
    double hi, lo;
} brio_dd;

BRIO_INLINE brio_dd dd_two_sum(double a, double b) {
    double s = a + b, t = s - a;
    return (brio_dd){s, (a - (s - t)) + (b - t)};
}

BRIO_INLINE brio_dd dd_fast_two_sum(double a, double b) {
    double s = a + b;
    return (brio_dd){s, b - (s - a)};
}

/* Returns a - b, exactly. */
BRIO_INLINE brio_dd dd_difference(double a, double b) {
    return dd_two_sum(a, -b);
}

BRIO_INLINE brio_dd dd_two_product(double a, double b, const bool fma) {
    double p = a * b;
    if (fma) return (brio_dd){p, __builtin_fma(a, b, -p)};
    double ca = 134217729.0 * a, cb = 134217729.0 * b;
    double ah = ca - (ca - a), bh = cb - (cb - b), al = a - ah, bl = b - bh;
    return (brio_dd){p, al * bl - (((p - ah * bh) - al * bh) - ah * bl)};
}

BRIO_INLINE brio_dd dd_multiply(brio_dd x, brio_dd y, const bool fma) {
    brio_dd p = dd_two_product(x.hi, y.hi, fma);
    return dd_fast_two_sum(p.hi, p.lo + (x.hi * y.lo + x.lo * y.hi));
}

BRIO_INLINE brio_dd dd_add(brio_dd x, brio_dd y) {
    brio_dd s = dd_two_sum(x.hi, y.hi);
    return dd_fast_two_sum(s.hi, s.lo + (x.lo + y.lo));
}

BRIO_INLINE brio_dd dd_subtract(brio_dd x, brio_dd y) {
    return dd_add(x, (brio_dd){-y.hi, -y.lo});
}

/* Returns x y - z w, the 2 by 2 minor. */
BRIO_INLINE brio_dd dd_minor(brio_dd x, brio_dd y, brio_dd z, brio_dd w, const bool fma) {
    return dd_subtract(dd_multiply(x, y, fma), dd_multiply(z, w, fma));
}

/* Returns x + y + z. */
BRIO_INLINE brio_dd dd_sum3(brio_dd x, brio_dd y, brio_dd z) {
    return dd_add(dd_add(x, y), z);
}

#if defined(__x86_64__) && !defined(__FMA__)
#define BRIO_TARGET_FMA __attribute__((target("fma")))
#else
#define BRIO_TARGET_FMA
#endif

#endif
