/* Sums of doubles without rounding errors: the same in every order, rounded once.
 *
 * A sum is a whole number of 2^-1074, in digits to the base 2^32. A term adds less than 2^33 to a digit, so that
 * CARRY_AFTER terms stay below 2^63.
 *
 * Based on: Kulisch, Miranker. The arithmetic of the digital computer: a new approach. SIAM Review 1986 (one long
 *           accumulator). */
#ifndef BRIO_CERTIFICATE_EXACT_SUM_H
#define BRIO_CERTIFICATE_EXACT_SUM_H

#include <math.h>
#include <stdint.h>

enum { BRIO_EXACT_DIGITS = 68, BRIO_CARRY_AFTER = 1 << 29 };

/** The digits, the least one first. Zeros: nothing was added. After brio_exact_carry all digits but the last are from 0
 *  to 2^32 - 1, and the last one has the sign. */
typedef struct {
    int64_t digit[BRIO_EXACT_DIGITS];
    uint64_t terms;    /* since the last carry */
    uint64_t infinite; /* terms that are no finite numbers */
} brio_exact_sum;

static inline void brio_exact_carry(brio_exact_sum *s) {
    int64_t rest = 0;
    for (int i = 0; i + 1 < BRIO_EXACT_DIGITS; i++) {
        rest += s->digit[i];
        int64_t digit = rest & UINT32_MAX;
        s->digit[i] = digit;
        rest = (rest - digit) / (INT64_C(1) << 32);
    }
    s->digit[BRIO_EXACT_DIGITS - 1] += rest;
    s->terms = 0;
}

static inline void brio_exact_add(brio_exact_sum *s, double x) {
    int exponent;
    if (!isfinite(x)) s->infinite++;
    if (!isfinite(x) || x == 0) return;
    uint64_t mantissa = (uint64_t)ldexp(frexp(fabs(x), &exponent), 53);
    int at = exponent - 53 + 1074;
    if (at < 0) mantissa >>= -at, at = 0; /* of a subnormal number: these bits are 0 */
    uint64_t low = (mantissa & UINT32_MAX) << at % 32, high = (mantissa >> 32) << at % 32;
    int64_t *digit = s->digit + at / 32, sign = x < 0 ? -1 : 1;
    digit[0] += sign * (int64_t)(low & UINT32_MAX);
    digit[1] += sign * (int64_t)((low >> 32) + (high & UINT32_MAX));
    digit[2] += sign * (int64_t)(high >> 32);
    if (++s->terms == BRIO_CARRY_AFTER) brio_exact_carry(s);
}

/** Adds a sum.   from  carried. */
static inline void brio_exact_add_sum(brio_exact_sum *to, const brio_exact_sum *from) {
    for (int i = 0; i < BRIO_EXACT_DIGITS; i++) to->digit[i] += from->digit[i];
    to->infinite += from->infinite;
    brio_exact_carry(to);
}

/** Returns the sum, rounded to the nearest double; INFINITY if a term was not finite. */
static inline double brio_exact_rounded(const brio_exact_sum *sum) {
    brio_exact_sum s = *sum;
    int top = BRIO_EXACT_DIGITS - 1, bits = 0;
    brio_exact_carry(&s);
    double sign = s.digit[top] < 0 ? -1 : 1;
    if (s.infinite) return INFINITY;
    for (int i = 0; sign < 0 && i < BRIO_EXACT_DIGITS; i++) s.digit[i] = -s.digit[i];
    brio_exact_carry(&s);
    while (top > 1 && !s.digit[top]) top--;
    uint64_t first = (uint64_t)s.digit[top], second = (uint64_t)s.digit[top - 1];
    uint64_t third = top > 1 ? (uint64_t)s.digit[top - 2] : 0;
    while (bits < 32 && first >> bits) bits++;
    uint64_t rest = bits ? third << (64 - bits) : 0;
    uint64_t high = (first << 32 | second) << (32 - bits) | third >> bits;
    for (int i = 0; i < top - 2; i++) rest |= (uint64_t)s.digit[i];
    return sign * ldexp((double)(high | (rest != 0)), 32 * (top - 1) - (32 - bits) - 1074);
}

#endif
