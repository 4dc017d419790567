/* The best labels of tetrahedra: a minimum cut. With the labels of the samples known, all other edges want one label, so a
 * minimum cut has the least energy.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009. */
#include "reconstruct/labeled_delaunay/vote_cut.h"
#include "base/memory.h"
#include "base/team.h"

enum { TETS_A_THREAD = 1 << 12, CAPACITY = 1 << 20, NO_NODE = UINT32_MAX };

void brio_vote_cut_free(brio_vote_cut *c) {
    brio_context *ctx = c->g->ctx;
    brio_flow_free(&c->flow);
    brio_release(ctx, c->edge);
    brio_release(ctx, c->terminal);
    brio_release(ctx, c->wanted);
    brio_release(ctx, c->node);
    brio_release(ctx, c->tet);
    brio_release(ctx, c->side);
    *c = (brio_vote_cut){.g = c->g};
}

/* Makes nodes of the open tetrahedra. */
static brio_status make_nodes(brio_vote_cut *c) {
    brio_status status = BRIO_OK;
    brio_context *ctx = c->g->ctx;
    size_t finite = c->g->dual->num_finite, count = 0;
    for (size_t tet = 0; tet < finite; tet++) count += !c->open || c->open[tet];
    BRIO_TRY(BRIO_ALLOC(ctx, c->node, finite));
    BRIO_TRY(BRIO_ALLOC(ctx, c->tet, count));
    BRIO_TRY(BRIO_ALLOC(ctx, c->terminal, count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, c->wanted, count));
    BRIO_TRY(BRIO_ALLOC(ctx, c->side, count));
    BRIO_TRY(BRIO_ALLOC(ctx, c->edge, 2 * count));
    for (uint32_t tet = 0; tet < finite; tet++) {
        bool in = !c->open || c->open[tet];
        c->node[tet] = in ? (uint32_t)c->num_nodes : NO_NODE;
        if (in) c->tet[c->num_nodes++] = tet;
    }
done:
    return status;
}

typedef struct {
    brio_vote_cut *c;
    const uint8_t *label;
    int64_t bias;
} terminals;

/* Sums the weights of each node's edges to what has a label, for outer less for inner. */
static void sum_votes(void *user, size_t begin, size_t end, int thread) {
    const terminals *t = user;
    const brio_vote_graph *g = t->c->g;
    (void)thread;
    for (size_t v = begin; v < end; v++) {
        uint32_t tet = t->c->tet[v];
        int64_t outer = t->bias;
        for (size_t e = g->first[tet]; e < g->first[tet + 1]; e++) {
            uint32_t other = g->edge[e].node;
            int64_t weight = (int64_t)(g->edge[e].weight * CAPACITY);
            if (other < g->dual->num_finite && t->c->node[other] != NO_NODE) continue;
            outer += t->label[other] == BRIO_LABEL_OUTER ? weight : -weight;
        }
        t->c->terminal[v] += outer - t->c->wanted[v];
        t->c->wanted[v] = outer;
    }
}

/* Lists the facets between nodes, each once. */
static void list_facets(brio_vote_cut *c) {
    const brio_vote_graph *g = c->g;
    for (uint32_t v = 0; v < c->num_nodes; v++) {
        uint32_t tet = c->tet[v];
        for (size_t e = g->first[tet]; e < g->first[tet + 1]; e++) {
            uint32_t other = g->edge[e].node;
            if (other > tet && other < g->dual->num_finite && c->node[other] != NO_NODE)
                c->edge[c->num_edges++] = (brio_flow_edge){v, c->node[other], (int32_t)(g->edge[e].weight * CAPACITY)};
        }
    }
}

brio_status brio_vote_cut_new(const brio_vote_graph *g, const uint8_t *open, brio_vote_cut *out) {
    brio_status status = BRIO_OK;
    *out = (brio_vote_cut){.g = g, .open = open, .flow = brio_flow_new(g->ctx)};
    BRIO_TRY(make_nodes(out));
    list_facets(out);
    for (size_t v = 0; v < out->num_nodes; v++) out->terminal[v] = 0;
done:
    return status;
}

brio_status brio_vote_cut_find(brio_vote_cut *c, double bias, const uint8_t *label, uint8_t *out) {
    brio_status status = BRIO_OK;
    terminals t = {c, label, (int64_t)(bias * BRIO_VOTE_UNIT * CAPACITY)};
    brio_for(c->g->ctx, brio_threads(c->g->ctx, c->num_nodes, TETS_A_THREAD), c->num_nodes, sum_votes, &t);
    if (c->begun)
        brio_flow_again(&c->flow, c->terminal, c->side);
    else
        BRIO_TRY(brio_flow_maximum(&c->flow, c->num_nodes, c->edge, c->num_edges, c->terminal, c->side));
    c->begun = true;
    for (size_t tet = 0; tet < c->g->dual->num_finite; tet++) out[tet] = label[tet];
    for (size_t v = 0; v < c->num_nodes; v++)
        out[c->tet[v]] = c->side[v] == BRIO_FLOW_SINK ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
done:
    return status;
}
