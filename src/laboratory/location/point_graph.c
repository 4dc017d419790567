/* Builds lists of neighbours from pairs of points: copies, counts, sums, fills. The caller's edges are read once, since
 * another thread of the caller may write to them. */
#include "laboratory/location/point_graph.h"
#include "base/memory.h"
#include <assert.h>
#include <string.h>

void brio_point_graph_free(brio_context *ctx, brio_point_graph *graph) {
    brio_release(ctx, graph->first);
    brio_release(ctx, graph->neighbour);
}

brio_status brio_point_graph_new(const brio_store *store, const brio_laboratory_options *options,
                                 brio_point_graph *out) {
    brio_status status = BRIO_OK;
    size_t n = store->num_points, ends = 2 * options->num_edges;
    uint32_t *record = NULL, *end = NULL, *first, sum = 0;
    memset(out, 0, sizeof *out);
    BRIO_REQUIRE(store->ctx, options->edges || !ends, BRIO_ERR_ARGUMENT, "%zu edges, but no array of them",
                 options->num_edges);
    BRIO_TRY(BRIO_ALLOC(store->ctx, record, n));
    for (uint32_t p = 0; p < n; p++) record[store->caller[p]] = p;
    BRIO_TRY(BRIO_ALLOC_ZERO(store->ctx, out->first, n + 1));
    BRIO_TRY(BRIO_ALLOC(store->ctx, out->neighbour, ends));
    BRIO_TRY(BRIO_ALLOC(store->ctx, end, ends));
    first = out->first;
    for (size_t i = 0; i < ends; i++) {
        uint32_t point = __atomic_load_n(&options->edges[i], __ATOMIC_RELAXED);
        BRIO_REQUIRE(store->ctx, point < n, BRIO_ERR_ARGUMENT, "edge %zu ends at point %u of %zu", i / 2,
                     BRIO_POINT(store->ctx, point), n);
        end[i] = record[point];
        first[end[i]]++;
    }
    for (size_t p = 0; p < n; p++)
        first[p] = sum += first[p]; /* the end of the list of p; filling moves first[p] back to the list's start */
    assert(sum == ends);
    first[n] = sum;
    for (size_t i = 0; i < ends; i++) out->neighbour[--first[end[i]]] = end[i ^ 1];
    assert(n == 0 || first[0] == 0); /* filled lists begin where they are to begin */
done:
    brio_release(store->ctx, record);
    brio_release(store->ctx, end);
    return status;
}
