/* Products of 128 bits, with the compiler's integers of 128 bits or, where it has none (32-bit processors), without
 * them. The option BRIO_USE_INT128 of CMake leaves those of the compiler out, for tests. */
#ifndef BRIO_BASE_WIDE_H
#define BRIO_BASE_WIDE_H

#include <assert.h>
#include <stdint.h>

#if defined(__SIZEOF_INT128__) && !defined(BRIO_WITHOUT_INT128)
#define BRIO_HAS_INT128 1
#else
#define BRIO_HAS_INT128 0
#endif

/** Returns the lower half of a b + c + d, and its upper half in *high. The sum always fits 128 bits. */
static inline uint64_t brio_multiply_add(uint64_t a, uint64_t b, uint64_t c, uint64_t d, uint64_t *high) {
#if BRIO_HAS_INT128
    __extension__ typedef unsigned __int128 wide;
    wide sum = (wide)a * b + c + d;
    *high = (uint64_t)(sum >> 64);
    return (uint64_t)sum;
#else
    uint64_t a0 = (uint32_t)a, a1 = a >> 32, b0 = (uint32_t)b, b1 = b >> 32;
    uint64_t first = a0 * b0, second = a1 * b0 + (first >> 32), third = a0 * b1 + (uint32_t)second;
    uint64_t low = third << 32 | (uint32_t)first, sum = low + c, all = sum + d;
    *high = a1 * b1 + (second >> 32) + (third >> 32) + (sum < low) + (all < sum);
    return all;
#endif
}

/** Returns the quotient of high 2^64 + low and the divisor, and the remainder; high < divisor, and the divisor's
 *  highest bit is set. Digit by digit: rare and short. */
static inline uint64_t brio_divide_wide(uint64_t high, uint64_t low, uint64_t divisor, uint64_t *remainder) {
    assert(high < divisor && divisor >> 63);
#if BRIO_HAS_INT128
    __extension__ typedef unsigned __int128 wide;
    wide dividend = (wide)high << 64 | low;
    uint64_t quotient = (uint64_t)(dividend / divisor);
    *remainder = low - quotient * divisor;
    return quotient;
#else
    uint64_t quotient = 0;
    for (int i = 63; i >= 0; i--) {
        uint64_t carry = high >> 63;
        high = high << 1 | (low >> i & 1);
        quotient <<= 1;
        if (!carry && high < divisor) continue;
        high -= divisor;
        quotient |= 1;
    }
    *remainder = high;
    return quotient;
#endif
}

#endif
