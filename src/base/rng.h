/* Random numbers that depend on a seed and an index only: SplitMix64, a bijective mixer of a counter. The number of an
 * index needs no state, so it is the same for every number of threads.
 *
 * Based on: Steele, Lea, Flood. Fast splittable pseudorandom number generators. OOPSLA 2014. */
#ifndef BRIO_BASE_RNG_H
#define BRIO_BASE_RNG_H

#include <assert.h>
#include <stdint.h>

/** The seed that options of 0 stand for. */
#define BRIO_SEED UINT64_C(1)

/** Returns the bits of x mixed by a bijection. */
static inline uint64_t brio_mix(uint64_t x) {
    x += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

/** Returns the random number of an index. */
static inline uint64_t brio_hash(uint64_t seed, uint64_t index) {
    return brio_mix(seed + brio_mix(index));
}

typedef struct {
    uint64_t state;
} brio_rng;

static inline brio_rng brio_rng_new(uint64_t seed) {
    return (brio_rng){brio_mix(seed)};
}

static inline uint64_t brio_rng_next(brio_rng *rng) {
    return brio_mix(rng->state++);
}

/** Returns a number that is uniform in [0, 1). */
static inline double brio_rng_double(brio_rng *rng) {
    return (double)(brio_rng_next(rng) >> 11) * 0x1p-53;
}

/** Returns a number that is uniform in [0, n), n < 2^32. */
static inline uint32_t brio_rng_below(brio_rng *rng, uint32_t n) {
    assert(n > 0);
    return (uint32_t)(((brio_rng_next(rng) >> 32) * (uint64_t)n) >> 32);
}

#endif
