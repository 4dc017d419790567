/* Powers of two, and numbers times one of them. */
#ifndef BRIO_BASE_SCALE_H
#define BRIO_BASE_SCALE_H

#include "base/context.h"
#include "base/parallel.h"
#include <math.h>
#include <string.h>

/** 2^exponent for the exponents of normal numbers, -1022 to 1023, without a call. */
static inline double brio_power_of_two(int exponent) {
    uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/** out[i] = x[i] 2^exponent, i < n, -0 made 0, by all threads; out may be x. */
static inline void brio_scale(const brio_context *ctx, const double *x, size_t n, int exponent, double *out) {
    bool by_product = exponent > -1000 && exponent < 1000; /* the factor is a normal number, and the result the same */
    double factor = by_product ? brio_power_of_two(exponent) : 0;
    int threads = brio_context_threads(ctx);
    (void)threads; /* without OpenMP */
    BRIO_OMP(parallel for num_threads(threads) if (n > 4096))
    for (size_t i = 0; i < n; i++) out[i] = (by_product ? x[i] * factor : ldexp(x[i], exponent)) + 0.0;
}

#endif
