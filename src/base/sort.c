/* Least-significant-digit radix sorts of pairs and of items, a sort of rows by their first number, and
 * the key of a rank.
 *
 * Member 0 looks between pieces of its part. Where the callback asks to stop, every member leaves its loops when it
 * sees `stop`, and all of them end after the same digit: they read `stop` between two barriers, where nobody looks. */
#include "base/sort.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/team.h"
#include <assert.h>
#include <string.h>

/* DIGIT: bits sorted in a pass. Both chosen. */
enum { DIGIT = 11, BUCKETS = 1 << DIGIT, PAIRS_A_THREAD = 1 << 12 };

/* What stops a sort. */
typedef struct {
    brio_context *ctx;
    bool looks;       /* whether member 0 may */
    brio_status stop; /* written by member 0; atomic */
} stopper;

/* Returns whether a member goes on at entry i of its part. Member 0 looks now and then. */
static inline bool goes_on(stopper *s, size_t i, const brio_member *m) {
    if (i % BRIO_LOOK_EVERY) return true;
    if (m->thread == 0 && s->looks && s->stop == BRIO_OK) brio_report(&s->stop, brio_look(s->ctx, BRIO_LOOK_EVERY));
    return __atomic_load_n(&s->stop, __ATOMIC_RELAXED) == BRIO_OK;
}

typedef struct {
    uint64_t *key;
    uint32_t *value;
} pairs;

/* Replaces each thread's counts by the places where the thread writes: all threads for one digit, then all for the next
 * digit. Returns false if all keys have one digit. */
static bool first_positions(size_t (*count)[BUCKETS], int threads, size_t n) {
    for (size_t b = 0, place = 0, next; b < BUCKETS; b++, place = next) {
        next = brio_counts_to_places(&count[0][b], BUCKETS, (size_t)threads, place);
        if (next - place == n) return false;
    }
    return true;
}

#ifndef NDEBUG
static bool keys_ascend(const uint64_t *key, size_t n, int bits) {
    for (size_t i = 1; i < n; i++)
        if (key[i] < key[i - 1]) return false;
    return n == 0 || bits >= 64 || key[n - 1] >> bits == 0;
}

static bool items_ascend(const uint64_t *item, size_t n) {
    for (size_t i = 1; i < n; i++)
        if (item[i] >> 32 < item[i - 1] >> 32) return false;
    return true;
}
#endif

/* What the threads of a sort of pairs share. */
typedef struct {
    pairs given, spare;
    size_t n;
    int bits;
    size_t (*count)[BUCKETS]; /* one for each thread */
    bool moved;               /* whether the last digit moved the pairs */
    bool in_spare;            /* whether the sorted pairs are in `spare` */
    stopper stopper;
} pair_sort;

/* Sorts by one digit, from one array to the other. Every thread calls this. Sets s->moved. */
static void sort_pairs_digit(pair_sort *s, pairs from, pairs to, int shift, const brio_member *m) {
    size_t begin = brio_part(s->n, m->thread, m->threads), end = brio_part(s->n, m->thread + 1, m->threads);
    size_t *mine = s->count[m->thread];
    memset(mine, 0, sizeof *s->count);
    for (size_t i = begin; i < end && goes_on(&s->stopper, i, m); i++) mine[from.key[i] >> shift & (BUCKETS - 1)]++;
    brio_barrier(m);
    if (m->thread == 0) s->moved = first_positions(s->count, m->threads, s->n);
    brio_barrier(m);
    for (size_t i = s->moved ? begin : end; i < end && goes_on(&s->stopper, i, m); i++) {
        size_t place = mine[from.key[i] >> shift & (BUCKETS - 1)]++;
        assert(place < s->n);
        to.key[place] = from.key[i];
        to.value[place] = from.value[i];
    }
    brio_barrier(m);
}

static void sort_pairs(void *user, const brio_member *m) {
    pair_sort *s = user;
    bool in_spare = false, stop = false;
    for (int shift = 0; shift < s->bits && !stop; shift += DIGIT) {
        sort_pairs_digit(s, in_spare ? s->spare : s->given, in_spare ? s->given : s->spare, shift, m);
        in_spare ^= s->moved;
        stop = __atomic_load_n(&s->stopper.stop, __ATOMIC_RELAXED) != BRIO_OK;
        brio_barrier(m); /* every thread has read s->moved and s->stopper.stop */
    }
    if (m->thread == 0) s->in_spare = in_spare;
}

