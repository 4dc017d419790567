/* Exact arithmetic on dyadic numbers (integers times a power of two): sums, differences and products of doubles without
 * any rounding, overflow or underflow. The last stage of every predicate.
 *
 * value = sign * (limb[0] + limb[1] B + ... + limb[size-1] B^(size-1)) * B^low,   B = 2^64
 * Invariants: sign is 0 exactly when size is 0; the first and the last limb are not 0.
 *
 * CAPACITY covers the largest determinant here: a difference of doubles spans 2098 bits = 34 limbs, a sum of three
 * squares 69, less a weight 70, a minor of three differences 103, their product and the sum of four of them 175. */
#ifndef BRIO_PREDICATES_DYADIC_H
#define BRIO_PREDICATES_DYADIC_H

#include <stdint.h>

enum { BRIO_DYADIC_CAPACITY = 180 };

typedef struct {
    int32_t sign, low, size;
    uint64_t limb[BRIO_DYADIC_CAPACITY];
} brio_dyadic;

/** r = x, for any finite x. */
void brio_dyadic_set(brio_dyadic *r, double x);
/** r = x - y. */
void brio_dyadic_difference(brio_dyadic *r, double x, double y);
/** r = x + s y, s = 1 or -1; r may be x or y. */
void brio_dyadic_add(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y, int s);
/** r = x y; r is neither. */
void brio_dyadic_multiply(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y);
/** x = m 2^e with 0.5 <= |m| < 1 up to a relative error of 2^-52; 0 gives m = 0. Returns m. */
double brio_dyadic_to_double(const brio_dyadic *x, int *e);

#endif
