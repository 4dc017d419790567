/* Point location in a finished triangulation: a walk from the last answer, or from a vertex that the k-d tree finds
 * near the query. The walk ends in some tetrahedron that holds the query. Which one depends on its start; the facets
 * whose planes hold the query lead to all the others.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#include "locate/holder.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/team.h"
#include "locate/place_search.h"
#include "order/curve.h"
#include "triangulation/ring.h"
#include <math.h>

/* --- the order of queries --- */

/* Many queries at once: sorted along a Hilbert curve, so that each walk is short and the memory that it reads is in the
 * cache, and divided among threads. The queries are taken in blocks, which bounds the workspace. */

/* FEWEST_SORTED, QUERIES_A_CHUNK, QUERIES_A_THREAD, BLOCK: chosen. SPARSE: chosen; where the locator has this many
 * times more vertices than there are queries, a query starts from the tree and not from the query before it. */
enum { FEWEST_SORTED = 32, QUERIES_A_CHUNK = 512, QUERIES_A_THREAD = 1024, BLOCK = 1 << 20, SPARSE = 16 };

int brio_query_threads(brio_context *ctx, size_t count) {
    return brio_threads(ctx, count < BLOCK ? count : BLOCK, QUERIES_A_THREAD);
}

brio_status brio_refuse_queries(brio_context *ctx, const double *queries, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const double x[3] = {queries[3 * i], queries[3 * i + 1], queries[3 * i + 2]};
        if (brio_all_finite(x, 3)) continue;
        int k = 0;
        while (k < 2 && isfinite(x[k])) k++;
        return brio_fail(ctx, BRIO_ERR_NOT_FINITE, "query %zu: %c is %s", i, "xyz"[k],
                         isnan(x[k]) ? "NaN" : "infinite");
    }
    return BRIO_OK;
}

typedef struct {
    brio_context *ctx;
    const brio_query_batch *batch;
    size_t begin;          /* the first query of the block */
    const uint64_t *items; /* low halves: the queries of the block in the order of the curve; NULL: as they are */
    bool near;
    brio_status status; /* the first failure; atomic */
} block_job;

static inline size_t query_at(const block_job *job, size_t i) {
    return job->begin + (job->items ? (size_t)(uint32_t)job->items[i] : i);
}

/* Takes the queries i, i + stride, ... before `end` in the order of the block. Returns false if one is not finite: all
 * were when the call began, but another thread of the caller may write to them. */
static bool take_row(const block_job *job, size_t i, size_t stride, size_t end, brio_query_row *row) {
    const double *queries = job->batch->queries;
    for (row->count = 0; i < end && row->count < BRIO_ABREAST; i += stride) {
        size_t query = query_at(job, i), c = row->count++;
        for (size_t k = 0; k < 3; k++) row->x[c][k] = queries[3 * query + k] + 0.0; /* -0 becomes 0 */
        row->x[c][3] = 0;
        row->index[c] = query;
        if (i + 2 < end) __builtin_prefetch(queries + 3 * query_at(job, i + 2));
        if (!brio_all_finite(row->x[c], 3)) return false;
    }
    return true;
}

static void begin_querent(const block_job *job, int thread, brio_querent *q) {
    const brio_locator *l = job->batch->l;
    *q = (brio_querent){.l = l, .thread = thread, .filter = l->filter, .near = job->near};
    for (int c = 0; c < BRIO_ABREAST; c++) q->walk[c].start = BRIO_NO_TET, q->nearest[c] = BRIO_INFINITE;
}

static void answer_chunk(void *user, size_t begin, size_t end, int thread) {
    block_job *job = user;
    const brio_query_batch *b = job->batch;
    size_t rows = (end - begin + BRIO_ABREAST - 1) / BRIO_ABREAST;
    brio_querent q;
    begin_querent(job, thread, &q);
    if (__atomic_load_n(&job->status, __ATOMIC_RELAXED) != BRIO_OK) return;
    if (thread == 0)
        brio_report(&job->status, brio_progress(job->ctx, b->stage, (double)(job->begin + begin) / (double)b->count));
    for (size_t r = 0; r < rows; r++) {
        brio_query_row row;
        bool finite = take_row(job, begin + r, rows, end, &row);
        brio_status status = finite ? b->answer(b->user, &q, &row) : BRIO_ERR_NOT_FINITE;
        if (status == BRIO_OK) continue;
        brio_report(&job->status, status);
        return;
    }
}

static brio_status answer_block(block_job *job, int threads, size_t count, uint64_t *items, uint64_t *spare) {
    const double *queries = job->batch->queries + 3 * job->begin;
    if (items) {
        for (size_t i = 0; i < count; i++) items[i] = i;
        brio_status status = brio_sort_along_curve(job->ctx, queries, items, spare, count, threads);
        if (status != BRIO_OK) return status;
    }
    job->items = items;
    job->near = items && count >= job->batch->l->num_vertices / SPARSE;
    brio_report(&job->status, brio_for_chunks(job->ctx, threads, count, QUERIES_A_CHUNK, answer_chunk, job));
    if (job->status == BRIO_ERR_NOT_FINITE)
        return brio_fail(job->ctx, BRIO_ERR_NOT_FINITE,
                         "the queries changed during the call, to numbers that are not finite");
    return job->status;
}

