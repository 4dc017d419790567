/* Orders of samples and tetrahedra that their positions give, and no list.
 *
 * What changes one place after another, and each in view of the last, has a result that depends on the order. In the
 * order of a list, what happens at a place depends on all places before it, and a point more anywhere moves them. In
 * the order of a hash of the positions it depends on a place beside it only if that one's hash is less, on one beside
 * that again only if that one's is less still: chains of places are short, whatever else there is. So a part of the
 * samples, with what is round it, tells what all of them would. */
#ifndef BRIO_RECONSTRUCT_HASH_ORDER_H
#define BRIO_RECONSTRUCT_HASH_ORDER_H

#include "base/sort.h"
#include "dual/pole_vectors.h"
#include "predicates/predicates.h"

/** Returns the hash of the positions of a tetrahedron, whatever the order of its vertices. Sums of such hashes are
 *  hashes of sets of tetrahedra. */
static inline uint64_t brio_tet_hash(const brio_pole_vectors *v, size_t tet) {
    uint64_t sum = 0;
    for (int i = 0; i < 4; i++) {
        uint32_t p = v->t.tet[tet].vertex[i];
        sum += p == v->t.infinite ? 1 : brio_position_hash(v->points + 3 * (size_t)p);
    }
    return brio_mix(sum);
}

/** Compares samples by their hashes, then by their positions; `points` is the array. */
static inline int brio_compare_hashes(uint32_t a, uint32_t b, const void *points) {
    const double *p = (const double *)points + 3 * (size_t)a, *q = (const double *)points + 3 * (size_t)b;
    uint64_t x = brio_position_hash(p), y = brio_position_hash(q);
    return x != y ? (x > y) - (x < y) : brio_lexicographic(p, q);
}

#endif
