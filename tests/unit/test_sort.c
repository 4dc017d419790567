/* Every sort against the C library's: each size, width of key and number of threads, ties, and memory that runs out. */
#include "base/sort.h"
#include "base/team.h"
#include "failing_allocator.h"
#include "points.h"

enum { MOST = 140000 };

#ifdef BRIO_SHORT_TESTS
static const int THREADS[] = {1, 3};
#else
static const int THREADS[] = {1, 2, 3, 8};
#endif
enum { NUM_THREADS = sizeof THREADS / sizeof *THREADS };

/* Sizes at both sides of where a sort changes its method or its number of threads. */
static const size_t SIZES[] = {0,  1,  2,  3,   7,    23,   24,   25,   26,    47,    48,    49,
                               50, 63, 64, 100, 1000, 4096, 8191, 8192, 16384, 33000, 70000, MOST};
enum { NUM_SIZES = sizeof SIZES / sizeof *SIZES };

/* What is sorted, and a copy of it. */
static uint64_t keys[MOST], spare[MOST], wanted_keys[MOST];
static uint32_t values[MOST], wanted_values[MOST];

static brio_context *context_with(int threads) {
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, threads);
    return ctx;
}

/* Keys below 2^bits of several kinds: random; few that differ; in order; in reverse; all equal but one; and such that
 * differ in the highest bit only. */
enum { NUM_KINDS = 6 };

static void fill_keys(uint64_t *out, size_t n, int bits, int kind) {
    brio_rng rng = brio_rng_new((uint64_t)(1000 * kind + bits) + n);
    uint64_t most = bits < 64 ? (UINT64_C(1) << bits) - 1 : UINT64_MAX;
    for (size_t i = 0; i < n; i++) {
        uint64_t random = (uint64_t)brio_rng_below(&rng, UINT32_MAX) << 32 ^ (uint64_t)brio_rng_below(&rng, UINT32_MAX);
        const uint64_t of_kind[NUM_KINDS] = {random, (most / 3) * (random % 4),    i,
                                             n - i,  i == n / 2 ? most - 1 : most, (random & 1) << (bits - 1)};
        out[i] = of_kind[kind] & most;
    }
}

/* --- oracles --- */

/* A key and the place where it stood. */
typedef struct {
    uint64_t key;
    uint32_t place;
} placed_key;

static placed_key placed[MOST];

static int compare_placed(const void *a, const void *b) {
    const placed_key *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return x->place < y->place ? -1 : x->place > y->place;
}

/* The places of n keys in their stable order, by qsort. */
static void sort_placed(const uint64_t *key, size_t n) {
    for (size_t i = 0; i < n; i++) placed[i] = (placed_key){key[i], (uint32_t)i};
    qsort(placed, n, sizeof *placed, compare_placed);
}

/* --- pairs --- */

static void expect_sorted_pairs(brio_context *ctx, size_t n, int bits, int kind) {
    fill_keys(keys, n, bits, kind);
    sort_placed(keys, n);
    for (size_t i = 0; i < n; i++) {
        values[i] = (uint32_t)i;
        wanted_keys[i] = placed[i].key;
        wanted_values[i] = placed[i].place;
    }
    EXPECT(brio_radix_sort(ctx, keys, values, n, bits) == BRIO_OK);
    EXPECT(!memcmp(keys, wanted_keys, n * sizeof *keys), "keys: %zu of %d bits, kind %d", n, bits, kind);
    EXPECT(!memcmp(values, wanted_values, n * sizeof *values), "values: %zu of %d bits, kind %d", n, bits, kind);
}

