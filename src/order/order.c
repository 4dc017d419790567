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
#include "base/parallel.h"
#include "base/rng.h"
#include "base/sort.h"
#include "order/hilbert.h"

enum { CURVE_BITS = 10, ROUNDS = 64, CELL_MOST = 8, POINTS_A_THREAD = 1 << 14 };

/* --- along the curve --- */

/* Levels of the curve for n points: enough to tell them apart where they are spread evenly over a surface. */
static int curve_bits(size_t n) {
    int bits = 2;
    while (bits < CURVE_BITS && (size_t)1 << 2 * (bits - 1) < n) bits++;
    return bits;
}

typedef struct {
    brio_context *ctx;
    const double *points;
    uint64_t *items, *spare;
} curve;

static brio_status sort_along_curve(const curve *c, size_t begin, size_t end, int threads);

/* Sorts cells with many points again, along the curve through their own cube, so that clusters of any size are
 * resolved. Of the cells of [begin, end) those that start in [from, to). */
static brio_status refine_cells(const curve *c, size_t begin, size_t end, size_t from, size_t to) {
    const uint64_t *items = c->items;
    brio_status status = BRIO_OK;
    while (from > begin && from < end && items[from] >> 32 == items[from - 1] >> 32) from++;
    for (size_t next; from < to && status == BRIO_OK; from = next) {
        for (next = from + 1; next < end && items[next] >> 32 == items[from] >> 32;) next++;
        bool crowded =
            next - from > CELL_MOST && next - from < end - begin; /* else the cube is too small to be divided */
        if (crowded) status = sort_along_curve(c, from, next, 1);
    }
    return status;
}

/* Sorts the items [begin, end) along the curve through their points' cube. */
static brio_status sort_along_curve(const curve *c, size_t begin, size_t end, int threads) {
    size_t n = end - begin;
    int bits = curve_bits(n);
    if (!brio_hilbert_items(c->points, c->items + begin, n, bits, threads)) return BRIO_OK;
    brio_status status = brio_sort_items(c->ctx, c->items + begin, c->spare + begin, n, 3 * bits, threads);
    if (status != BRIO_OK) return status;
    BRIO_OMP(parallel for schedule(static, 1) num_threads(threads))
    for (int t = 0; t < threads; t++) {
        brio_status own =
            refine_cells(c, begin, end, begin + brio_part(n, t, threads), begin + brio_part(n, t + 1, threads));
        if (own != BRIO_OK) BRIO_OMP(critical(brio_curve_status)) status = own;
    }
    return status;
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
                                      int threads, uint32_t *order, uint32_t *rank) {
    uint64_t least[ROUNDS + 1];
    size_t(*place)[ROUNDS] = NULL, sum = 0;
    uint8_t *round = NULL;
    brio_status status = BRIO_OK;
    int rounds = set_rounds(n, options->round_ratio, least);
    BRIO_TRY(BRIO_ALLOC(ctx, round, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, place, (size_t)threads));
    BRIO_OMP(parallel for schedule(static, 1) num_threads(threads))
    for (int t = 0; t < threads; t++)
        for (size_t i = brio_part(n, t, threads); i < brio_part(n, t + 1, threads); i++) {
            round[i] = (uint8_t)round_of(hash_of(options->seed, (uint32_t)items[i]), least);
            place[t][round[i]]++;
        }
    for (int r = rounds; r-- > 0;)
        for (int t = 0; t < threads; t++) {
            size_t count = place[t][r];
            place[t][r] = sum;
            sum += count;
        }
    BRIO_OMP(parallel for schedule(static, 1) num_threads(threads))
    for (int t = 0; t < threads; t++)
        for (size_t i = brio_part(n, t, threads); i < brio_part(n, t + 1, threads); i++) {
            size_t to = place[t][round[i]]++;
            order[to] = (uint32_t)items[i];
            if (rank) rank[to] = (uint32_t)i;
        }
done:
    brio_release(ctx, round);
    brio_release(ctx, place);
    return status;
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
    int most = brio_context_threads(ctx),
        threads = n / POINTS_A_THREAD < (size_t)most ? (int)(n / POINTS_A_THREAD) + 1 : most;
    for (size_t i = 0; i < n; i++) items[i] = random ? hash_of(options->seed, i) >> 32 << 32 | i : i;
    if (random) BRIO_TRY(brio_sort_items(ctx, items, spare, n, 32, threads));
    if (options->order == BRIO_ORDER_HILBERT || options->order == BRIO_ORDER_BRIO)
        BRIO_TRY(sort_along_curve(&(curve){ctx, points, items, spare}, 0, n, threads));
    if (options->order == BRIO_ORDER_BRIO)
        BRIO_TRY(divide_into_rounds(ctx, items, n, options, threads, order, rank));
    else
        list_items(items, n, order, rank);
done:
    brio_release(ctx, items);
    brio_release(ctx, spare);
    return status;
}
