/* Exact arithmetic on dyadic numbers, by schoolbook sums and products of 64-bit limbs. */
#include "predicates/dyadic.h"
#include "base/wide.h"
#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#ifndef NDEBUG
/* Returns whether a number keeps I1 and I2. */
static bool is_normal(const brio_dyadic *x) {
    if (x->sign == 0 || x->size == 0) return x->sign == 0 && x->size == 0;
    return 0 < x->size && x->size <= BRIO_DYADIC_CAPACITY && x->limb[0] && x->limb[x->size - 1];
}
#endif

/* Restores I1 and I2 after an operation that may have left zero limbs at either end. */
static void trim(brio_dyadic *r) {
    assert(0 <= r->size && r->size <= BRIO_DYADIC_CAPACITY);
    while (r->size && r->limb[r->size - 1] == 0) r->size--;
    if (!r->size) {
        r->sign = r->low = 0;
        return;
    }
    int32_t zeros = 0;
    while (r->limb[zeros] == 0) zeros++;
    if (!zeros) return;
    r->size -= zeros;
    r->low += zeros;
    memmove(r->limb, r->limb + zeros, (size_t)r->size * sizeof *r->limb);
    assert(is_normal(r));
}

void brio_dyadic_set(brio_dyadic *r, double x) {
    int e;
    uint64_t mantissa = (uint64_t)ldexp(fabs(frexp(x, &e)), 53);
    e -= 53; /* |x| = mantissa 2^e */
    int32_t low = e >= 0 ? e / 64 : -((63 - e) / 64);
    int shift = e - 64 * low;
    r->sign = x > 0 ? 1 : -1;
    r->low = low;
    r->size = 2;
    r->limb[0] = mantissa << shift;
    r->limb[1] = shift ? mantissa >> (64 - shift) : 0;
    trim(r);
}

void brio_dyadic_difference(brio_dyadic *r, double x, double y) {
    brio_dyadic b;
    brio_dyadic_set(r, x);
    brio_dyadic_set(&b, y);
    brio_dyadic_add(r, r, &b, -1);
}

/* Returns the factor of B^k in |x|. */
static inline uint64_t limb_at(const brio_dyadic *x, int32_t k) {
    return k >= x->low && k < x->low + x->size ? x->limb[k - x->low] : 0;
}

static int compare_magnitude(const brio_dyadic *x, const brio_dyadic *y) {
    int32_t top = x->low + x->size, other = y->low + y->size;
    if (top != other) return top > other ? 1 : -1;
    int32_t low = x->low < y->low ? x->low : y->low;
    for (int32_t k = top - 1; k >= low; k--) {
        uint64_t a = limb_at(x, k), b = limb_at(y, k);
        if (a != b) return a > b ? 1 : -1;
    }
    return 0;
}

void brio_dyadic_add(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y, int s) {
    assert((s == 1 || s == -1) && is_normal(x) && is_normal(y));
    if (!x->sign || !y->sign) {
        const brio_dyadic *z = x->sign ? x : y;
        int sign = x->sign ? x->sign : s * y->sign, low = z->low, size = z->size;
        memmove(r->limb, z->limb, (size_t)size * sizeof *r->limb);
        r->sign = sign, r->low = low, r->size = size;
        return;
    }
    int sign = x->sign, same = x->sign == s * y->sign;
    if (!same && compare_magnitude(x, y) < 0) {
        const brio_dyadic *swap = x;
        x = y, y = swap;
        sign = -sign;
    }
    int32_t low = x->low < y->low ? x->low : y->low;
    int32_t top_x = x->low + x->size, top_y = y->low + y->size, top = top_x > top_y ? top_x : top_y;
    brio_dyadic sum;
    unsigned char carry = 0;
    for (int32_t k = low; k < top; k++) {
        uint64_t a = limb_at(x, k), b = limb_at(y, k), c, d;
        if (same) {
            unsigned char first = __builtin_add_overflow(a, b, &c);
            carry = first | __builtin_add_overflow(c, (uint64_t)carry, &d);
        } else {
            unsigned char first = __builtin_sub_overflow(a, b, &c);
            carry = first | __builtin_sub_overflow(c, (uint64_t)carry, &d);
        }
        assert(k - low < BRIO_DYADIC_CAPACITY);
        sum.limb[k - low] = d;
    }
    sum.size = top - low;
    assert(same || !carry); /* the greater magnitude is first */
    assert(sum.size + carry <= BRIO_DYADIC_CAPACITY);
    if (carry) sum.limb[sum.size++] = 1;
    r->sign = sign, r->low = low, r->size = sum.size;
    memcpy(r->limb, sum.limb, (size_t)sum.size * sizeof *r->limb);
    trim(r);
}

void brio_dyadic_multiply(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y) {
    assert(r != x && r != y && is_normal(x) && is_normal(y));
    assert(x->size + y->size <= BRIO_DYADIC_CAPACITY);
    r->sign = x->sign * y->sign;
    r->low = x->low + y->low;
    r->size = r->sign ? x->size + y->size : 0;
    memset(r->limb, 0, (size_t)r->size * sizeof *r->limb);
    if (!r->sign) {
        r->low = 0;
        return;
    }
    for (int32_t i = 0; i < x->size; i++) {
        uint64_t carry = 0;
        for (int32_t j = 0; j < y->size; j++)
            r->limb[i + j] = brio_multiply_add(x->limb[i], y->limb[j], r->limb[i + j], carry, &carry);
        r->limb[i + y->size] = carry;
    }
    trim(r);
}

double brio_dyadic_to_double(const brio_dyadic *x, int *e) {
    *e = 0;
    if (!x->sign) return 0;
    int32_t top = x->low + x->size;
    double high = (double)limb_at(x, top - 1), low = (double)limb_at(x, top - 2) * 0x1p-64;
    double m = frexp(high + low, e);
    *e += 64 * (top - 1);
    return x->sign * m;
}
