/* Roof duality for a block of nodes.
 *
 * Edges that want different labels make the energy not submodular, so no single cut minimises it. Roof duality uses a
 * doubled graph, of the nodes and of a complement of each. The unknown of a node is whether to flip its label.
 * An edge that the labels satisfy wants both ends flipped or none: it joins node with node, and complement with
 * complement. A violated edge wants one end flipped: it joins each node with the complement of the other end.
 *
 * In a minimum cut, a node on the side of the source stays, and a node whose complement is on the side of the source
 * flips; some labeling of least energy agrees with both. Doing this, and leaving the undecided nodes as they are, does
 * not raise the energy (autarky).
 *
 * Based on: Hammer, Hansen, Simeone. Roof duality, complementation and persistency in quadratic 0-1 optimization.
 *           Mathematical Programming 1984.
 *           Boros, Hammer. Pseudo-Boolean optimization. Discrete Applied Mathematics 2002 (the doubled graph). */
#include "reconstruct/labels/roof_duality.h"
#include "base/memory.h"
#include <math.h>
#include <string.h>

/* Capacities are integers: weights, which are at most 1, times WEIGHT_SCALE. Chosen; below 2^30, the limit of a
 * flow. */
enum { WEIGHT_SCALE = 1 << 20 };

void brio_roof_free(brio_roof *r) {
    brio_context *ctx = r->flow.ctx;
    brio_release(ctx, r->edge);
    brio_release(ctx, r->terminal);
    brio_release(ctx, r->side);
    brio_flow_free(&r->flow);
}

static int32_t whole_weight(brio_signed_edge e) {
    return (int32_t)(fabsf(e.weight) * WEIGHT_SCALE + 0.5f);
}

/* Lists the edges of the doubled graph. Node i is the i-th node of the block, node size + i its complement. The labels
 * outside the block become terminals. An edge within the block is listed at the end that comes first in the block. */
static brio_status double_edges(brio_roof *r, const brio_signed_graph *g, const brio_node_blocks *b, size_t begin,
                                uint32_t size, const uint8_t *label) {
    brio_status status = BRIO_OK;
    r->num_edges = 0;
    for (uint32_t i = 0; i < size; i++) {
        uint32_t p = b->node[begin + i];
        BRIO_TRY(BRIO_RESERVE(g->ctx, r->edge, r->edge_capacity, r->num_edges + 2 * (g->first[p + 1] - g->first[p])));
        for (size_t e = g->first[p]; e < g->first[p + 1]; e++) {
            int32_t weight = whole_weight(g->edge[e]);
            bool same = !brio_label_violates(label, p, g->edge[e]);
            uint32_t j = b->place[g->edge[e].node] - (uint32_t)begin, shift = same ? 0 : size;
            if (!weight) continue;
            if (j >= size) {
                r->terminal[i] += same ? weight : -weight;
                r->terminal[size + i] -= same ? weight : -weight;
            } else if (j > i) {
                r->edge[r->num_edges++] = (brio_flow_edge){i, j + shift, weight};
                r->edge[r->num_edges++] = (brio_flow_edge){size + i, size + j - shift, weight};
            }
        }
    }
done:
    return status;
}

brio_status brio_roof_settle(brio_roof *r, const brio_signed_graph *g, const brio_node_blocks *b, size_t block,
                             uint8_t *label) {
    brio_status status = BRIO_OK;
    size_t begin = brio_node_block_begin(b, block);
    uint32_t size = (uint32_t)(brio_node_block_begin(b, block + 1) - begin);
    BRIO_TRY(BRIO_RESERVE(g->ctx, r->terminal, r->terminal_capacity, 2 * size));
    BRIO_TRY(BRIO_RESERVE(g->ctx, r->side, r->side_capacity, 2 * size));
    memset(r->terminal, 0, 2 * size * sizeof *r->terminal);
    BRIO_TRY(double_edges(r, g, b, begin, size, label));
    BRIO_TRY(brio_flow_maximum(&r->flow, 2 * size, r->edge, r->num_edges, r->terminal, r->side));
    for (uint32_t i = 0; i < size; i++) {
        bool stays = r->side[i] == BRIO_FLOW_SOURCE, toggles = r->side[size + i] == BRIO_FLOW_SOURCE;
        uint32_t p = b->node[begin + i];
        r->undecided += !stays && !toggles;
        r->toggled += toggles;
        if (toggles) label[p] = brio_other_label(label[p]);
    }
done:
    return status;
}
