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
 * Many nodes need no flow (of bunny_raw, 600,000 of 1.6 million): what is known pulls at them with more weight than all
 * edges to nodes that are not settled have. Such a node is on one side of every minimum cut, and its edges pull at its
 * neighbours, which may settle these, too. The flow decides what is left.
 *
 * Based on: Hammer, Hansen, Simeone. Roof duality, complementation and persistency in quadratic 0-1 optimization.
 *           Mathematical Programming 1984.
 *           Boros, Hammer. Pseudo-Boolean optimization. Discrete Applied Mathematics 2002 (the doubled graph; variables
 *           fixed by the sign of a derivative). */
#include "reconstruct/labels/roof_duality.h"
#include "base/memory.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Capacities are integers: weights, which are at most 1, times WEIGHT_SCALE. Chosen; below 2^30, the limit of a
 * flow. */
enum { WEIGHT_SCALE = 1 << 20 };

/* Marks in brio_roof_node.number: a settled node keeps its label or is flipped; a node is not settled. */
enum { ROOF_KEEPS = UINT32_MAX, ROOF_FLIPS = UINT32_MAX - 1, ROOF_OPEN = UINT32_MAX - 2 };

void brio_roof_free(brio_roof *r) {
    brio_context *ctx = r->flow.ctx;
    brio_release(ctx, r->node);
    brio_release(ctx, r->near);
    brio_release(ctx, r->settled);
    brio_release(ctx, r->edge);
    brio_release(ctx, r->terminal);
    brio_release(ctx, r->side);
    brio_flow_free(&r->flow);
}

/* --- the edges of a block --- */

static int32_t whole_weight(brio_signed_edge e) {
    return (int32_t)(fabsf(e.weight) * WEIGHT_SCALE + 0.5f);
}

/* Lists the edges of the i-th node of a block that begins at place `begin`. */
static brio_status list_near(brio_roof *r, const brio_signed_graph *g, const brio_node_blocks *b, size_t begin,
                             uint32_t i, const uint8_t *label) {
    brio_status status = BRIO_OK;
    uint32_t p = b->node[begin + i];
    brio_roof_node *node = &r->node[i];
    *node = (brio_roof_node){.number = ROOF_OPEN};
    BRIO_TRY(BRIO_RESERVE(g->ctx, r->near, r->near_capacity, r->num_near + g->first[p + 1] - g->first[p]));
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++) {
        int32_t weight = whole_weight(g->edge[e]);
        uint32_t j = b->place[g->edge[e].node] - (uint32_t)begin;
        bool within = j < r->size;
        if (within) node->loose += weight;
        if (brio_label_violates(label, p, g->edge[e])) weight = -weight;
        if (within)
            r->near[r->num_near++] = (brio_roof_edge){j, weight};
        else
            node->pull += weight;
    }
    node->end = (uint32_t)r->num_near;
done:
    return status;
}

static brio_status list_block(brio_roof *r, const brio_signed_graph *g, const brio_node_blocks *b, size_t block,
                              const uint8_t *label) {
    brio_status status = BRIO_OK;
    size_t begin = b->begin[block];
    r->size = (uint32_t)(b->end[block] - begin);
    r->num_near = 0;
    BRIO_TRY(BRIO_RESERVE(g->ctx, r->node, r->node_capacity, r->size));
    BRIO_TRY(BRIO_RESERVE(g->ctx, r->settled, r->settled_capacity, r->size));
    for (uint32_t i = 0; i < r->size; i++) BRIO_TRY(list_near(r, g, b, begin, i, label));
done:
    return status;
}

static size_t first_near(const brio_roof *r, uint32_t i) {
    return i > 0 ? r->node[i - 1].end : 0;
}

/* --- nodes without a flow --- */

/* Settles an open node if that is possible yet. */
static void try_to_settle(brio_roof *r, uint32_t i) {
    brio_roof_node *node = &r->node[i];
    if (llabs(node->pull) <= node->loose) return;
    node->number = node->pull > 0 ? ROOF_KEEPS : ROOF_FLIPS;
    r->settled[r->num_settled++] = i;
}

