/* How a tetrahedron is turned in the canonical order, and how few of them are sorted (canonical_order.c). */
#ifndef BRIO_TRIANGULATION_CANONICAL_TURN_H
#define BRIO_TRIANGULATION_CANONICAL_TURN_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* The even permutations of four slots: BRIO_TURNED[r][i] comes to slot i; and back. */
static const uint8_t BRIO_TURNED[12][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 0, 3, 2},
                                           {1, 3, 2, 0}, {1, 2, 0, 3}, {2, 0, 1, 3}, {2, 1, 3, 0},
                                           {2, 3, 0, 1}, {3, 0, 2, 1}, {3, 2, 1, 0}, {3, 1, 0, 2}};
static const uint8_t BRIO_BACK[12][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}, {1, 0, 3, 2},
                                         {3, 0, 2, 1}, {2, 0, 1, 3}, {1, 2, 0, 3}, {3, 1, 0, 2},
                                         {2, 3, 0, 1}, {1, 3, 2, 0}, {3, 2, 1, 0}, {2, 1, 3, 0}};

/* Returns the slot of the latest finite vertex. */
static inline unsigned brio_latest_slot(const uint32_t *v, uint32_t infinite) {
    assert(v[0] != infinite && v[1] != infinite && v[2] != infinite); /* I2 */
    unsigned low = v[1] > v[0], high = v[3] != infinite && v[3] > v[2] ? 3 : 2;
    return v[high] > v[low] ? high : low;
}

/* Sets *turn to how a tetrahedron is turned. Returns its key: its second and third vertex, once it is turned. */
static inline uint64_t brio_turn_key(const uint32_t *v, uint32_t infinite, uint8_t *turn) {
    unsigned first = 3 * brio_latest_slot(v, infinite), r = first;
    if (v[3] == infinite) {
        r += first == 3 ? 2 : 0;
    } else {
        const uint8_t *from = BRIO_TURNED[first];
        uint32_t a = v[from[1]], b = v[from[2]], c = v[from[3]];
        unsigned later = b > a;
        r += c > (later ? b : a) ? 2 : later;
    }
    assert(r < 12 && v[BRIO_TURNED[r][0]] == v[brio_latest_slot(v, infinite)]);
    assert(v[3] != infinite || BRIO_TURNED[r][3] == 3); /* I2 */
    *turn = (uint8_t)r;
    return (uint64_t)v[BRIO_TURNED[r][1]] << 32 | v[BRIO_TURNED[r][2]];
}

static inline void brio_sift_down(uint64_t *key, uint32_t *name, size_t root, size_t n) {
    uint64_t moved = key[root];
    uint32_t moved_name = name[root];
    for (size_t child; (child = 2 * root + 1) < n; root = child) {
        if (child + 1 < n && key[child] < key[child + 1]) child++;
        if (moved >= key[child]) break;
        key[root] = key[child], name[root] = name[child];
    }
    key[root] = moved, name[root] = moved_name;
}

static inline void brio_heap_sort(uint64_t *key, uint32_t *name, size_t n) {
    for (size_t i = n / 2; i-- > 0;) brio_sift_down(key, name, i, n);
    for (size_t i = n; i-- > 1;) {
        uint64_t top = key[0];
        uint32_t top_name = name[0];
        key[0] = key[i], name[0] = name[i];
        key[i] = top, name[i] = top_name;
        brio_sift_down(key, name, 0, i);
    }
}

/* Sets out[rank of key[i]] to name[i]. Counts the smaller keys: no branch depends on them. */
static inline void brio_sort_few(const uint64_t *key, const uint32_t *name, size_t n, uint32_t *out) {
    for (size_t i = 0; i < n; i++) {
        size_t rank = 0;
        for (size_t j = 0; j < n; j++) rank += key[j] < key[i];
        assert(rank < n);
        out[rank] = name[i];
    }
}

/** Writes the names by ascending key[i] to `out`. Changes key and name. */
static inline void brio_sort_names(uint64_t *key, uint32_t *name, size_t n, uint32_t *out) {
    enum { FEW = 48 };
    if (n <= FEW) {
        brio_sort_few(key, name, n, out);
    } else {
        brio_heap_sort(key, name, n);
        memcpy(out, name, n * sizeof *out);
    }
}

#endif