brio_status brio_radix_sort(brio_context *ctx, uint64_t *keys, uint32_t *values, size_t n, int bits) {
    brio_status status = BRIO_OK;
    pair_sort s = {.given = {keys, values}, .n = n, .bits = bits, .stopper = {ctx, brio_may_look(ctx), BRIO_OK}};
    assert(0 <= bits && bits <= 64);
    if (n < 2) return BRIO_OK;
    int threads = brio_threads(ctx, n, PAIRS_A_THREAD);
    BRIO_TRY(BRIO_ALLOC(ctx, s.count, (size_t)threads));
    BRIO_TRY(BRIO_ALLOC(ctx, s.spare.key, n));
    BRIO_TRY(BRIO_ALLOC(ctx, s.spare.value, n));
    brio_run(ctx, threads, sort_pairs, &s);
    BRIO_TRY(s.stopper.stop);
    if (s.in_spare) {
        memcpy(keys, s.spare.key, n * sizeof *keys);
        memcpy(values, s.spare.value, n * sizeof *values);
    }
    assert(keys_ascend(keys, n, bits));
done:
    brio_release(ctx, s.count);
    brio_release(ctx, s.spare.key);
    brio_release(ctx, s.spare.value);
    return status;
}

/* --- items --- */

/* ITEM_DIGIT: bits sorted in a pass. FEW_ITEMS: at most as many are sorted by insertion. All chosen. */
enum { ITEM_DIGIT = 10, ITEM_BUCKETS = 1 << ITEM_DIGIT, FEW_ITEMS = 48, ITEMS_A_THREAD = 1 << 14 };

static void insert_items(uint64_t *items, size_t n) {
    for (size_t i = 1; i < n; i++) {
        uint64_t moved = items[i];
        size_t j = i;
        for (; j > 0 && moved >> 32 < items[j - 1] >> 32; j--) items[j] = items[j - 1];
        items[j] = moved;
    }
}

/* Replaces each thread's counts by the places where the thread writes: all threads for one digit, then all for the next
 * digit. */
static void first_places(size_t (*count)[ITEM_BUCKETS], int threads) {
    for (size_t b = 0, place = 0; b < ITEM_BUCKETS; b++)
        place = brio_counts_to_places(&count[0][b], ITEM_BUCKETS, (size_t)threads, place);
}

/* What the threads of a sort of items share. */
typedef struct {
    uint64_t *items, *spare;
    size_t n;
    int passes;
    size_t (*count)[ITEM_BUCKETS]; /* one for each thread */
    stopper stopper;
} item_sort;

/* Sorts by one digit. Every thread calls this. */
static void sort_digit(item_sort *s, int pass, const brio_member *m) {
    const uint64_t *from = pass % 2 ? s->spare : s->items;
    uint64_t *to = pass % 2 ? s->items : s->spare;
    size_t begin = brio_part(s->n, m->thread, m->threads), end = brio_part(s->n, m->thread + 1, m->threads);
    size_t *mine = s->count[m->thread];
    int shift = 32 + pass * ITEM_DIGIT;
    memset(mine, 0, sizeof *s->count);
    for (size_t i = begin; i < end && goes_on(&s->stopper, i, m); i++) mine[from[i] >> shift & (ITEM_BUCKETS - 1)]++;
    brio_barrier(m);
    if (m->thread == 0) first_places(s->count, m->threads);
    brio_barrier(m);
    for (size_t i = begin; i < end && goes_on(&s->stopper, i, m); i++) {
        assert(mine[from[i] >> shift & (ITEM_BUCKETS - 1)] < s->n);
        to[mine[from[i] >> shift & (ITEM_BUCKETS - 1)]++] = from[i];
    }
    brio_barrier(m);
}

