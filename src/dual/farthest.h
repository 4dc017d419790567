/* The farthest Voronoi vertex that is offered to a sample.
 *
 * What is on offer is a key: the upper half of the bits of a squared distance over the number of a tetrahedron. One look
 * at the keys decides most offers; where the upper halves are equal, the caller's comparison decides. The comparison is
 * a total order that extends the order of the distances, so the farthest one wins, whichever thread offers it and when. */
#ifndef BRIO_DUAL_FARTHEST_H
#define BRIO_DUAL_FARTHEST_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/** BRIO_NO_FARTHEST: nothing was offered. Its lower half is no tetrahedron.
 *  BRIO_ENDLESS: the upper half of a key, above that of every distance. */
static const uint64_t BRIO_NO_FARTHEST = UINT32_MAX, BRIO_ENDLESS = (uint64_t)UINT32_MAX << 32;

/** Whether the Voronoi vertex of tetrahedron `tet` is farther from the sample than that of `than`. */
typedef bool (*brio_farther_fn)(const void *user, uint32_t tet, uint32_t than, uint32_t sample);

/** The key of a squared distance, which is not NaN, and a tetrahedron. */
static inline uint64_t brio_farthest_key(double square, uint32_t tet) {
    uint64_t bits;
    memcpy(&bits, &square, sizeof bits);
    return (bits & BRIO_ENDLESS) | tet;
}

static inline uint32_t brio_farthest_tet(uint64_t key) {
    return (uint32_t)key;
}

/** A quick look, which most keys do not pass. Relaxed: the look reads nothing but the key, and a key is only ever replaced
 *  by a farther one, so what is nearer than an old key is nearer than the present one. */
static inline bool brio_may_be_farthest(uint64_t key, const uint64_t *place) {
    return key >> 32 >= __atomic_load_n(place, __ATOMIC_RELAXED) >> 32;
}

/** Puts a key in its place unless a farther one is there.   alone  no other thread offers meanwhile.
 *
 *  `farther` reads the centre of the present tetrahedron, which another thread may have written in the same run, before
 *  it offered the key. The release of the exchange that puts a key there pairs with the acquire of the load, and of an
 *  exchange that fails: whoever reads a key sees the centre. */
static inline __attribute__((always_inline)) void brio_offer_farthest(uint64_t *place, uint64_t key, bool alone,
                                                                      brio_farther_fn farther, const void *user,
                                                                      uint32_t sample) {
    uint64_t now = __atomic_load_n(place, __ATOMIC_ACQUIRE);
    while (key >> 32 != now >> 32
               ? key >> 32 > now >> 32
               : now == BRIO_NO_FARTHEST || farther(user, brio_farthest_tet(key), brio_farthest_tet(now), sample)) {
        if (alone) {
            *place = key;
            return;
        }
        if (__atomic_compare_exchange_n(place, &now, key, true, __ATOMIC_RELEASE, __ATOMIC_ACQUIRE)) return;
    }
}

#endif
