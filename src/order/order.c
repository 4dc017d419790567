/* Biased randomized insertion order (BRIO) and its plainer relatives.
 *
 * Each point draws the round it is inserted in: the last with probability 1 - ratio, the one before with probability
 * (1 - ratio) ratio, and so on; inside a round points follow a Hilbert curve. The early rounds are a random sample of
 * everything, which keeps the expected work of the randomized analysis; the curve makes one insertion touch the memory
 * that the one before has touched.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 5.3.
 * Differs from the paper: a Hilbert curve in place of octree blocks; a ratio of 1/8 in place of 1/2, which inserts
 * fewer points into a coarse triangulation. */
#include "order/order.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "order/hilbert.h"
#include <math.h>

enum { CURVE_BITS = 16, ROUND_BITS = 6, ROUNDS = 1 << ROUND_BITS };

/* Number of the round of a point: ROUNDS - 1 is the last. u uniform in [0, 1). */
static uint64_t round_of(double u, double inverse_log_ratio, uint64_t most_back) {
    double back = floor(log1p(-u) * inverse_log_ratio);
    return ROUNDS - 1 - (back < (double)most_back ? (uint64_t)back : most_back);
}

/* Rounds smaller than a handful of points are merged into the first. */
static uint64_t rounds_back(size_t n, double ratio) {
    double rounds = floor(log((double)n / 16 + 1) / -log(ratio));
    return rounds < ROUNDS - 1 ? (uint64_t)rounds : ROUNDS - 1;
}

static void add_rounds(uint64_t *keys, size_t n, const brio_options *options) {
    double inverse = 1 / log(options->round_ratio);
    uint64_t most = rounds_back(n, options->round_ratio);
    for (size_t i = 0; i < n; i++) {
        double u = (double)(brio_mix(options->seed + brio_mix(i)) >> 11) * 0x1p-53;
        keys[i] |= round_of(u, inverse, most) << (3 * CURVE_BITS);
    }
}

static void random_keys(uint64_t *keys, size_t n, uint64_t seed) {
    for (size_t i = 0; i < n; i++) keys[i] = brio_mix(seed + brio_mix(i));
}

brio_status brio_order_points(brio_context *ctx, const double *points, size_t n, const brio_options *options,
                              uint32_t *order) {
    brio_status status = BRIO_OK;
    uint64_t *keys = NULL;
    for (size_t i = 0; i < n; i++) order[i] = (uint32_t)i;
    if (options->order == BRIO_ORDER_INPUT) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(ctx, keys, n));
    int bits = 64;
    if (options->order == BRIO_ORDER_RANDOM) {
        random_keys(keys, n, options->seed);
    } else {
        bits = 3 * CURVE_BITS;
        brio_hilbert_keys(points, n, CURVE_BITS, keys);
        if (options->order == BRIO_ORDER_BRIO) {
            add_rounds(keys, n, options);
            bits += ROUND_BITS;
        }
    }
    BRIO_TRY(brio_radix_sort(ctx, keys, order, n, bits));
done:
    brio_release(ctx, keys);
    return status;
}
