/* Sorting in place, without workspace: insertion sort for at most FEW entries, otherwise heapsort.
 *
 * Based on: Williams. Algorithm 232: Heapsort. Communications of the ACM 1964. */
#include "base/sort.h"

#define HEAP_ITEM              uint64_t
#define HEAP_ABOVE(a, b, user) ((a) > (b))
#define HEAP_DOWN              key_down
#define HEAP_UP                key_up
#include "base/heap.h"

typedef struct {
    brio_compare_fn compare;
    const void *user;
} index_order;

#define HEAP_ITEM              uint32_t
#define HEAP_ABOVE(a, b, user) (((const index_order *)(user))->compare(b, a, ((const index_order *)(user))->user) < 0)
#define HEAP_DOWN              index_down
#define HEAP_UP                index_up
#include "base/heap.h"

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

/* Sorts keys.   ctx  NULL for a sort that does not look. */
static brio_status heap_sort_keys(brio_context *ctx, uint64_t *keys, size_t n) {
    for (size_t i = n / 2; i-- > 0;) {
        key_down(keys, i, n, keys[i], NULL);
        if (ctx) BRIO_FORWARD(brio_look(ctx, 1));
    }
    for (size_t last = n; last-- > 1;) {
        uint64_t moved = keys[last];
        keys[last] = keys[0];
        key_down(keys, 0, last, moved, NULL);
        if (ctx) BRIO_FORWARD(brio_look(ctx, 1));
    }
    return BRIO_OK;
}

brio_status brio_sort_many_keys(brio_context *ctx, uint64_t *keys, size_t n) {
    if (n > FEW) return heap_sort_keys(ctx, keys, n);
    insert_keys(keys, n);
    return BRIO_OK;
}

void brio_sort_keys(uint64_t *keys, size_t n) {
    brio_sort_many_keys(NULL, keys, n);
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

static brio_status heap_sort_indices(brio_context *ctx, uint32_t *a, size_t n, const index_order *order) {
    for (size_t i = n / 2; i-- > 0;) {
        index_down(a, i, n, a[i], order);
        if (ctx) BRIO_FORWARD(brio_look(ctx, 1));
    }
    for (size_t last = n; last-- > 1;) {
        uint32_t moved = a[last];
        a[last] = a[0];
        index_down(a, 0, last, moved, order);
        if (ctx) BRIO_FORWARD(brio_look(ctx, 1));
    }
    return BRIO_OK;
}

brio_status brio_sort_many_indices(brio_context *ctx, uint32_t *a, size_t n, brio_compare_fn compare,
                                   const void *user) {
    if (n > FEW) return heap_sort_indices(ctx, a, n, &(index_order){compare, user});
    insert_indices(a, n, compare, user);
    return BRIO_OK;
}

void brio_sort_indices(uint32_t *a, size_t n, brio_compare_fn compare, const void *user) {
    brio_sort_many_indices(NULL, a, n, compare, user);
}
