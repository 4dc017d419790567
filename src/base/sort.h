/* Sorting: radix sorts in linear time (sort.c), and in place, of keys and of indices (heap_sort.c). */
#ifndef BRIO_BASE_SORT_H
#define BRIO_BASE_SORT_H

#include "base/context.h"

/** Sorts n pairs by key, keys below 2^bits, stable. Needs 12 n bytes of workspace. */
brio_status brio_radix_sort(brio_context *ctx, uint64_t *keys, uint32_t *values, size_t n, int bits);

/** Sorts n items by the `bits` bits from bit 32 on, stable; spare holds n items, too. `threads` is what brio_threads gave;
 *  the sort uses fewer where n is small. */
brio_status brio_sort_items(brio_context *ctx, uint64_t *items, uint64_t *spare, size_t n, int bits, int threads);

/** Sorts 64-bit keys in place, in O(n log n) for every input. */
void brio_sort_keys(uint64_t *keys, size_t n);

/** Negative, zero or positive, as the first index sorts before, with or after the second. */
typedef int (*brio_compare_fn)(uint32_t, uint32_t, const void *user);

/** Sorts indices in place; not stable, so that `compare` should be 0 for equal indices only where the result must not
 *  depend on the order they come in. No workspace. */
void brio_sort_indices(uint32_t *indices, size_t n, brio_compare_fn compare, const void *user);

/** Unsigned key with the order of the doubles; -0 and 0 have the same. */
uint64_t brio_double_key(double x);

/** An order of the rows of an array: by their first number, then as `compare` says. */
typedef struct {
    const double *rows;
    size_t stride; /* doubles in a row */
    brio_compare_fn compare;
    const void *user; /* of compare */
} brio_row_order;

/** Sorts n indices of rows.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_sort_rows(brio_context *ctx, const brio_row_order *by, uint32_t *indices, size_t n);

#endif
