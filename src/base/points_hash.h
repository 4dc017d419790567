/* A hash of points with their indices, by which a triangulation knows the points that it was made of. */
#ifndef BRIO_BASE_POINTS_HASH_H
#define BRIO_BASE_POINTS_HASH_H

#include "base/rng.h"
#include <stddef.h>
#include <string.h>

/** Returns the hash of one point. The hash of an array is the sum of these, so any order of the points gives it.
 *  record  three coordinates and a weight, 0 where there are none; no -0. */
static inline uint64_t brio_point_hash(size_t index, const double *record) {
    static const uint64_t FACTOR[4] = {UINT64_C(0x9e3779b97f4a7c15), UINT64_C(0xc2b2ae3d27d4eb4f),
                                       UINT64_C(0x165667b19e3779f9), UINT64_C(0xd6e8feb86659fd93)};
    uint64_t bits[4], sum = index;
    memcpy(bits, record, sizeof bits);
    for (int k = 0; k < 4; k++) {
        uint64_t product = bits[k] * FACTOR[k];
        sum += product << 16 * k | product >> (64 - 16 * k) % 64; /* rotated, so that high bits do not meet */
    }
    return brio_mix(sum);
}

#endif
