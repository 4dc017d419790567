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

/** Workspace for many flows, one after another. Arcs leave a node in the run node[v].first .. node[v + 1].first; the mate
 *  of an arc runs the other way. */
typedef struct {
    uint32_t head, mate;
    int32_t residual;
} brio_flow_arc;

typedef struct {
    uint32_t first;
    uint32_t parent;   /* the arc from the node to its parent, or a mark */
    uint32_t distance; /* to the terminal, right at the time of `checked` */
    uint32_t checked;
    uint32_t next_active; /* queue of active nodes, linked; a node in it points to itself at the end */
    uint32_t orphan;      /* not of this node: a place in the ring of orphans, which has each node at most once */
} brio_flow_node;

typedef struct {
    brio_context *ctx;
    brio_flow_node *node;
    brio_flow_arc *arc;
    size_t num_nodes, node_capacity, arc_capacity;
    int64_t *terminal;
    uint8_t *side;
    uint32_t time, active_head, active_tail;
    size_t orphan_first, num_orphans;
} brio_flow;

brio_flow brio_flow_new(brio_context *ctx);
void brio_flow_free(brio_flow *flow);

/** Finds a maximum flow.
 *  terminal  #nodes: what comes from the source at a node, or, negative, goes to the sink; used as workspace.
 *  side      #nodes, written.   num_edges  less than 2^31.
 *  Cost: linear where the flow is short, as in graphs nearly all of whose edges are at peace; 24 bytes an edge and as
 *  many a node.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE.
 *  Based on: [Boykov Kolmogorov 2004]. */
brio_status brio_flow_maximum(brio_flow *flow, size_t num_nodes, const brio_flow_edge *edges, size_t num_edges,
                              int64_t *terminal, uint8_t *side);

#endif
