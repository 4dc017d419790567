/* Biased randomized insertion order (BRIO) and its plainer relatives.
 *
 * Each point draws the round it is inserted in: the last with probability 1 - ratio, the one before with probability
 * (1 - ratio) ratio, and so on; inside a round points follow a Hilbert curve. The early rounds are a random sample of
 * everything, which keeps the expected work of the randomized analysis; the curve makes one insertion touch the memory
 * that the one before has touched.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 5.3.
 * Differs from the paper: a Hilbert curve in place of octree blocks; a ratio of 1/8 in place of 1/2, which inserts
 * fewer points into a coarse triangulation. */
#include "order/order.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "order/hilbert.h"

enum { CURVE_BITS = 10, ROUNDS = 64, CELL_MOST = 8 };

/* --- along the curve --- */

/* Levels of the curve for n points: enough to tell them apart where they are spread evenly over a surface. */
static int curve_bits(size_t n) {
    int bits = 2;
    while (bits < CURVE_BITS && (size_t)1 << 2 * (bits - 1) < n) bits++;
    return bits;
}

/* Sorts items along the curve through the points' own cube; cells with many points are sorted again, along the curve
 * through theirs, so that clusters of any size are resolved. */
static void sort_along_curve(const double *points, uint64_t *items, uint64_t *spare, size_t n) {
    int bits = curve_bits(n);
    if (!brio_hilbert_items(points, items, n, bits)) return;
    brio_sort_items(items, spare, n, 3 * bits);
    for (size_t begin = 0, end; begin < n; begin = end) {
        for (end = begin + 1; end < n && items[end] >> 32 == items[begin] >> 32;) end++;
        bool crowded = end - begin > CELL_MOST && end - begin < n; /* else the cube is too small to be divided */
        if (crowded) sort_along_curve(points, items + begin, spare, end - begin);
    }
}

/* --- rounds --- */

static inline uint64_t hash_of(uint64_t seed, size_t i) {
    return brio_mix(seed + brio_mix(i));
}

/* least[r]: a point whose hash is below least[r] is at least r rounds before the last. Rounds smaller than a handful of
 * points are merged into the first; the number of rounds. */
static int set_rounds(size_t n, double ratio, uint64_t least[ROUNDS + 1]) {
    double share = ratio;
    int rounds = 1;
    for (; rounds < ROUNDS && share * (double)n > 16; rounds++, share *= ratio)
        least[rounds] = (uint64_t)(share * 0x1p63) << 1;
    least[rounds] = 0;
    return rounds;
}

static inline int round_of(uint64_t hash, const uint64_t least[ROUNDS + 1]) {
    int back = 0;
    while (hash < least[back + 1]) back++;
    return back;
}

/* order = the items, which are in the order of the curve, by rounds, the first round first; rank as in order.h. */
static brio_status divide_into_rounds(brio_context *ctx, const uint64_t *items, size_t n, const brio_options *options,
                                      uint32_t *order, uint32_t *rank) {
    uint64_t least[ROUNDS + 1];
    size_t place[ROUNDS] = {0}, sum = 0;
    uint8_t *round = NULL;
    brio_status status = BRIO_ALLOC(ctx, round, n);
    if (status != BRIO_OK) return status;
    int rounds = set_rounds(n, options->round_ratio, least);
    for (size_t i = 0; i < n; i++) {
        round[i] = (uint8_t)round_of(hash_of(options->seed, (uint32_t)items[i]), least);
        place[round[i]]++;
    }
    for (int r = rounds; r-- > 0;) {
        size_t count = place[r];
        place[r] = sum;
        sum += count;
    }
    for (size_t i = 0; i < n; i++) {
        size_t to = place[round[i]]++;
        order[to] = (uint32_t)items[i];
        if (rank) rank[to] = (uint32_t)i;
    }
    brio_release(ctx, round);
    return BRIO_OK;
}

static void list_items(const uint64_t *items, size_t n, uint32_t *order, uint32_t *rank) {
    for (size_t i = 0; i < n; i++) {
        order[i] = (uint32_t)items[i];
        if (rank) rank[i] = (uint32_t)i;
    }
}

brio_status brio_order_points(brio_context *ctx, const double *points, size_t n, const brio_options *options,
                              uint32_t *order, uint32_t *rank) {
    brio_status status = BRIO_OK;
    uint64_t *items = NULL, *spare = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, items, n));
    BRIO_TRY(BRIO_ALLOC(ctx, spare, n));
    bool random = options->order == BRIO_ORDER_RANDOM;
    for (size_t i = 0; i < n; i++) items[i] = random ? hash_of(options->seed, i) >> 32 << 32 | i : i;
    if (random) brio_sort_items(items, spare, n, 32);
    if (options->order == BRIO_ORDER_HILBERT || options->order == BRIO_ORDER_BRIO)
        sort_along_curve(points, items, spare, n);
    if (options->order == BRIO_ORDER_BRIO)
        BRIO_TRY(divide_into_rounds(ctx, items, n, options, order, rank));
    else
        list_items(items, n, order, rank);
done:
    brio_release(ctx, items);
    brio_release(ctx, spare);
    return status;
}
