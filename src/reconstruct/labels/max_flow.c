/* Maximum flow of a graph given by a list of its edges: see flow_body.h. */
#include "base/memory.h"
#include <string.h>

#define FLOW                 brio_flow
#define FLOW_TERMINAL        int64_t
#define FLOW_NODES(f)        ((f)->num_nodes)
#define FLOW_FIRST(f, v)     ((f)->first[v])
#define FLOW_END(f, v)       ((f)->first[(v) + 1])
#define FLOW_HEAD(f, a)      ((f)->arc[a].head)
#define FLOW_MATE(f, a)      ((f)->arc[a].mate)
#define FLOW_RESIDUAL(f, a)  ((f)->arc[a].residual)
#define FLOW_IS_CLOSED(f, a) false
#include "reconstruct/labels/flow_body.h"

static brio_status make_arcs(brio_flow *f, const brio_flow_edge *edges, size_t num_edges) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->first, f->first_capacity, f->num_nodes + 1));
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->node, f->node_capacity, f->num_nodes));
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->arc, f->arc_capacity, 2 * num_edges));
    memset(f->first, 0, (f->num_nodes + 1) * sizeof *f->first);
    for (size_t e = 0; e < num_edges; e++) f->first[edges[e].a]++, f->first[edges[e].b]++;
    for (size_t v = 0, start = 0; v <= f->num_nodes; v++) {
        start += f->first[v];
        f->first[v] = (uint32_t)start; /* the end of the arcs of v; the next loop fills them backwards */
    }
    for (size_t e = 0; e < num_edges; e++) {
        brio_flow_edge x = edges[e];
        uint32_t there = --f->first[x.a], back = --f->first[x.b];
        f->arc[there] = (brio_flow_arc){x.b, back, x.capacity};
        f->arc[back] = (brio_flow_arc){x.a, there, x.capacity};
    }
done:
    return status;
}

brio_flow brio_flow_new(brio_context *ctx) {
    return (brio_flow){.ctx = ctx};
}

void brio_flow_free(brio_flow *f) {
    brio_release(f->ctx, f->first);
    brio_release(f->ctx, f->node);
    brio_release(f->ctx, f->arc);
}

brio_status brio_flow_maximum(brio_flow *f, size_t num_nodes, const brio_flow_edge *edges, size_t num_edges,
                              int64_t *terminal, uint8_t *side) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(f->ctx, num_nodes < ORPHAN && num_edges < ORPHAN / 2, BRIO_ERR_TOO_LARGE,
                 "%zu edges of a flow are more than 32-bit indices can name", num_edges);
    f->num_nodes = num_nodes;
    f->trees = (brio_flow_trees){.room = num_nodes, .active_head = NO_NODE};
    f->terminal = terminal, f->side = side;
    BRIO_TRY(make_arcs(f, edges, num_edges));
    clear(f);
    plant(f);
    push(f);
done:
    return status;
}
