/* Labels of least energy for a block of nodes, where roof duality decides them. */
#ifndef BRIO_RECONSTRUCT_ROOF_DUALITY_H
#define BRIO_RECONSTRUCT_ROOF_DUALITY_H

#include "reconstruct/labels/max_flow.h"
#include "reconstruct/labels/node_blocks.h"

/** Workspace for many blocks, one after another. {.flow = brio_flow_new(ctx)} is an empty workspace. */
typedef struct {
    brio_flow flow;
    brio_flow_edge *edge;
    int64_t *terminal;
    uint8_t *side;
    size_t num_edges, edge_capacity, terminal_capacity, side_capacity;
    size_t undecided, toggled; /* nodes in all blocks so far that were not decided, and that were flipped */
} brio_roof;

void brio_roof_free(brio_roof *r);

/** Flips labels of nodes in a block; all other labels stay. The energy does not rise. Reads the labels of the block's
 *  nodes and of their neighbours, and writes labels of the block's nodes only.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_roof_settle(brio_roof *r, const brio_signed_graph *g, const brio_node_blocks *blocks, size_t block,
                             uint8_t *label);

#endif
