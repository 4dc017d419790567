/* Insertion orders: biased randomized insertion orders (BRIO) and simpler orders.
 *
 * A BRIO sorts the points for locality: along a Hilbert curve, or by the blocks of an octree or a k-d tree, depth first
 * and shuffled inside a block. It then divides the points into random rounds, and each round keeps the sorted order. So
 * an insertion touches mostly memory that the insertion before has touched.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, sections 5.3 and 5.8.
 * Differs from the paper: the default BRIO uses a Hilbert curve instead of octree blocks, and a ratio of 1/8 instead of
 * 1/2. The ratio of 1/8 inserts fewer points into a coarse triangulation. With weights, points are inserted in a
 * sequence by weights (rounds.c). */
#include "order/order.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/blocks.h"
#include "order/curve.h"
#include <assert.h>

enum { POINTS_A_THREAD = 1 << 13, BLOCK_SIZE = 2000 };

/* The data of one call that computes an order. */
typedef struct {
    brio_context *ctx;
    const double *points;
    size_t n;
    const brio_delaunay_options *options;
    uint32_t *index; /* n: receives the points in the order before rounds; NULL until it is needed */
    uint32_t *spare; /* room for n indices, or NULL */
} maker;

static brio_status need_room(const maker *m, uint32_t **indices) {
    return *indices ? BRIO_OK : BRIO_ALLOC(m->ctx, *indices, m->n);
}

static bool has_rounds(brio_order order) {
    return order == BRIO_ORDER_BRIO || order == BRIO_ORDER_BRIO_OCTREE || order == BRIO_ORDER_BRIO_KDTREE;
}

bool brio_order_has_ranks(brio_order order) {
    return order != BRIO_ORDER_RANDOM && order != BRIO_ORDER_INPUT;
}

static double ratio_of(const brio_delaunay_options *options) {
    if (options->round_ratio > 0) return options->round_ratio;
    return options->order == BRIO_ORDER_BRIO ? 0.125 : 0.5;
}

/* --- items: by a key --- */

static brio_status order_items(maker *m) {
    brio_status status = BRIO_OK;
    uint64_t *items = NULL, *spare = NULL, seed = m->options->seed;
    bool random = m->options->order == BRIO_ORDER_RANDOM;
    int threads = brio_threads(m->ctx, m->n, POINTS_A_THREAD);
    BRIO_TRY(BRIO_ALLOC(m->ctx, items, m->n));
    BRIO_TRY(BRIO_ALLOC(m->ctx, spare, m->n));
    brio_expect_sequence(items);
    brio_expect_sequence(spare);
    for (size_t i = 0; i < m->n; i++) items[i] = random ? brio_hash(seed, i) >> 32 << 32 | i : i;
    if (random)
        BRIO_TRY(brio_sort_items(m->ctx, items, spare, m->n, 32, threads));
    else
        BRIO_TRY(brio_sort_along_curve(m->ctx, m->points, items, spare, m->n, threads));
    brio_release(m->ctx, spare);
    spare = NULL;
    BRIO_TRY(need_room(m, &m->index));
    for (size_t i = 0; i < m->n; i++) m->index[i] = (uint32_t)items[i];
done:
    brio_release(m->ctx, items);
    brio_release(m->ctx, spare);
    return status;
}

/* --- blocks --- */

static void shuffle_block(uint32_t *index, const brio_block *block, const void *user) {
    const brio_delaunay_options *options = user;
    brio_rng rng = brio_rng_new(brio_hash(options->seed, block->begin));
    uint32_t *a = index + block->begin;
    for (uint32_t i = (uint32_t)(block->end - block->begin); i > 1; i--) {
        uint32_t j = brio_rng_below(&rng, i), swap = a[i - 1];
        assert(j < i);
        a[i - 1] = a[j], a[j] = swap;
    }
}

static brio_status order_blocks(maker *m) {
    size_t block_size = m->options->block_size ? m->options->block_size : BLOCK_SIZE;
    brio_status status = need_room(m, &m->index);
    if (status != BRIO_OK) return status;
    brio_blocks blocks = {m->points, m->n, block_size, m->index, shuffle_block, m->options};
    if (m->options->order == BRIO_ORDER_BRIO_KDTREE) return brio_kdtree_blocks(m->ctx, &blocks);
    status = need_room(m, &m->spare);
    if (status != BRIO_OK) return status;
    return brio_octree_blocks(m->ctx, &blocks, m->spare);
}

/* --- all of them --- */

static brio_status order_index(maker *m) {
    switch (m->options->order) {
    case BRIO_ORDER_BRIO_OCTREE:
    case BRIO_ORDER_BRIO_KDTREE:
    case BRIO_ORDER_OCTREE:
        return order_blocks(m);
    case BRIO_ORDER_INPUT:
        for (size_t i = 0; i < m->n; i++) m->index[i] = (uint32_t)i;
        return BRIO_OK;
    default:
        return order_items(m);
    }
}

brio_status brio_order_points(brio_context *ctx, const brio_input *input, const brio_delaunay_options *options,
                              uint32_t *order, uint32_t *rank, uint32_t *sequence, brio_round_ends *rounds) {
    brio_status status = BRIO_OK;
    size_t n = input->count;
    brio_round_ends ends = {1, {n}};
    bool in_rounds = has_rounds(options->order);
    maker m = {ctx, input->points, n, options, in_rounds ? NULL : order, in_rounds ? order : NULL};
    BRIO_TRY(order_index(&m));
    if (in_rounds)
        BRIO_TRY(brio_divide_into_rounds(
            ctx, &(brio_division){m.index, input->weights, n, ratio_of(options), options->seed, order, rank, sequence},
            &ends));
    else
        for (size_t i = 0; rank && i < n; i++) rank[i] = (uint32_t)i;
    assert(!sequence || (in_rounds && input->weights));
    assert(ends.end[ends.count - 1] == n);
    if (rounds) *rounds = ends;
done:
    if (m.index != order) brio_release(ctx, m.index);
    if (m.spare != order) brio_release(ctx, m.spare);
    return status;
}
