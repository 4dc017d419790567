/* Exact arithmetic on dyadic numbers (integers times a power of two), the last stage of every predicate. Sums,
 * differences and products have no rounding, overflow or underflow.
 *
 * value = sign * (limb[0] + limb[1] B + ... + limb[size-1] B^(size-1)) * B^low,   B = 2^64
 * I1: sign is 0 exactly when size is 0.   I2: the first and the last limb are not 0.
 *
 * BRIO_DYADIC_CAPACITY is derived from the longest of two polynomials. The in-sphere determinant: A difference of
 * doubles spans 2098 bits or 34 limbs. A sum of three squares takes 69 limbs, and 70 with a weight. A 3 by 3 minor of
 * differences takes 103 limbs. The sum of four products of a lift and a minor takes 175 limbs. The test of
 * brio_attached for a facet: a scalar product of differences, also less a weight, is a multiple of 2^-2148 below 2^2053
 * and so takes 67 limbs once its leading zeros are dropped; products of three of these take 201 limbs, their sum two
 * more. */
#ifndef BRIO_PREDICATES_DYADIC_H
#define BRIO_PREDICATES_DYADIC_H

#include <stdint.h>

enum { BRIO_DYADIC_CAPACITY = 206 };

typedef struct {
    int32_t sign, low, size;
    uint64_t limb[BRIO_DYADIC_CAPACITY];
} brio_dyadic;

/** Sets r = x, for any finite x. */
void brio_dyadic_set(brio_dyadic *r, double x);
/** Sets r = x - y, for any finite x and y. */
void brio_dyadic_difference(brio_dyadic *r, double x, double y);
/** Sets r = x + s y, where s is 1 or -1; r may be x or y. */
void brio_dyadic_add(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y, int s);
/** Sets r = x y; r is neither x nor y. */
void brio_dyadic_multiply(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y);
/** Returns m and writes e such that x = m 2^e with 0.5 <= |m| < 1, up to a relative error of 2^-52; m = 0 for x = 0. */
double brio_dyadic_to_double(const brio_dyadic *x, int *e);

#endif