static void sort_items(void *user, const brio_member *m) {
    item_sort *s = user;
    bool stop = false;
    for (int pass = 0; pass < s->passes && !stop; pass++) {
        sort_digit(s, pass, m);
        stop = __atomic_load_n(&s->stopper.stop, __ATOMIC_RELAXED) != BRIO_OK;
        brio_barrier(m); /* every thread has read s->stopper.stop */
    }
}

brio_status brio_sort_items(brio_context *ctx, uint64_t *items, uint64_t *spare, size_t n, int bits, int threads) {
    item_sort s = {.items = items,
                   .spare = spare,
                   .n = n,
                   .passes = (bits + ITEM_DIGIT - 1) / ITEM_DIGIT,
                   .stopper = {ctx, brio_may_look(ctx), BRIO_OK}};
    assert(0 <= bits && bits <= 32 && threads >= 1);
    if (n <= FEW_ITEMS) {
        insert_items(items, n);
        assert(items_ascend(items, n));
        return BRIO_OK;
    }
    int most = (int)(n / ITEMS_A_THREAD) + 1;
    if (threads > most) threads = most;
    brio_status status = BRIO_ALLOC(ctx, s.count, (size_t)threads);
    if (status != BRIO_OK) return status;
    brio_run(ctx, threads, sort_items, &s);
    if (s.passes % 2) memcpy(items, spare, n * sizeof *items);
    assert(s.stopper.stop != BRIO_OK || items_ascend(items, n));
    brio_release(ctx, s.count);
    return s.stopper.stop;
}

uint64_t brio_double_key(double x) {
    uint64_t bits;
    x += 0.0;
    memcpy(&bits, &x, sizeof bits);
    return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

brio_status brio_sort_rows(brio_context *ctx, const brio_row_order *by, uint32_t *indices, size_t n) {
    uint64_t *keys = NULL;
    brio_status status = BRIO_ALLOC(ctx, keys, n);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) {
        keys[i] = brio_double_key(by->rows[by->stride * indices[i]]);
        BRIO_TRY(brio_look(ctx, 1));
    }
    BRIO_TRY(brio_radix_sort(ctx, keys, indices, n, 64));
    for (size_t begin = 0, end; begin < n; begin = end) {
        for (end = begin + 1; end < n && keys[end] == keys[begin];) end++;
        BRIO_TRY(brio_look(ctx, end - begin));
        BRIO_TRY(brio_sort_many_indices(ctx, indices + begin, end - begin, by->compare, by->user));
    }
done:
    brio_release(ctx, keys);
    return status;
}

/* --- one key --- */

/* LOOKED_AT: keys between two looks; chosen. */
enum { BYTE = 8, VALUES = 1 << BYTE, LOOKED_AT = 1 << 16 };

/* Counts keys by the byte at `shift`: those whose higher bytes are those of `known`. */
static brio_status count_bytes(brio_context *ctx, const uint64_t *keys, size_t n, uint64_t known, int shift,
                               size_t *count) {
    const uint64_t higher = shift + BYTE < 64 ? UINT64_MAX << (shift + BYTE) : 0;
    for (int i = 0; i < VALUES; i++) count[i] = 0;
    for (size_t begin = 0; begin < n; begin += LOOKED_AT) {
        size_t end = n - begin < LOOKED_AT ? n : begin + LOOKED_AT;
        for (size_t i = begin; i < end; i++)
            if (((keys[i] ^ known) & higher) == 0) count[keys[i] >> shift & (VALUES - 1)]++;
        BRIO_FORWARD(brio_look(ctx, end - begin));
    }
    return BRIO_OK;
}

/* Counts, in eight passes by one byte each, from the highest, the keys that share the bytes known so far. */
brio_status brio_key_of_rank(brio_context *ctx, const uint64_t *keys, size_t n, size_t rank, uint64_t *key) {
    assert(rank < n);
    *key = 0;
    for (int shift = 64 - BYTE; shift >= 0; shift -= BYTE) {
        size_t count[VALUES], value = 0;
        BRIO_FORWARD(count_bytes(ctx, keys, n, *key, shift, count));
        for (; rank >= count[value]; value++) rank -= count[value];
        *key |= (uint64_t)value << shift;
    }
    return BRIO_OK;
}
