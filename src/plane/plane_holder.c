/* Point location in a finished triangulation of the plane: a walk from a triangle near the query. It ends in some
 * triangle that holds the query; the edges whose lines hold the query lead to the others.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#include "plane/plane_holder.h"
#include "base/finite.h"
#include "base/team.h"
#include <assert.h>
#include <math.h>

/* --- the order of queries --- */

/* Many queries of a triangulation of the plane. They are not sorted: the grid of the locator finds a
 * triangle near each one. */

/* QUERIES_A_CHUNK, QUERIES_A_THREAD: chosen. */
enum { QUERIES_A_CHUNK = 512, QUERIES_A_THREAD = 1024 };

int brio_plane_query_threads(brio_context *ctx, size_t count) {
    return brio_threads(ctx, count, QUERIES_A_THREAD);
}

static brio_status refuse_not_finite(brio_context *ctx, const double *queries, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const double x[2] = {queries[2 * i], queries[2 * i + 1]};
        if (brio_all_finite(x, 2)) continue;
        int k = isfinite(x[0]) ? 1 : 0;
        return brio_fail(ctx, BRIO_ERR_NOT_FINITE, "query %zu: %c is %s", i, "xy"[k], isnan(x[k]) ? "NaN" : "infinite");
    }
    return BRIO_OK;
}

typedef struct {
    brio_context *ctx;
    const brio_plane_batch *batch;
    brio_status status; /* the first failure; atomic */
} query_job;

static brio_status answer_one(const brio_plane_batch *b, brio_plane_querent *q, size_t i) {
    const double x[4] = {b->queries[2 * i] + 0.0, b->queries[2 * i + 1] + 0.0, 0, 0}; /* -0 becomes 0 */
    return brio_all_finite(x, 2) ? b->answer(b->user, q, i, x) : BRIO_ERR_NOT_FINITE;
}

static void answer_chunk(void *user, size_t begin, size_t end, int thread) {
    query_job *job = user;
    const brio_plane_batch *b = job->batch;
    assert(begin < end && end <= b->count);
    brio_plane_querent q = {b->l, thread, b->l->filter};
    brio_status status = BRIO_OK;
    if (__atomic_load_n(&job->status, __ATOMIC_RELAXED) != BRIO_OK) return;
    if (thread == 0) status = brio_progress(job->ctx, b->stage, (double)begin / (double)b->count);
    for (size_t i = begin; i < end && status == BRIO_OK; i++) status = answer_one(b, &q, i);
    brio_report(&job->status, status);
}

brio_status brio_plane_answer_all(brio_context *ctx, int threads, const brio_plane_batch *b) {
    query_job job = {ctx, b, refuse_not_finite(ctx, b->queries, b->count)};
    if (job.status != BRIO_OK) return job.status;
    brio_report(&job.status, brio_for_chunks(ctx, threads, b->count, QUERIES_A_CHUNK, answer_chunk, &job));
    if (job.status == BRIO_ERR_NOT_FINITE)
        return brio_fail(ctx, BRIO_ERR_NOT_FINITE,
                         "the queries changed during the call, to numbers that are not finite");
    return job.status;
}

/* --- the holder --- */

static unsigned zero_sides(brio_plane_querent *q, uint32_t t, const double *x) {
    const brio_locator2 *l = q->l;
    assert(t < l->num_finite);
    const uint32_t *v = l->triangle[t].vertex;
    unsigned zeros = 0;
    for (uint32_t i = 0; i < 3; i++) {
        const double *from = l->record[v[brio_slot_after(i)]], *to = l->record[v[brio_slot_before(i)]];
        zeros |= (unsigned)(brio_orient2d_sign(&q->filter, from, to, x) == 0) << i;
    }
    return zeros;
}

/* Walks to a finite triangle whose closure holds x, or returns BRIO_INFINITE. Keeps which lines of its edges hold x:
 * not that of the edge by which the walk came in, because x was strictly beyond it. */
static uint32_t walk(brio_plane_querent *q, const double *x, unsigned *zeros) {
    const brio_locator2 *l = q->l;
    uint32_t t = *brio_locator2_square(l, x), entered = 3;
    for (;;) {
        const uint32_t *v = l->triangle[t].vertex;
        uint32_t out = 3;
        *zeros = 0;
        for (uint32_t i = 0; i < 3 && out == 3; i++) {
            if (i == entered) continue;
            int sign =
                brio_orient2d_sign(&q->filter, l->record[v[brio_slot_after(i)]], l->record[v[brio_slot_before(i)]], x);
            if (sign < 0) out = i;
            *zeros |= (unsigned)(sign == 0) << i;
        }
        if (out == 3) return t;
        uint32_t mate = l->triangle[t].mate[out];
        t = brio_triangle_of(mate), entered = brio_edge_slot(mate);
        if (t >= l->num_finite) return BRIO_INFINITE;
    }
}

/* Returns the lowest index of the triangles that hold a query which is in triangle t. */
static uint32_t lowest_holder(const brio_locator2 *l, uint32_t t, unsigned zeros) {
    assert(t < l->num_finite && zeros < 7);
    const brio_triangle *own = &l->triangle[t];
    if (!zeros) return t;
    if (zeros & (zeros - 1)) return l->corner[own->vertex[__builtin_ctz(~zeros)]];
    uint32_t other = brio_triangle_of(own->mate[__builtin_ctz(zeros)]);
    return other < l->num_finite && other < t ? other : t;
}

brio_plane_holder brio_plane_find_holder(brio_plane_querent *q, const double *x) {
    const brio_locator2 *l = q->l;
    if (!l->num_finite || !brio_locator2_boxes(l, x)) return (brio_plane_holder){BRIO_INFINITE, 0};
    unsigned zeros;
    uint32_t t = walk(q, x, &zeros);
    if (t == BRIO_INFINITE) return (brio_plane_holder){BRIO_INFINITE, 0};
    uint32_t lowest = lowest_holder(l, t, zeros);
    return (brio_plane_holder){lowest, lowest == t ? zeros : zero_sides(q, lowest, x)};
}

bool brio_plane_holder_on_hull(const brio_locator2 *l, const brio_plane_holder *h) {
    assert(h->triangle < l->num_finite && __builtin_popcount(h->zeros) < 2);
    return h->zeros && brio_triangle_of(l->triangle[h->triangle].mate[__builtin_ctz(h->zeros)]) >= l->num_finite;
}
