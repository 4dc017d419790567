/* Maximum flow and minimum cut of an undirected graph with terminals. */
#ifndef BRIO_RECONSTRUCT_MAX_FLOW_H
#define BRIO_RECONSTRUCT_MAX_FLOW_H

#include "base/context.h"

/** An edge between nodes a and b. Its capacity, in each direction, is less than 2^30. */
typedef struct {
    uint32_t a, b;
    int32_t capacity;
} brio_flow_edge;

/** The side of a node after a maximum flow. SOURCE: the residual arcs lead from the source to the node. SINK: they lead
 *  from the node to the sink. FREE: neither. The sides are the same for every maximum flow. */
typedef enum { BRIO_FLOW_FREE = 0, BRIO_FLOW_SOURCE = 1, BRIO_FLOW_SINK = 2 } brio_flow_side;

/** An arc of the residual graph. The arcs that leave node v are arc[first[v]] to arc[first[v + 1] - 1]. */
typedef struct {
    /* The arc ends at `head`; arc `mate` is the same edge in the other direction. */
    uint32_t head, mate;
    int32_t residual;
} brio_flow_arc;

/** The place of a node in the search trees (flow_body.h). */
typedef struct {
    uint32_t parent;   /* the arc from the node to its parent, or a mark */
    uint32_t distance; /* of the node from its terminal, right at the time `checked` */
    uint32_t checked;
    uint32_t next_active; /* next in the queue of active nodes; the last node names itself; NO_NODE outside */
    uint32_t orphan;      /* an entry of the ring of orphans, unrelated to this node */
} brio_flow_node;

typedef struct {
    size_t room; /* entries of the ring of orphans, at least the nodes */
    uint32_t time, active_head, active_tail;
    size_t orphan_first, num_orphans;
} brio_flow_trees;

/** Workspace for many flows, one after another. */
typedef struct {
    brio_context *ctx;
    uint32_t *first;
    brio_flow_node *node;
    brio_flow_arc *arc;
    size_t num_nodes, first_capacity, node_capacity, arc_capacity;
    int64_t *terminal;
    uint8_t *side;
    brio_flow_trees trees;
} brio_flow;

brio_flow brio_flow_new(brio_context *ctx);
void brio_flow_free(brio_flow *flow);

/** Finds a maximum flow and the side of every node.
 *  num_nodes, num_edges  num_edges is less than 2^31 - 2.
 *  terminal  #nodes: a positive entry is the capacity from the source to the node, a negative one that from the node to
 *            the sink. The function overwrites the array.
 *  side      #nodes, written: a brio_flow_side for each node.
 *  Cost: linear in the edges if the augmenting paths are few and short. Memory: 24 bytes an edge and 24 a node.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE.
 *  Based on: [Boykov Kolmogorov 2004]. */
brio_status brio_flow_maximum(brio_flow *flow, size_t num_nodes, const brio_flow_edge *edges, size_t num_edges,
                              int64_t *terminal, uint8_t *side);

#endif
