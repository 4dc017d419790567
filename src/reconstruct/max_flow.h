/* Maximum flow and minimum cut of an undirected graph with terminals. */
#ifndef BRIO_RECONSTRUCT_MAX_FLOW_H
#define BRIO_RECONSTRUCT_MAX_FLOW_H

#include "base/context.h"

/** An edge between nodes a and b that carries up to `capacity` either way, less than 2^30. */
typedef struct {
    uint32_t a, b;
    int32_t capacity;
} brio_flow_edge;

/** Where a node is after a maximum flow. The two sides do not depend on the flow that was found: they are the least
 *  sets on either side of a minimum cut. */
typedef enum { BRIO_FLOW_FREE = 0, BRIO_FLOW_SOURCE = 1, BRIO_FLOW_SINK = 2 } brio_flow_side;

/** More than all edges of a node can carry. */
#define BRIO_FLOW_ENDLESS (INT64_C(1) << 62)

/** Finds a maximum flow, unless that takes more than `work` looks at an arc in the repair of the search trees: then *ended
 *  is false, and the sides mean nothing.
 *  terminal  #nodes: what comes from the source at a node, or, negative, goes to the sink; used as workspace.
 *  side      #nodes, written.   num_edges  less than 2^31.
 *  Cost: linear where the flow is short, as in graphs nearly all of whose edges are at peace; 28 bytes an edge.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED.
 *  Based on: [Boykov Kolmogorov 2004]. */
brio_status brio_max_flow(brio_context *ctx, size_t num_nodes, const brio_flow_edge *edges, size_t num_edges,
                          int64_t *terminal, uint8_t *side, uint64_t work, bool *ended);

#endif
