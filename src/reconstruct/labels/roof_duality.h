/* Labels of least energy for a block of nodes, where roof duality decides them. */
#ifndef BRIO_RECONSTRUCT_ROOF_DUALITY_H
#define BRIO_RECONSTRUCT_ROOF_DUALITY_H

#include "reconstruct/labels/max_flow.h"
#include "reconstruct/labels/node_blocks.h"

/** A node of the block at hand. */
typedef struct {
    int64_t pull;    /* what edges want the node to keep its label, less what edges want it flipped, by weight: edges to
                        nodes outside the block, and to settled nodes */
    int64_t loose;   /* the weight of the edges to nodes of the block that are not settled */
    uint32_t end;    /* where the node's edges within the block end; they begin where those of the node before end */
    uint32_t number; /* of an open node in the flow; ROOF_KEEPS or ROOF_FLIPS of a settled one */
} brio_roof_node;

/** An edge between nodes of the block, at both of its ends. A positive weight wants both ends flipped or none. */
typedef struct {
    uint32_t node;
    int32_t weight;
} brio_roof_edge;

/** Workspace for many blocks, one after another. {.flow = brio_flow_new(ctx)} is an empty workspace. */
typedef struct {
    brio_flow flow;
    uint32_t size, num_open; /* nodes of the block; those that are not settled */
    brio_roof_node *node;
    brio_roof_edge *near;
    uint32_t *settled; /* in the order in which they were settled */
    brio_flow_edge *edge;
    int64_t *terminal;
    uint8_t *side;
    size_t num_near, num_settled, num_edges;
    size_t node_capacity, near_capacity, settled_capacity, edge_capacity, terminal_capacity, side_capacity;
    size_t undecided, toggled; /* nodes in all blocks so far that were not decided, and that were flipped */
} brio_roof;

void brio_roof_free(brio_roof *r);

/** Flips labels of nodes in a block; all other labels stay. The energy does not rise. Reads the labels of the block's
 *  nodes and of their neighbours, and writes labels of the block's nodes only.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_roof_settle(brio_roof *r, const brio_signed_graph *g, const brio_node_blocks *blocks, size_t block,
                             uint8_t *label);

#endif