static void settle_nodes(brio_roof *r) {
    r->num_settled = 0;
    for (uint32_t i = 0; i < r->size; i++) try_to_settle(r, i);
    for (size_t n = 0; n < r->num_settled; n++) {
        uint32_t i = r->settled[n];
        int sign = r->node[i].number == ROOF_KEEPS ? 1 : -1;
        for (size_t e = first_near(r, i); e < r->node[i].end; e++) {
            brio_roof_node *other = &r->node[r->near[e].node];
            if (other->number != ROOF_OPEN) continue;
            other->pull += sign * r->near[e].weight;
            other->loose -= abs(r->near[e].weight);
            try_to_settle(r, r->near[e].node);
        }
    }
}

/* --- the others --- */

/* Numbers the open nodes. */
static void number_open(brio_roof *r) {
    r->num_open = 0;
    for (uint32_t i = 0; i < r->size; i++)
        if (r->node[i].number == ROOF_OPEN) r->node[i].number = r->num_open++;
}

/* Lists the edges of the doubled graph between open nodes: node n is the n-th open node, node num_open + n its
 * complement. What pulls becomes terminals. An edge is listed at the end of lower number. */
static brio_status double_edges(brio_roof *r) {
    brio_status status = BRIO_OK;
    r->num_edges = 0;
    BRIO_TRY(BRIO_RESERVE(r->flow.ctx, r->terminal, r->terminal_capacity, 2 * (size_t)r->num_open));
    BRIO_TRY(BRIO_RESERVE(r->flow.ctx, r->side, r->side_capacity, 2 * (size_t)r->num_open));
    BRIO_TRY(BRIO_RESERVE(r->flow.ctx, r->edge, r->edge_capacity, r->num_near));
    for (uint32_t i = 0; i < r->size; i++) {
        uint32_t from = r->node[i].number;
        if (from >= ROOF_OPEN) continue;
        r->terminal[from] = r->node[i].pull;
        r->terminal[r->num_open + from] = -r->node[i].pull;
        for (size_t e = first_near(r, i); e < r->node[i].end; e++) {
            uint32_t to = r->node[r->near[e].node].number;
            int32_t weight = r->near[e].weight, size = abs(weight);
            if (to >= ROOF_OPEN || to <= from || size == 0) continue;
            uint32_t shift = weight > 0 ? 0 : r->num_open;
            r->edge[r->num_edges++] = (brio_flow_edge){from, to + shift, size};
            r->edge[r->num_edges++] = (brio_flow_edge){r->num_open + from, r->num_open + to - shift, size};
        }
    }
done:
    return status;
}

static void flip(brio_roof *r, uint8_t *label) {
    *label = brio_other_label(*label);
    r->toggled++;
}

brio_status brio_roof_settle(brio_roof *r, const brio_signed_graph *g, const brio_node_blocks *b, size_t block,
                             uint8_t *label) {
    brio_status status = BRIO_OK;
    const uint32_t *node = b->node + b->begin[block];
    BRIO_TRY(list_block(r, g, b, block, label));
    settle_nodes(r);
    number_open(r);
    BRIO_TRY(double_edges(r));
    BRIO_TRY(brio_flow_maximum(&r->flow, 2 * (size_t)r->num_open, r->edge, r->num_edges, r->terminal, r->side));
    for (uint32_t i = 0; i < r->size; i++) {
        uint32_t n = r->node[i].number;
        bool open = n < ROOF_OPEN, stays = open ? r->side[n] == BRIO_FLOW_SOURCE : n == ROOF_KEEPS;
        bool toggles = open ? r->side[r->num_open + n] == BRIO_FLOW_SOURCE : n == ROOF_FLIPS;
        r->undecided += !stays && !toggles;
        if (toggles) flip(r, &label[node[i]]);
    }
done:
    return status;
}
