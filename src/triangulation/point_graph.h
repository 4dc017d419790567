/* The caller's edges as lists of neighbours. */
#ifndef BRIO_TRIANGULATION_POINT_GRAPH_H
#define BRIO_TRIANGULATION_POINT_GRAPH_H

#include "triangulation/store.h"

/** Record p has the neighbours neighbour[first[p] .. first[p + 1]), records too. */
typedef struct {
    uint32_t *first, *neighbour;
} brio_point_graph;

/** The graph of the options' edges; BRIO_ERR_TOO_LARGE beyond 2^31 - 1 edges. After a failure it is to be freed, too. */
brio_status brio_point_graph_new(const brio_store *store, const brio_delaunay_options *options, brio_point_graph *out);
void brio_point_graph_free(brio_context *ctx, brio_point_graph *graph);

#endif
