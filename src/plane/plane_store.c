/* The store's construction from the caller's points: a biased randomized insertion order along a Hilbert curve,
 * or, on request, an order of space.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003. */
#include "plane/plane_store.h"
#include "base/memory.h"
#include "order/order.h"
#include "order/rounds.h"
#include <assert.h>

enum { MORE_RECORDS = 2 /* the apex and the infinite vertex */ };

/* Writes the points' indices in an order of space, of the points with 0 for their third coordinate. */
static brio_status order_as_in_space(brio_context *ctx, const brio_plane_input *input,
                                     const brio_delaunay2_options *options, uint32_t *order) {
    brio_status status = BRIO_OK;
    const brio_delaunay_options o = {
        .order = options->order, .round_ratio = options->round_ratio, .seed = options->seed};
    brio_plane_points points = brio_plane_input_points(input);
    double *rows = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, rows, 3 * input->count));
    for (size_t i = 0; i < input->count; i++)
        for (size_t k = 0; k < 2; k++) rows[3 * i + k] = points.rows[points.stride * i + (size_t)points.axis[k]];
    BRIO_TRY(brio_order_points(ctx, &(brio_input){rows, NULL, input->count}, &o, order, NULL, NULL, NULL));
done:
    brio_release(ctx, rows);
    return status;
}

/* Writes the points' indices in the order of insertion. */
static brio_status order_points(brio_context *ctx, const brio_plane_input *input, const brio_delaunay2_options *options,
                                uint32_t *order) {
    brio_status status = BRIO_OK;
    size_t n = input->count;
    uint64_t *items = NULL, *spare = NULL;
    uint32_t *index = NULL;
    brio_plane_points points = brio_plane_input_points(input);
    brio_round_ends ends;
    BRIO_TRY(brio_progress(ctx, "order", 0));
    if (options->order != BRIO_ORDER_BRIO || BRIO_PART(ctx, order))
        return order_as_in_space(ctx, input, options, order);
    BRIO_TRY(BRIO_ALLOC(ctx, items, n));
    BRIO_TRY(BRIO_ALLOC(ctx, spare, n));
    for (size_t i = 0; i < n; i++) items[i] = i;
    BRIO_TRY(brio_sort_along_plane_curve(ctx, &points, items, spare, n));
    brio_release(ctx, spare);
    spare = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, index, n));
    for (size_t i = 0; i < n; i++) index[i] = (uint32_t)items[i];
    double ratio = options->round_ratio > 0 ? options->round_ratio : 0.125;
    BRIO_TRY(
        brio_divide_into_rounds(ctx, &(brio_division){index, NULL, n, ratio, options->seed, order, NULL, NULL}, &ends));
done:
    brio_release(ctx, items);
    brio_release(ctx, spare);
    brio_release(ctx, index);
    return status;
}

/* Allocates the arrays beside the records. Their sizes are known. */
static brio_status allocate(brio_plane_store *s) {
    size_t records = s->num_points + MORE_RECORDS;
    assert(s->record && s->infinite == s->num_points + 1); /* the layout of plane_store.h */
    s->capacity = 2 * records;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->representative, records));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->triangle, s->capacity));
    if (s->weighted) BRIO_FORWARD(BRIO_ALLOC_ZERO(s->ctx, s->dug, s->capacity));
    for (size_t i = 0; i < records; i++) s->representative[i] = (uint32_t)i;
    return BRIO_OK;
}

static brio_status make_records(brio_plane_store *s, brio_plane_input *input) {
    brio_status status = brio_plane_records_new(s->ctx, input, s->caller, MORE_RECORDS, &s->record);
    brio_plane_input_free(s->ctx, input);
    assert(input->own == NULL);
    s->points_hash = input->hash;
    for (uint32_t i = 0; i < MORE_RECORDS; i++) s->caller[s->num_points + i] = BRIO_INFINITE;
    s->filter = (brio_plane_filter){.general = brio_plane_general(input)};
    brio_plane_input_key(input, &s->filter);
    return status;
}

brio_status brio_plane_store_new(brio_context *ctx, brio_plane_input *input, const brio_delaunay2_options *options,
                                 brio_plane_store **out) {
    brio_plane_store *s = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s, 1));
    s->ctx = ctx;
    s->num_points = input->count;
    s->infinite = (uint32_t)input->count + 1;
    s->weighted = input->weights != NULL;
    s->stats =
        (brio_delaunay2_stats){.size = sizeof s->stats, .points = input->count, .coordinates = input->coordinates};
    BRIO_TRY(BRIO_ALLOC(ctx, s->caller, input->count + MORE_RECORDS));
    BRIO_TRY(order_points(ctx, input, options, s->caller));
    BRIO_TRY(make_records(s, input));
    BRIO_TRY(allocate(s));
    *out = s;
    s = NULL;
done:
    brio_plane_store_free(s);
    return status;
}

void brio_plane_store_free(brio_plane_store *s) {
    if (!s) return;
    brio_release(s->ctx, s->triangle);
    brio_release(s->ctx, s->record);
    brio_release(s->ctx, s->caller);
    brio_release(s->ctx, s->representative);
    brio_release(s->ctx, s->unused.item);
    brio_release(s->ctx, s->ahead.item);
    brio_release(s->ctx, s->cavity.item);
    brio_release(s->ctx, s->boundary.item);
    brio_release(s->ctx, s->dug);
    brio_release(s->ctx, s);
}
