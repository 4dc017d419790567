/* Least-significant-digit radix sorts: of pairs, of items, of rows by their first number. */
#include "base/sort.h"
#include "base/memory.h"
#include "base/parallel.h"
#include <string.h>

enum { DIGIT = 11, BUCKETS = 1 << DIGIT, PAIRS_A_THREAD = 1 << 12 };

typedef struct {
    uint64_t *key;
    uint32_t *value;
} pairs;

/* Turns each thread's counts into where it writes: all threads' of one digit, then of the next; false when all keys
 * share this digit. */
static bool first_positions(size_t (*count)[BUCKETS], int threads, size_t n) {
    size_t sum = 0;
    for (int b = 0; b < BUCKETS; b++) {
        size_t before = sum;
        for (int t = 0; t < threads; t++) {
            size_t c = count[t][b];
            count[t][b] = sum;
            sum += c;
        }
        if (sum - before == n) return false;
    }
    return true;
}

/* One digit; every thread of the team calls this. *moved, which they share, tells whether the pairs are in `to`. */
static void sort_pairs_digit(pairs from, pairs to, size_t n, int shift, size_t (*count)[BUCKETS], bool *moved) {
    int thread = brio_thread(), threads = brio_team_size();
    size_t begin = brio_part(n, thread, threads), end = brio_part(n, thread + 1, threads), *mine = count[thread];
    memset(mine, 0, sizeof *count);
    for (size_t i = begin; i < end; i++) mine[from.key[i] >> shift & (BUCKETS - 1)]++;
    BRIO_OMP(barrier)
    BRIO_OMP(single)
    *moved = first_positions(count, threads, n);
    for (size_t i = *moved ? begin : end; i < end; i++) {
        size_t place = mine[from.key[i] >> shift & (BUCKETS - 1)]++;
        to.key[place] = from.key[i];
        to.value[place] = from.value[i];
    }
    BRIO_OMP(barrier)
}

/* Sorts a, with b as spare room; whether the pairs are in b in the end. Every thread of the team calls this. */
static bool sort_pairs(pairs a, pairs b, size_t n, int bits, size_t (*count)[BUCKETS], bool *moved) {
    bool in_b = false;
    for (int shift = 0; shift < bits; shift += DIGIT) {
        sort_pairs_digit(in_b ? b : a, in_b ? a : b, n, shift, count, moved);
        in_b ^= *moved;
        BRIO_OMP(barrier)
    }
    return in_b;
}

brio_status brio_radix_sort(brio_context *ctx, uint64_t *keys, uint32_t *values, size_t n, int bits) {
    brio_status status = BRIO_OK;
    int threads = brio_context_threads(ctx), most = (int)(n / PAIRS_A_THREAD) + 1;
    pairs spare = {NULL, NULL};
    size_t(*count)[BUCKETS] = NULL;
    bool moved = false, in_spare = false;
    if (n < 2) goto done;
    if (threads > most) threads = most;
    BRIO_TRY(BRIO_ALLOC(ctx, count, (size_t)threads));
    BRIO_TRY(BRIO_ALLOC(ctx, spare.key, n));
    BRIO_TRY(BRIO_ALLOC(ctx, spare.value, n));
    BRIO_OMP(parallel num_threads(threads)) {
        bool last = sort_pairs((pairs){keys, values}, spare, n, bits, count, &moved);
        if (brio_thread() == 0) in_spare = last;
    }
    if (in_spare) {
        memcpy(keys, spare.key, n * sizeof *keys);
        memcpy(values, spare.value, n * sizeof *values);
    }
done:
    brio_release(ctx, count);
    brio_release(ctx, spare.key);
    brio_release(ctx, spare.value);
    return status;
}

/* --- items --- */

enum { ITEM_DIGIT = 10, ITEM_BUCKETS = 1 << ITEM_DIGIT, FEW_ITEMS = 48, ITEMS_A_THREAD = 1 << 14 };

static void insert_items(uint64_t *items, size_t n) {
    for (size_t i = 1; i < n; i++) {
        uint64_t moved = items[i];
        size_t j = i;
        for (; j > 0 && moved >> 32 < items[j - 1] >> 32; j--) items[j] = items[j - 1];
        items[j] = moved;
    }
}

/* Turns each thread's counts into where it writes: all threads' of one digit, then of the next. */
static void first_places(size_t (*count)[ITEM_BUCKETS], int threads) {
    size_t sum = 0;
    for (int b = 0; b < ITEM_BUCKETS; b++)
        for (int t = 0; t < threads; t++) {
            size_t c = count[t][b];
            count[t][b] = sum;
            sum += c;
        }
}

/* One digit; every thread of the team calls this. */
static void sort_digit(const uint64_t *from, uint64_t *to, size_t n, int shift, size_t (*count)[ITEM_BUCKETS]) {
    int thread = brio_thread(), threads = brio_team_size();
    size_t begin = brio_part(n, thread, threads), end = brio_part(n, thread + 1, threads), *mine = count[thread];
    memset(mine, 0, sizeof *count);
    for (size_t i = begin; i < end; i++) mine[from[i] >> shift & (ITEM_BUCKETS - 1)]++;
    BRIO_OMP(barrier)
    BRIO_OMP(single)
    first_places(count, threads);
    for (size_t i = begin; i < end; i++) to[mine[from[i] >> shift & (ITEM_BUCKETS - 1)]++] = from[i];
    BRIO_OMP(barrier)
}

brio_status brio_sort_items(brio_context *ctx, uint64_t *items, uint64_t *spare, size_t n, int bits, int threads) {
    size_t(*count)[ITEM_BUCKETS] = NULL;
    int passes = (bits + ITEM_DIGIT - 1) / ITEM_DIGIT, most = (int)(n / ITEMS_A_THREAD) + 1;
    if (n <= FEW_ITEMS) {
        insert_items(items, n);
        return BRIO_OK;
    }
    if (threads > most) threads = most;
    brio_status status = BRIO_ALLOC(ctx, count, (size_t)threads);
    if (status != BRIO_OK) return status;
    BRIO_OMP(parallel num_threads(threads))
    for (int p = 0; p < passes; p++)
        sort_digit(p % 2 ? spare : items, p % 2 ? items : spare, n, 32 + p * ITEM_DIGIT, count);
    if (passes % 2) memcpy(items, spare, n * sizeof *items);
    brio_release(ctx, count);
    return BRIO_OK;
}

uint64_t brio_double_key(double x) {
    uint64_t bits;
    x += 0.0;
    memcpy(&bits, &x, sizeof bits);
    return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

brio_status brio_sort_rows(brio_context *ctx, const double *rows, size_t stride, uint32_t *indices, size_t n,
                           brio_compare_fn compare, const void *user) {
    uint64_t *keys = NULL;
    brio_status status = BRIO_ALLOC(ctx, keys, n);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) keys[i] = brio_double_key(rows[stride * indices[i]]);
    status = brio_radix_sort(ctx, keys, indices, n, 64);
    for (size_t begin = 0, end; status == BRIO_OK && begin < n; begin = end) {
        for (end = begin + 1; end < n && keys[end] == keys[begin];) end++;
        brio_sort_indices(indices + begin, end - begin, compare, user);
    }
    brio_release(ctx, keys);
    return status;
}
