/* Insertion orders: biased randomized insertion orders (BRIO) and simpler orders.
 *
 * A BRIO sorts the points for locality, along a Hilbert curve. It then divides the points into random rounds, and each
 * round keeps the sorted order. So an insertion touches mostly memory that the insertion before has touched.
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
#include "order/curve.h"
#include <assert.h>

enum { POINTS_A_THREAD = 1 << 13 };

static const double RATIO = 0.125; /* the share of the points that the rounds before the last one have */

/* The data of one call that computes an order. */
typedef struct {
    brio_context *ctx;
    const double *points;
    size_t n;
    const brio_delaunay_options *options;
    uint32_t *index; /* n: receives the points in the order before rounds; NULL until it is needed */
} maker;

bool brio_order_has_ranks(brio_order order) {
    return order != BRIO_ORDER_RANDOM && order != BRIO_ORDER_INPUT;
}

/* Sorts the points by a key: a random number, or their place along the curve. */
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
    if (!m->index) BRIO_TRY(BRIO_ALLOC(m->ctx, m->index, m->n));
    for (size_t i = 0; i < m->n; i++) m->index[i] = (uint32_t)items[i];
done:
    brio_release(m->ctx, items);
    brio_release(m->ctx, spare);
    return status;
}

brio_status brio_order_points(brio_context *ctx, const brio_input *input, const brio_delaunay_options *options,
                              uint32_t *order, uint32_t *rank, uint32_t *sequence, brio_round_ends *rounds) {
    brio_status status = BRIO_OK;
    const struct brio_order_part *part = BRIO_PART(ctx, order);
    size_t n = input->count;
    brio_round_ends ends = {1, {n}};
    bool in_rounds = options->order == BRIO_ORDER_BRIO;
    maker m = {ctx, input->points, n, options, in_rounds ? NULL : order};
    if (part) return part->order(part->user, ctx, input, options, &(brio_ordering){order, rank, rounds});
    if (options->order == BRIO_ORDER_INPUT) {
        for (size_t i = 0; i < n; i++) order[i] = (uint32_t)i;
    } else {
        BRIO_TRY(order_items(&m));
    }
    if (in_rounds) {
        double ratio = options->round_ratio > 0 ? options->round_ratio : RATIO;
        BRIO_TRY(brio_divide_into_rounds(
            ctx, &(brio_division){m.index, input->weights, n, ratio, options->seed, order, rank, sequence}, &ends));
    } else {
        for (size_t i = 0; rank && i < n; i++) rank[i] = (uint32_t)i;
    }
    assert(!sequence || (in_rounds && input->weights));
    assert(ends.end[ends.count - 1] == n);
    if (rounds) *rounds = ends;
done:
    if (m.index != order) brio_release(ctx, m.index);
    return status;
}
