/* Many queries of a triangulation of the plane, see plane_queries.h. They are not sorted: the grid of the locator finds a
 * triangle near each one. */
#include "plane/plane_queries.h"
#include "base/finite.h"
#include "base/team.h"
#include <assert.h>
#include <math.h>

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
