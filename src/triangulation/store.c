/* The store: its construction from the caller's points, and its slots. */
#include "triangulation/store.h"
#include "base/memory.h"
#include "base/team.h"
#include "order/order.h"
#include "triangulation/insertion_part.h"
#include "triangulation/records.h"
#include <assert.h>
#include <math.h>

enum { POINTS_A_THREAD = 512, MORE_RECORDS = 3 /* two apexes and the infinite vertex */ };

/* Makes a store for n points, without arrays. */
static brio_status begin_store(brio_context *ctx, size_t n, brio_store **out) {
    brio_status status = BRIO_ALLOC_ZERO(ctx, *out, 1);
    if (status != BRIO_OK) return status;
    (*out)->ctx = ctx;
    (*out)->num_points = n;
    (*out)->t.infinite = (uint32_t)n + 2;
    return BRIO_OK;
}

/* Makes the arrays beside those of the records. */
static brio_status end_store(brio_store *s) {
    assert(s->record && s->caller && s->t.infinite == s->num_points + 2); /* the layout of store.h */
    size_t n = s->num_points + MORE_RECORDS;
    s->record[s->t.infinite][3] = INFINITY; /* as conflict_lanes.h knows the infinite vertex */
    s->t.record = s->record;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->representative, n));
    brio_expect_sequence(s->representative);
    for (uint32_t i = 0; i < n; i++) s->representative[i] = i;
    brio_expect_random(s->representative);
    return BRIO_ALLOC(s->ctx, s->local, n);
}

brio_status brio_store_new(brio_context *ctx, const brio_input *input, const brio_delaunay_options *options,
                           brio_round_ends *rounds, brio_store **out) {
    brio_store *s = NULL;
    size_t n = input->count;
    const struct brio_insertion_part *part = BRIO_PART(ctx, insertion);
    bool in_blocks = BRIO_PART(ctx, order) != NULL;
    bool parallel = brio_threads(ctx, n, POINTS_A_THREAD) > 1 && (!part || !part->alone);
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(begin_store(ctx, n, &s));
    s->weighted = input->weights != NULL;
    s->follows = in_blocks || options->order != BRIO_ORDER_RANDOM;
    s->max_tetrahedra = options->max_tetrahedra;
    BRIO_TRY(BRIO_ALLOC(ctx, s->caller, n + MORE_RECORDS));
    BRIO_TRY(brio_progress(ctx, "order", 0));
    if (parallel && (in_blocks || brio_order_has_ranks(options->order)))
        BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->rank, n + MORE_RECORDS));
    if (s->weighted && options->order == BRIO_ORDER_BRIO && !in_blocks && (!part || part->walks))
        BRIO_TRY(BRIO_ALLOC(ctx, s->sequence, n));
    BRIO_TRY(brio_order_points(ctx, input, options, s->caller, s->rank, s->sequence, rounds));
    BRIO_TRY(brio_records_new(ctx, input, s->caller, MORE_RECORDS, &s->points_hash, &s->record));
    BRIO_TRY(end_store(s));
    *out = s;
    s = NULL;
done:
    brio_store_free(s);
    return status;
}

brio_status brio_store_sample(const brio_store *from, size_t n, brio_store **out) {
    brio_store *s = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(begin_store(from->ctx, n, &s));
    s->weighted = from->weighted;
    s->max_tetrahedra = from->max_tetrahedra;
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, s->record, n + MORE_RECORDS));
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->caller, n + MORE_RECORDS));
    BRIO_TRY(end_store(s));
    *out = s;
    s = NULL;
done:
    brio_store_free(s);
    return status;
}

void brio_store_drop_records(brio_store *s) {
    brio_release(s->ctx, s->record);
    s->record = NULL;
    s->t.record = NULL;
    brio_release(s->ctx, s->sequence);
    s->sequence = NULL;
}

void brio_store_free(brio_store *s) {
    if (!s) return;
    brio_release(s->ctx, s->t.tet);
    brio_release(s->ctx, s->state);
    brio_release(s->ctx, s->record);
    brio_release(s->ctx, s->rank);
    brio_release(s->ctx, s->sequence);
    brio_release(s->ctx, s->caller);
    brio_release(s->ctx, s->representative);
    brio_release(s->ctx, s->local);
    brio_release(s->ctx, s);
}

brio_status brio_store_reserve(brio_store *s, size_t more) {
    size_t need = s->t.count + more, capacity = need + need / 8 + 1024;
    assert(s->t.count <= s->capacity && s->max_tetrahedra <= (size_t)1 << 30);
    if (need <= s->capacity) return BRIO_OK;
    BRIO_EXPECT(s->ctx, need <= s->max_tetrahedra, BRIO_ERR_TOO_LARGE, "more than %zu tetrahedra", s->max_tetrahedra);
    if (capacity > s->max_tetrahedra) capacity = s->max_tetrahedra;
    BRIO_FORWARD(BRIO_RESIZE(s->ctx, s->t.tet, capacity));
    BRIO_FORWARD(BRIO_RESIZE(s->ctx, s->state, capacity));
    assert(need <= capacity && capacity <= (size_t)1 << 30); /* facet handles have 32 bits */
    s->capacity = capacity;
    return BRIO_OK;
}

brio_status brio_store_fit(brio_store *s) {
    BRIO_FORWARD(BRIO_RESIZE(s->ctx, s->t.tet, s->t.count));
    BRIO_FORWARD(BRIO_RESIZE(s->ctx, s->state, s->t.count));
    s->capacity = s->t.count;
    return BRIO_OK;
}

bool brio_store_take(brio_store *s, size_t size, size_t *begin) {
    assert(size > 0);
    *begin = __atomic_load_n(&s->t.count, __ATOMIC_RELAXED);
    do { /* taken only when it fits: giving back what did not could give away another thread's slots */
        if (*begin + size > s->capacity) return false;
    } while (!__atomic_compare_exchange_n(&s->t.count, begin, *begin + size, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED));
    assert(*begin + size <= s->capacity);
    return true;
}
