/* A part is cut twice: with all that is outside taken for the source's side, and with all of it taken for the sink's
 * side. The least sink's side grows with what is outside: so a node of the sink's side in the first cut is there
 * whatever is outside, and a node of the source's side in the second cut, too. The second flow begins from the first;
 * only the terminals at the border have changed. docs/decisions/042-cuts-in-closed-parts.md has the proof.
 *
 * Based on: Kovtun. Partial optimal labeling search for a NP-hard subclass of (max,+) problems. DAGM 2003.
 *           Kohli, Torr. Dynamic graph cuts for efficient inference in Markov random fields. IEEE PAMI 2007. */
#include "base/memory.h"
#include "reconstruct/labels/cut_in_parts.h"
#include "reconstruct/labels/max_flow.h"

typedef struct {
    size_t num_nodes;
    const uint32_t *mate;
    int32_t *residual, *terminal;
    brio_flow_node *node;
    uint8_t *side;
    brio_flow_trees trees;
} part_flow;

#define FLOW                 part_flow
#define FLOW_TERMINAL        int32_t
#define FLOW_NODES(f)        ((f)->num_nodes)
#define FLOW_FIRST(f, v)     (4 * (v))
#define FLOW_END(f, v)       (4 * (v) + 4)
#define FLOW_HEAD(f, a)      ((f)->mate[a] / 4)
#define FLOW_MATE(f, a)      ((f)->mate[a])
#define FLOW_RESIDUAL(f, a)  ((f)->residual[a])
#define FLOW_IS_CLOSED(f, a) ((f)->mate[a] == BRIO_NO_MATE)
#include "reconstruct/labels/flow_body.h"

brio_status brio_part_cut_new(brio_context *ctx, size_t num_nodes, bool in_memory, brio_part_cut *out) {
    brio_status status = BRIO_OK;
    *out = (brio_part_cut){.num_nodes = num_nodes};
    if (in_memory) {
        BRIO_TRY(BRIO_ALLOC_IN_MEMORY(ctx, out->mate, 4 * num_nodes));
        BRIO_TRY(BRIO_ALLOC_IN_MEMORY(ctx, out->capacity, 4 * num_nodes));
        BRIO_TRY(BRIO_ALLOC_IN_MEMORY(ctx, out->terminal, num_nodes));
        BRIO_TRY(BRIO_ALLOC_IN_MEMORY(ctx, out->outside, num_nodes));
    } else {
        BRIO_TRY(BRIO_ALLOC(ctx, out->mate, 4 * num_nodes));
        BRIO_TRY(BRIO_ALLOC(ctx, out->capacity, 4 * num_nodes));
        BRIO_TRY(BRIO_ALLOC(ctx, out->terminal, num_nodes));
        BRIO_TRY(BRIO_ALLOC(ctx, out->outside, num_nodes));
    }
done:
    return status;
}

void brio_part_cut_free(brio_context *ctx, brio_part_cut *c) {
    brio_release(ctx, c->mate);
    brio_release(ctx, c->capacity);
    brio_release(ctx, c->terminal);
    brio_release(ctx, c->outside);
    *c = (brio_part_cut){0};
}

/* Makes the flow maximal, with all that is outside taken for the source's side. */
static void cut_from_source(part_flow *f, const int32_t *outside) {
    for (size_t v = 0; v < f->num_nodes; v++) f->terminal[v] += outside[v];
    clear(f);
    plant(f);
    push(f);
}

/* Goes on with all that is outside taken for the sink's side. */
static void cut_from_sink(part_flow *f, const int32_t *outside) {
    f->trees.time++;
    for (uint32_t v = 0; v < f->num_nodes; v++) {
        if (!outside[v]) continue;
        f->terminal[v] -= 2 * outside[v];
        fit_terminal(f, v);
    }
    adopt_all(f);
    push(f);
}

brio_status brio_part_cut_decide(brio_context *ctx, brio_part_cut *c, bool in_memory, uint8_t *label) {
    brio_status status = BRIO_OK;
    part_flow f = {.num_nodes = c->num_nodes,
                   .mate = c->mate,
                   .residual = c->capacity,
                   .terminal = c->terminal,
                   .trees = {.room = c->num_nodes, .active_head = NO_NODE}};
    BRIO_TRY(in_memory ? BRIO_ALLOC_IN_MEMORY(ctx, f.node, f.num_nodes) : BRIO_ALLOC(ctx, f.node, f.num_nodes));
    BRIO_TRY(in_memory ? BRIO_ALLOC_IN_MEMORY(ctx, f.side, f.num_nodes) : BRIO_ALLOC(ctx, f.side, f.num_nodes));
    cut_from_source(&f, c->outside);
    for (size_t v = 0; v < f.num_nodes; v++) label[v] = f.side[v] == SINK ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    cut_from_sink(&f, c->outside);
    for (size_t v = 0; v < f.num_nodes; v++)
        if (f.side[v] == SINK && label[v] == BRIO_LABEL_OUTER) label[v] = BRIO_LABEL_NONE;
done:
    brio_release(ctx, f.node);
    brio_release(ctx, f.side);
    return status;
}
