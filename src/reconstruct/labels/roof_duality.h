/* Labels of least energy for a block of poles, as far as roof duality tells. */
#ifndef BRIO_RECONSTRUCT_ROOF_DUALITY_H
#define BRIO_RECONSTRUCT_ROOF_DUALITY_H

#include "reconstruct/labels/max_flow.h"
#include "reconstruct/labels/pole_blocks.h"

/** Workspace for many blocks, one after another; {.flow = brio_flow_new(ctx)} is an empty one. */
typedef struct {
    brio_flow flow;
    brio_flow_edge *edge;
    int64_t *terminal;
    uint8_t *side;
    size_t num_edges, edge_capacity, terminal_capacity, side_capacity;
    size_t undecided, toggled; /* poles so far: not decided, given another label */
} brio_roof;

void brio_roof_free(brio_roof *r);

/** Toggles labels in a block, those beyond it being what they are. The energy does not rise. Reads and writes no labels
 *  but those of the block and of the poles that edges join it with. */
brio_status brio_roof_settle(brio_roof *r, const brio_pole_graph *g, const brio_pole_blocks *blocks, size_t block,
                             uint8_t *label);

#endif
