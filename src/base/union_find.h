/* Union-find that any number of threads may change at once.
 *
 * A set is a tree whose root is its least element, and a link only ever goes to a lower one. So the sets and their
 * roots depend on what was united and not on the order; O(log n) amortised for a find.
 *
 * Loads and stores are relaxed, as a link stands for nothing but itself. An element whose link once went to a lower one
 * is never a root again, so an old link also leads to an element of the same set, and halving a path by old links keeps
 * the sets. An element that an old load takes for a root is not linked: the exchange compares it with its present link.
 * Other data of the sets is read after the run.
 *
 * Based on: Anderson, Woll. Wait-free parallel algorithms for the union-find problem. STOC 1991. */
#ifndef BRIO_BASE_UNION_FIND_H
#define BRIO_BASE_UNION_FIND_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

/** Returns the root of the set of i, and halves paths on the way. */
static inline uint32_t brio_find(uint32_t *parent, uint32_t i) {
    for (;;) {
        uint32_t up = __atomic_load_n(&parent[i], __ATOMIC_RELAXED);
        if (up == i) return i;
        assert(up < i); /* a link goes to a lower element */
        uint32_t next = __atomic_load_n(&parent[up], __ATOMIC_RELAXED);
        assert(next <= up);
        if (next != up) __atomic_store_n(&parent[i], next, __ATOMIC_RELAXED);
        i = next;
    }
}

/** Makes one set of the sets of i and j; `alone`: no other thread is at work on them. */
static inline void brio_unite(uint32_t *parent, uint32_t i, uint32_t j, bool alone) {
    for (;;) {
        i = brio_find(parent, i);
        j = brio_find(parent, j);
        if (i == j) return;
        uint32_t low = i < j ? i : j, high = i < j ? j : i, root = high;
        if (alone) {
            parent[high] = low;
            return;
        }
        if (__atomic_compare_exchange_n(&parent[high], &root, low, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) return;
    }
}

#endif