brio_status brio_answer_all(brio_context *ctx, int threads, const brio_query_batch *b) {
    brio_status status = BRIO_OK;
    uint64_t *items = NULL, *spare = NULL;
    size_t most = b->count < BLOCK ? b->count : BLOCK;
    BRIO_TRY(brio_refuse_queries(ctx, b->queries, b->count));
    if (most >= FEWEST_SORTED) {
        BRIO_TRY(BRIO_ALLOC(ctx, items, most));
        BRIO_TRY(BRIO_ALLOC(ctx, spare, most));
    }
    for (size_t begin = 0; begin < b->count; begin += BLOCK) {
        block_job job = {.ctx = ctx, .batch = b, .begin = begin};
        size_t count = b->count - begin < BLOCK ? b->count - begin : BLOCK;
        BRIO_TRY(answer_block(&job, threads, count, items, spare));
    }
done:
    brio_release(ctx, items);
    brio_release(ctx, spare);
    return status;
}

/* --- the holder --- */

/* Returns the sides of the query: bit i if it is in the plane of facet i. The query is beyond no facet.
 * unsure  the facets whose planes may hold it */
static unsigned zero_sides(brio_querent *q, uint32_t tet, unsigned unsure, const double *x) {
    const brio_locator *l = q->l;
    const uint32_t *v = l->t.tet[tet].vertex;
    unsigned zeros = 0;
    for (unsigned left = unsure; left; left &= left - 1) {
        int i = __builtin_ctz(left);
        const uint8_t *f = BRIO_FACET[i];
        const brio_record *r = l->t.record;
        zeros |= (unsigned)(brio_orient3d_sign(&q->filter, r[v[f[0]]], r[v[f[1]]], r[v[f[2]]], x) == 0) << i;
    }
    return zeros;
}

/* Returns the columns whose queries can be inside, with starts for their walks. */
static unsigned start_walks(brio_querent *q, const brio_query_row *row) {
    const brio_locator *l = q->l;
    unsigned which = 0;
    for (size_t c = 0; c < row->count && l->num_finite; c++) {
        if (!brio_locator_boxes(l, row->x[c])) continue;
        which |= 1u << c;
        if (!q->near || q->walk[c].start == BRIO_NO_TET)
            q->walk[c].start = l->vertex_tet[brio_place_near(l, row->x[c])];
    }
    return which;
}

void brio_find_holders(brio_querent *q, const brio_query_row *row, brio_holder holders[BRIO_ABREAST]) {
    const brio_locator *l = q->l;
    uint32_t found[BRIO_ABREAST];
    unsigned which = start_walks(q, row);
    l->engine->walk_abreast(&l->t, &q->filter, q->walk, row->x, which, found);
    for (size_t c = 0; c < row->count; c++) {
        holders[c] = (brio_holder){BRIO_INFINITE, 0};
        if (!(which >> c & 1)) continue;
        q->walk[c].start = found[c];
        if (!brio_is_infinite(&l->t, found[c]))
            holders[c] = (brio_holder){found[c], zero_sides(q, found[c], q->walk[c].unsure, row->x[c])};
    }
}

/* --- the tetrahedra that share a facet, an edge or a vertex with the query on it --- */

/* Finds the two slots whose bits are not set, in ascending order. */
static void other_slots(unsigned two, int *i, int *j) {
    unsigned rest = ~two & 15;
    *i = __builtin_ctz(rest);
    *j = __builtin_ctz(rest & (rest - 1));
}

static inline uint32_t lower(const brio_locator *l, uint32_t a, uint32_t b) {
    return b < l->num_finite && b < a ? b : a;
}

static uint32_t lowest_of_ring(const brio_locator *l, const brio_holder *h) {
    int i, j;
    uint32_t lowest = h->tet;
    other_slots(h->zeros, &i, &j);
    brio_ring ring = brio_ring_second(&l->t, h->tet, i, j);
    do lowest = lower(l, lowest, ring.tet);
    while (brio_ring_next(&ring));
    return lowest;
}

uint32_t brio_lowest_holder(const brio_locator *l, const brio_holder *h) {
    if (h->tet == BRIO_INFINITE || !h->zeros) return h->tet;
    const brio_tetrahedron *tet = &l->t.tet[h->tet];
    switch (__builtin_popcount(h->zeros)) {
    case 1:
        return lower(l, h->tet, brio_tet_of(tet->mate[__builtin_ctz(h->zeros)]));
    case 2:
        return lowest_of_ring(l, h);
    default:
        return l->vertex_tet[tet->vertex[__builtin_ctz(~h->zeros & 15)]];
    }
}

void brio_find_lowest_holders(brio_querent *q, const brio_query_row *row, brio_holder holders[BRIO_ABREAST]) {
    brio_find_holders(q, row, holders);
    for (size_t c = 0; c < row->count; c++) {
        uint32_t lowest = brio_lowest_holder(q->l, &holders[c]);
        if (lowest != holders[c].tet) holders[c] = (brio_holder){lowest, zero_sides(q, lowest, 15, row->x[c])};
    }
}

bool brio_holder_on_hull(const brio_locator *l, const brio_holder *h) {
    const brio_tetrahedron *tet = &l->t.tet[h->tet];
    int i, j;
    if (!h->zeros) return false;
    if (__builtin_popcount(h->zeros) == 1) return brio_tet_of(tet->mate[__builtin_ctz(h->zeros)]) >= l->num_finite;
    other_slots(h->zeros, &i, &j);
    brio_ring ring = brio_ring_second(&l->t, h->tet, i, j);
    do
        if (ring.tet >= l->num_finite) return true;
    while (brio_ring_next(&ring));
    return false;
}
