/* A hash of points with their indices, by which a triangulation knows the points that it was made of. Numbers are mixed
 * by products of 128 bits. The constants are odd and have no pattern; chosen. */
#ifndef BRIO_BASE_POINTS_HASH_H
#define BRIO_BASE_POINTS_HASH_H

#include "base/wide.h"
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/** Returns the two halves of a product, joined. */
static inline uint64_t brio_fold(uint64_t a, uint64_t b) {
    uint64_t high, low = brio_multiply_add(a, b, 0, 0, &high);
    return low ^ high;
}

/** Returns the hash of one point. The hash of an array is the sum of these, which may be
 *  added up in any sequence, by several threads.
 *  record  three coordinates and a weight, 0 where there are none; no -0. */
static inline uint64_t brio_point_hash(size_t index, const double *record) {
    uint64_t bits[4];
    memcpy(bits, record, sizeof bits);
    uint64_t first = brio_fold(bits[0] ^ UINT64_C(0x9e3779b97f4a7c15), bits[1] ^ UINT64_C(0xc2b2ae3d27d4eb4f));
    uint64_t second = brio_fold(bits[2] ^ UINT64_C(0x165667b19e3779f9), bits[3] ^ UINT64_C(0xd6e8feb86659fd93));
    return brio_fold(first ^ index, second ^ UINT64_C(0xa0761d6478bd642f));
}

#endif
