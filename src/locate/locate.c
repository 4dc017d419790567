/* The public queries for tetrahedra and for vertices. */
#include "base/float_state.h"
#include "base/memory.h"
#include "locate/holder.h"
#include "locate/place_search.h"

/* --- tetrahedra --- */

static brio_status answer_tetrahedron(void *user, brio_querent *q, size_t i, const double *x) {
    uint32_t *tetrahedra = user;
    brio_holder h = brio_find_holder(q, x);
    tetrahedra[i] = brio_lowest_holder(q->l, &h);
    return BRIO_OK;
}

brio_status brio_locator_tetrahedra(brio_context *ctx, const brio_locator *l, const double *queries, size_t num_queries,
                                    uint32_t *tetrahedra) {
    BRIO_DOOR;
    const brio_query_batch b = {l, queries, num_queries, "locate", answer_tetrahedron, tetrahedra};
    return brio_answer_all(ctx, brio_query_threads(ctx, num_queries), &b);
}

/* --- vertices --- */

typedef struct {
    size_t wanted;
    bool power;
    uint32_t *vertices;
    brio_found *found; /* of each thread, `wanted` entries */
} vertex_job;

static brio_status answer_vertices(void *user, brio_querent *q, size_t i, const double *x) {
    const vertex_job *job = user;
    brio_found *found = job->found + job->wanted * (size_t)q->thread;
    uint32_t *out = job->vertices + job->wanted * i;
    size_t count = brio_search_places(q->l, x, job->power, job->wanted, q->nearest, found);
    for (size_t n = 0; n < job->wanted; n++) out[n] = n < count ? q->l->name[found[n].place] : BRIO_INFINITE;
    if (count) q->nearest = found[0].place;
    return BRIO_OK;
}

static brio_status find_vertices(brio_context *ctx, const brio_locator *l, const double *queries, size_t num_queries,
                                 vertex_job *job) {
    brio_status status = BRIO_OK;
    int threads = brio_query_threads(ctx, num_queries);
    const brio_query_batch b = {l, queries, num_queries, "nearest", answer_vertices, job};
    BRIO_REQUIRE(ctx, job->wanted > 0, BRIO_ERR_ARGUMENT, "0 vertices of each query are wanted; at least 1");
    BRIO_REQUIRE(ctx, job->wanted <= BRIO_INFINITE, BRIO_ERR_TOO_LARGE, "%zu vertices of each query are wanted",
                 job->wanted);
    BRIO_TRY(BRIO_ALLOC(ctx, job->found, job->wanted * (size_t)threads));
    BRIO_TRY(brio_answer_all(ctx, threads, &b));
done:
    brio_release(ctx, job->found);
    return status;
}

brio_status brio_locator_nearest(brio_context *ctx, const brio_locator *l, const double *queries, size_t num_queries,
                                 size_t count, uint32_t *vertices) {
    BRIO_DOOR;
    return find_vertices(ctx, l, queries, num_queries, &(vertex_job){.wanted = count, .vertices = vertices});
}

brio_status brio_locator_least_power(brio_context *ctx, const brio_locator *l, const double *queries,
                                     size_t num_queries, uint32_t *vertices) {
    BRIO_DOOR;
    return find_vertices(ctx, l, queries, num_queries, &(vertex_job){.wanted = 1, .power = true, .vertices = vertices});
}
