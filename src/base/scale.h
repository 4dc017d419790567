/* Numbers times a power of two, by all threads. */
#ifndef BRIO_BASE_SCALE_H
#define BRIO_BASE_SCALE_H

#include "base/context.h"
#include "base/parallel.h"
#include <math.h>

/** out[i] = x[i] 2^exponent, i < n, -0 made 0; out may be x. */
static inline void brio_scale(const brio_context *ctx, const double *x, size_t n, int exponent, double *out) {
    bool by_product = exponent > -1000 && exponent < 1000; /* the factor is a normal number, and the result the same */
    double factor = by_product ? ldexp(1, exponent) : 0;
    int threads = brio_context_threads(ctx);
    (void)threads; /* without OpenMP */
    BRIO_OMP(parallel for num_threads(threads) if (n > 4096))
    for (size_t i = 0; i < n; i++) out[i] = (by_product ? x[i] * factor : ldexp(x[i], exponent)) + 0.0;
}

#endif
