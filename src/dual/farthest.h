/* The farthest Voronoi vertex that is offered to a sample.
 *
 * An offer is a 64-bit key:
 *   bit 32..63: the upper half of the bits of the squared distance
 *   bit 0..31:  the tetrahedron whose Voronoi vertex is offered
 * The upper halves of two keys decide most offers; where they are equal, the caller's comparison decides. The
 * comparison is a total order that extends the order of distances. So the result depends neither on the thread that
 * offers a key nor on the time of the offer. */
#ifndef BRIO_DUAL_FARTHEST_H
#define BRIO_DUAL_FARTHEST_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/** BRIO_NO_FARTHEST is the key before any offer; its lower half names no tetrahedron.
 *  BRIO_ENDLESS is the upper half of the key of an infinite tetrahedron; it exceeds the upper half of every
 *  distance. */
static const uint64_t BRIO_NO_FARTHEST = UINT32_MAX, BRIO_ENDLESS = (uint64_t)UINT32_MAX << 32;

/** Returns whether the Voronoi vertex of tetrahedron `tet` is farther from the sample than the one of tetrahedron
 *  `than`. */
typedef bool (*brio_farther_fn)(const void *user, uint32_t tet, uint32_t than, uint32_t sample);

/** Returns the key of a squared distance, which is not NaN, and a tetrahedron. */
static inline uint64_t brio_farthest_key(double square, uint32_t tet) {
    assert(!(square < 0));
    uint64_t bits;
    memcpy(&bits, &square, sizeof bits);
    return (bits & BRIO_ENDLESS) | tet;
}

static inline uint32_t brio_farthest_tet(uint64_t key) {
    return (uint32_t)key;
}

/** Returns false when the key at `place` is farther for certain, which settles most offers. Relaxed order is enough:
 *  the test reads only the key, and only a farther key ever replaces it, so a stale key settles an offer correctly. */
static inline bool brio_may_be_farthest(uint64_t key, const uint64_t *place) {
    return key >> 32 >= __atomic_load_n(place, __ATOMIC_RELAXED) >> 32;
}

/** Writes the key to *place unless a farther key is there.   alone  whether no other thread makes offers meanwhile.
 *
 *  `farther` reads the centre of the tetrahedron named at `place`. Another thread may have written this centre in the
 *  same parallel loop, before it offered the key. The exchange that stores a key releases; the load and a failed
 *  exchange acquire. So a thread that reads a key also sees the centre. */
static inline __attribute__((always_inline)) void brio_offer_farthest(uint64_t *place, uint64_t key, bool alone,
                                                                      brio_farther_fn farther, const void *user,
                                                                      uint32_t sample) {
    uint64_t now = __atomic_load_n(place, __ATOMIC_ACQUIRE);
    assert((uint32_t)key != UINT32_MAX); /* bits 0 to 31 name a tetrahedron */
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
