/* The caller's edges as lists of neighbours. */
#ifndef BRIO_LABORATORY_POINT_GRAPH_H
#define BRIO_LABORATORY_POINT_GRAPH_H

#include "brio/laboratory.h"
#include "triangulation/store.h"

/** The neighbours of record p are the records neighbour[first[p] .. first[p + 1]). */
typedef struct {
    uint32_t *first, *neighbour;
} brio_point_graph;

/** Makes the graph of the options' edges, at most 2^31 - 1. The caller frees the
 *  graph, also after a failure. */
brio_status brio_point_graph_new(const brio_store *store, const brio_laboratory_options *options,
                                 brio_point_graph *out);
void brio_point_graph_free(brio_context *ctx, brio_point_graph *graph);

#endif