static void pairs_are_sorted_and_stable(void) {
    const int bits[] = {1, 2, 10, 11, 12, 22, 23, 32, 33, 48, 63, 64};
    for (int t = 0; t < NUM_THREADS; t++) {
        brio_context *ctx = context_with(THREADS[t]);
        for (size_t s = 0; s < NUM_SIZES; s++)
            for (size_t b = 0; b < sizeof bits / sizeof *bits; b++) {
                int kind = (int)((s + b) % NUM_KINDS);
                expect_sorted_pairs(ctx, SIZES[s], bits[b], kind);
                if (SIZES[s] <= 100)
                    for (kind = 0; kind < NUM_KINDS; kind++) expect_sorted_pairs(ctx, SIZES[s], bits[b], kind);
            }
        EXPECT(brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
}

/* --- items --- */

static void expect_sorted_items(brio_context *ctx, size_t n, int bits, int threads, int kind) {
    fill_keys(wanted_keys, n, bits, kind);
    sort_placed(wanted_keys, n);
    /* The low halves fall, so that a sort by all 64 bits would turn ties round. */
    for (size_t i = 0; i < n; i++) keys[i] = wanted_keys[i] << 32 | (uint32_t)(MOST - i);
    for (size_t i = 0; i < n; i++) wanted_keys[i] = placed[i].key << 32 | (uint32_t)(MOST - placed[i].place);
    EXPECT(brio_sort_items(ctx, keys, spare, n, bits, threads) == BRIO_OK);
    EXPECT(!memcmp(keys, wanted_keys, n * sizeof *keys), "%zu items of %d bits, kind %d, %d threads", n, bits, kind,
           threads);
}

static void items_are_sorted_and_stable(void) {
    const int bits[] = {1, 3, 9, 10, 11, 20, 21, 30, 32};
    for (int t = 0; t < NUM_THREADS; t++) {
        brio_context *ctx = context_with(THREADS[t]);
        for (size_t s = 0; s < NUM_SIZES; s++)
            for (size_t b = 0; b < sizeof bits / sizeof *bits; b++)
                for (int kind = 0; kind < (SIZES[s] <= 100 ? NUM_KINDS : 2); kind++)
                    expect_sorted_items(ctx, SIZES[s], bits[b], brio_threads(ctx, SIZES[s], 1), kind);
        EXPECT(brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
}

/* --- keys in place --- */

static void keys_are_sorted(void) {
    for (size_t s = 0; s < NUM_SIZES; s++)
        for (int kind = 0; kind < NUM_KINDS; kind++) {
            fill_keys(keys, SIZES[s], 64, kind);
            sort_placed(keys, SIZES[s]);
            for (size_t i = 0; i < SIZES[s]; i++) wanted_keys[i] = placed[i].key;
            brio_sort_keys(keys, SIZES[s]);
            EXPECT(!memcmp(keys, wanted_keys, SIZES[s] * sizeof *keys), "%zu keys, kind %d", SIZES[s], kind);
        }
}

/* Without sorting. */
static void keys_of_a_rank_are_those_of_the_sorted_keys(void) {
    brio_context *ctx = new_context();
    for (size_t s = 1; s < NUM_SIZES; s++)
        for (int kind = 0; kind < NUM_KINDS; kind++) {
            size_t n = SIZES[s], rank[4] = {0, n / 2, n / 3, n - 1};
            fill_keys(keys, n, 64, kind);
            memcpy(wanted_keys, keys, n * sizeof *keys);
            brio_sort_keys(wanted_keys, n);
            for (int i = 0; i < 4; i++) {
                uint64_t key = 0;
                EXPECT(brio_key_of_rank(ctx, keys, n, rank[i], &key) == BRIO_OK && key == wanted_keys[rank[i]],
                       "rank %zu of %zu keys, kind %d", rank[i], n, kind);
            }
        }
    brio_context_free(ctx);
}

/* Every array of up to seven of three keys. */
static void few_keys_are_sorted_whatever_their_order(void) {
    for (size_t n = 0, arrays = 1; n <= 7; n++, arrays *= 3)
        for (size_t a = 0; a < arrays; a++) {
            size_t rest = a, count[3] = {0, 0, 0}, at = 0;
            for (size_t i = 0; i < n; i++, rest /= 3) count[keys[i] = rest % 3]++;
            brio_sort_keys(keys, n);
            for (uint64_t k = 0; k < 3; k++)
                for (size_t i = 0; i < count[k]; i++) EXPECT(keys[at++] == k, "array %zu of %zu keys", a, n);
        }
}

/* --- indices by a comparison --- */

static int compare_keys(uint32_t a, uint32_t b, const void *user) {
    const uint64_t *key = user;
    return key[a] < key[b] ? -1 : key[a] > key[b];
}

/* Whether n numbers are the indices below n, each once. */
static bool is_permutation(const uint32_t *index, size_t n) {
    static uint8_t met[MOST];
    memset(met, 0, n);
    for (size_t i = 0; i < n; i++)
        if (index[i] >= n || met[index[i]]++) return false;
    return true;
}

static void indices_are_sorted_by_the_comparison(void) {
    for (size_t s = 0; s < NUM_SIZES; s++)
        for (int kind = 0; kind < NUM_KINDS; kind++) {
            size_t n = SIZES[s], wrong = 0;
            fill_keys(keys, n, 64, kind);
            for (size_t i = 0; i < n; i++) values[i] = (uint32_t)(n - 1 - i);
            brio_sort_indices(values, n, compare_keys, keys);
            for (size_t i = 1; i < n; i++) wrong += keys[values[i - 1]] > keys[values[i]];
            EXPECT(wrong == 0 && is_permutation(values, n), "%zu indices, kind %d", n, kind);
        }
}

/* --- doubles and rows --- */

static void keys_of_doubles_have_the_order_of_doubles(void) {
    const double x[] = {-INFINITY,
                        -1.7976931348623157e308,
                        -1,
                        -0x1p-1022,
                        -0x1.ffffffffffffep-1023,
                        -0x1p-1074,
                        -0.0,
                        0.0,
                        0x1p-1074,
                        0x1.ffffffffffffep-1023,
                        0x1p-1022,
                        0.5,
                        1 - 0x1p-53,
                        1,
                        1 + 0x1p-52,
                        1.7976931348623157e308,
                        INFINITY};
    size_t n = sizeof x / sizeof *x;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            uint64_t a = brio_double_key(x[i]), b = brio_double_key(x[j]);
            EXPECT((a < b) == (x[i] < x[j]) && (a == b) == (x[i] == x[j]), "%a and %a", x[i], x[j]);
        }
}

static double rows[4 * MOST];

typedef struct {
    const double *rows;
    size_t stride;
} row_array;

static int compare_rows(uint32_t a, uint32_t b, const void *user) {
    const row_array *r = user;
    for (size_t k = 0; k < 3; k++) {
        double x = r->rows[r->stride * a + k], y = r->rows[r->stride * b + k];
        if (x != y) return x < y ? -1 : 1;
    }
    return a < b ? -1 : a > b;
}

static const row_array *array_of_qsort;

static int compare_for_qsort(const void *a, const void *b) {
    return compare_rows(*(const uint32_t *)a, *(const uint32_t *)b, array_of_qsort);
}

/* Sorts every third row, from the last, of n rows whose numbers are among `choices`, 0 of either sign included. */
static void expect_sorted_rows(brio_context *ctx, size_t stride, size_t n, uint32_t choices) {
    row_array array = {rows, stride};
    brio_row_order by = {rows, stride, compare_rows, &array};
    brio_rng rng = brio_rng_new(n + choices);
    size_t count = 0;
    for (size_t i = 0; i < stride * n; i++) {
        rows[i] = (double)brio_rng_below(&rng, choices) - choices / 2;
        if (rows[i] == 0 && i % 2) rows[i] = -0.0;
    }
    for (size_t i = n; i-- > 0;)
        if (i % 3 == 0) wanted_values[count] = values[count] = (uint32_t)i, count++;
    array_of_qsort = &array;
    qsort(wanted_values, count, sizeof *wanted_values, compare_for_qsort);
    EXPECT(brio_sort_rows(ctx, &by, values, count) == BRIO_OK);
    EXPECT(!memcmp(values, wanted_values, count * sizeof *values), "%zu rows of %zu, %u choices", count, stride,
           choices);
}

static void rows_are_sorted_by_the_first_number_then_as_compared(void) {
    const uint32_t choices[] = {1, 2, 5, 1000, UINT32_MAX};
    for (int t = 0; t < NUM_THREADS; t++) {
        brio_context *ctx = context_with(THREADS[t]);
        for (size_t s = 0; s < NUM_SIZES; s++)
            for (size_t stride = 3; stride <= 4; stride++)
                for (int c = 0; c < 5; c++) expect_sorted_rows(ctx, stride, SIZES[s], choices[c]);
        EXPECT(brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
}

/* --- memory that runs out --- */

static brio_status sort_pairs(brio_context *ctx) {
    fill_keys(keys, 5000, 64, 0);
    return brio_radix_sort(ctx, keys, values, 5000, 64);
}

static brio_status sort_items(brio_context *ctx) {
    fill_keys(keys, 5000, 64, 0);
    return brio_sort_items(ctx, keys, spare, 5000, 32, 1);
}

static brio_status sort_some_rows(brio_context *ctx) {
    row_array array = {rows, 3};
    for (uint32_t i = 0; i < 5000; i++) values[i] = i;
    return brio_sort_rows(ctx, &(brio_row_order){rows, 3, compare_rows, &array}, values, 5000);
}

static void refused_memory_is_a_status_and_leaves_nothing(void) {
    expect_clean_failures(sort_pairs);
    expect_clean_failures(sort_items);
    expect_clean_failures(sort_some_rows);
}

/* --- looks --- */

typedef struct {
    size_t looks, allowed;
} wish;

static int ask(const char *stage, double fraction, void *user) {
    wish *w = user;
    (void)stage, (void)fraction;
    return w->looks++ >= w->allowed;
}

static int compare_indices(uint32_t a, uint32_t b, const void *user) {
    (void)user;
    return (a > b) - (a < b);
}

enum { MANY = 12 * BRIO_LOOK_EVERY };

/* More entries than the arrays above have. */
typedef struct {
    uint64_t *keys, *spare;
    uint32_t *values;
    double *rows;
} many;

static brio_status sort_one_way(brio_context *ctx, int way, const many *m) {
    for (size_t i = 0; i < MANY; i++) {
        m->keys[i] = (uint64_t)(i * 2654435761u % MANY) << 32 | i;
        m->values[i] = (uint32_t)(i * 2654435761u % MANY);
    }
    switch (way) {
    case 0:
        return brio_radix_sort(ctx, m->keys, m->values, MANY, 64);
    case 1:
        return brio_sort_items(ctx, m->keys, m->spare, MANY, 30, brio_threads(ctx, MANY, 1 << 14));
    case 2:
        return brio_sort_rows(ctx, &(brio_row_order){m->rows, 1, compare_indices, NULL}, m->values, MANY);
    case 3:
        return brio_sort_many_keys(ctx, m->keys, MANY);
    default:
        return brio_sort_many_indices(ctx, m->values, MANY, compare_indices, NULL);
    }
}

/* Sorts of millions of entries ran for seconds without a look. Cancelled at each of the first looks, and at the last one. */
static void sorts_look_and_stop(void) {
    many m = {malloc(MANY * sizeof *m.keys), malloc(MANY * sizeof *m.spare), malloc(MANY * sizeof *m.values),
              calloc(MANY, sizeof *m.rows)};
    for (int threads = 1; threads <= 3; threads += 2)
        for (int way = 0; way < 5; way++) {
            brio_context *ctx = new_context();
            wish w = {0, SIZE_MAX};
            brio_context_set_threads(ctx, threads);
            brio_context_set_progress(ctx, ask, &w);
            EXPECT(sort_one_way(ctx, way, &m) == BRIO_OK);
            EXPECT(w.looks >= 8, "way %d, %d threads: %zu looks", way, threads, w.looks);
            for (size_t k = 1, all = w.looks; k < all; k += 1 + all / 4) {
                w = (wish){0, k - 1};
                EXPECT(sort_one_way(ctx, way, &m) == BRIO_ERR_CANCELLED);
                EXPECT(w.looks == k && brio_context_memory(ctx) == 0, "way %d, %d threads: %zu looks after %zu", way,
                       threads, w.looks, k);
            }
            brio_context_free(ctx);
        }
    free(m.keys);
    free(m.spare);
    free(m.values);
    free(m.rows);
}

SUITE(test_sort) {
    RUN(pairs_are_sorted_and_stable);
    RUN(items_are_sorted_and_stable);
    RUN(keys_are_sorted);
    RUN(keys_of_a_rank_are_those_of_the_sorted_keys);
    RUN(few_keys_are_sorted_whatever_their_order);
    RUN(indices_are_sorted_by_the_comparison);
    RUN(keys_of_doubles_have_the_order_of_doubles);
    RUN(rows_are_sorted_by_the_first_number_then_as_compared);
    RUN(refused_memory_is_a_status_and_leaves_nothing);
    RUN(sorts_look_and_stop);
    return harness_end();
}
