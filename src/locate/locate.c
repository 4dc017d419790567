/* The public queries for tetrahedra and for vertices. */
#include "base/float_state.h"
#include "base/memory.h"
#include "locate/holder.h"
#include "locate/place_search.h"

/* --- tetrahedra --- */

static brio_status answer_tetrahedra(void *user, brio_querent *q, const brio_query_row *row) {
    uint32_t *tetrahedra = user;
    brio_holder holders[BRIO_ABREAST];
    brio_find_holders(q, row, holders);
    for (size_t c = 0; c < row->count; c++) tetrahedra[row->index[c]] = brio_lowest_holder(q->l, &holders[c]);
    return BRIO_OK;
}

brio_status brio_locator_tetrahedra(brio_context *ctx, const brio_locator *l, const double *queries, size_t num_queries,
                                    uint32_t *tetrahedra) {
    BRIO_DOOR;
    const brio_query_batch b = {l, queries, num_queries, "locate", answer_tetrahedra, tetrahedra};
    return brio_answer_all(ctx, brio_query_threads(ctx, num_queries), &b);
}

/* --- vertices --- */

typedef struct {
    size_t wanted;
    bool power;
    uint32_t *vertices; /* of each query, `wanted` entries */
    brio_found *found;  /* of each thread, `room` entries */
    size_t room;        /* the most vertices that a query finds */
} vertex_job;

static brio_status answer_vertices(void *user, brio_querent *q, const brio_query_row *row) {
    const vertex_job *job = user;
    brio_found *found = job->found + job->room * (size_t)q->thread;
    for (size_t c = 0; c < row->count; c++) {
        uint32_t *out = job->vertices + job->wanted * row->index[c];
        size_t count = brio_search_places(q->l, row->x[c], job->power, job->wanted, q->nearest[c], found);
        for (size_t n = 0; n < job->wanted; n++) out[n] = n < count ? q->l->name[found[n].place] : BRIO_INFINITE;
        if (count) q->nearest[c] = found[0].place;
    }
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
    if (num_queries) job->room = job->wanted < l->num_vertices ? job->wanted : l->num_vertices;
    BRIO_TRY(BRIO_ALLOC(ctx, job->found, job->room * (size_t)threads));
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
