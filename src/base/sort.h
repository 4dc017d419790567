/* Sorting: radix sorts, and keys by their rank, in linear time (sort.c); sorts of keys and of indices in
 * place (heap_sort.c); keys of numbers, hashes of positions. */
#ifndef BRIO_BASE_SORT_H
#define BRIO_BASE_SORT_H

#include "base/context.h"
#include "base/rng.h"

/** Sorts n pairs by key; the sort is stable.   keys  below 2^bits.   Workspace: 12 n bytes. Looks.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED: then keys and values are in no order, and some may be
 *  lost. */
brio_status brio_radix_sort(brio_context *ctx, uint64_t *keys, uint32_t *values, size_t n, int bits);

/** Sorts n items by their bits 32 to 32 + bits - 1; the sort is stable.
 *  spare    n items, workspace.
 *  threads  what brio_threads returned; the sort uses fewer if n is small.
 *  Looks where the caller may. Returns BRIO_OK, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED: then the items are lost. */
brio_status brio_sort_items(brio_context *ctx, uint64_t *items, uint64_t *spare, size_t n, int bits, int threads);

/** Sorts n keys in place. Cost: O(n log n) for every input. */
void brio_sort_keys(uint64_t *keys, size_t n);

/** Returns a negative number, zero or a positive number if the first index sorts before, with or after the second. */
typedef int (*brio_compare_fn)(uint32_t, uint32_t, const void *user);

/** Sorts n indices in place, without workspace. The sort is not stable: the result is independent of the order of the
 *  input only if `compare` returns 0 for equal indices alone. */
void brio_sort_indices(uint32_t *indices, size_t n, brio_compare_fn compare, const void *user);

/** Sort as the two functions above do, and look. Return BRIO_OK or BRIO_ERR_CANCELLED: then entries are in any order,
 *  and some may be lost. Only the thread that called the library may call these. */
brio_status brio_sort_many_keys(brio_context *ctx, uint64_t *keys, size_t n);
brio_status brio_sort_many_indices(brio_context *ctx, uint32_t *indices, size_t n, brio_compare_fn compare,
                                   const void *user);

/** Writes the key that would be at place `rank` if the keys were sorted. Looks, in the thread that called the library.
 *  rank  below n.   Cost: O(n), without workspace.   Returns BRIO_OK or BRIO_ERR_CANCELLED. */
brio_status brio_key_of_rank(brio_context *ctx, const uint64_t *keys, size_t n, size_t rank, uint64_t *key);

/** Returns a key; keys as unsigned numbers sort as the doubles do. -0 and 0 have one key. */
uint64_t brio_double_key(double x);

/** Returns the hash of a position. Places that are compared by their hashes are in an order that no list gives: it is
 *  the same whatever the places are numbered by, and whatever other places there are. -0 and 0 have one hash. */
static inline uint64_t brio_position_hash(const double p[3]) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) hash = brio_hash(hash, brio_double_key(p[k]));
    return hash;
}

/** An order of the rows of an array: by their first number, then by `compare`. */
typedef struct {
    const double *rows;
    size_t stride; /* doubles in a row */
    brio_compare_fn compare;
    const void *user; /* passed to compare */
} brio_row_order;

/** Sorts n indices of rows. Looks. Returns BRIO_OK, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */
brio_status brio_sort_rows(brio_context *ctx, const brio_row_order *by, uint32_t *indices, size_t n);

#endif
