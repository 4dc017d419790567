/* Sorting in place, without workspace: insertion sort for at most FEW entries, otherwise heapsort.
 *
 * Based on: Williams. Algorithm 232: Heapsort. Communications of the ACM 1964. */
#include "base/sort.h"

/* Chosen. */
enum { FEW = 24 };

/* --- keys --- */

static void insert_keys(uint64_t *keys, size_t n) {
    for (size_t i = 1; i < n; i++) {
        uint64_t moved = keys[i];
        size_t j = i;
        for (; j > 0 && keys[j - 1] > moved; j--) keys[j] = keys[j - 1];
        keys[j] = moved;
    }
}

/* Restores the heap below `root` after its key has become smaller. */
static void sift_key_down(uint64_t *keys, size_t root, size_t n) {
    uint64_t moved = keys[root];
    for (size_t child; (child = 2 * root + 1) < n; root = child) {
        if (child + 1 < n && keys[child + 1] > keys[child]) child++;
        if (keys[child] <= moved) break;
        keys[root] = keys[child];
    }
    keys[root] = moved;
}

void brio_sort_keys(uint64_t *keys, size_t n) {
    if (n <= FEW) {
        insert_keys(keys, n);
        return;
    }
    for (size_t i = n / 2; i-- > 0;) sift_key_down(keys, i, n);
    for (size_t last = n; last-- > 1;) {
        uint64_t top = keys[0];
        keys[0] = keys[last], keys[last] = top;
        sift_key_down(keys, 0, last);
    }
}

/* --- indices, by a comparison --- */

static void insert_indices(uint32_t *a, size_t n, brio_compare_fn compare, const void *user) {
    for (size_t i = 1; i < n; i++) {
        uint32_t moved = a[i];
        size_t j = i;
        for (; j > 0 && compare(moved, a[j - 1], user) < 0; j--) a[j] = a[j - 1];
        a[j] = moved;
    }
}

static void sift_index_down(uint32_t *a, size_t root, size_t n, brio_compare_fn compare, const void *user) {
    uint32_t moved = a[root];
    for (size_t child; (child = 2 * root + 1) < n; root = child) {
        if (child + 1 < n && compare(a[child], a[child + 1], user) < 0) child++;
        if (compare(moved, a[child], user) >= 0) break;
        a[root] = a[child];
    }
    a[root] = moved;
}

void brio_sort_indices(uint32_t *a, size_t n, brio_compare_fn compare, const void *user) {
    if (n <= FEW) {
        insert_indices(a, n, compare, user);
        return;
    }
    for (size_t i = n / 2; i-- > 0;) sift_index_down(a, i, n, compare, user);
    for (size_t last = n; last-- > 1;) {
        uint32_t top = a[0];
        a[0] = a[last], a[last] = top;
        sift_index_down(a, 0, last, compare, user);
    }
}
