/* The best labels of tetrahedra: a minimum cut. With the labels of the samples known, all other edges want one label,
 * so a minimum cut has the least energy. What wants a tetrahedron outer or inner is summed when its part is collected
 * (cut_in_parts.h). The next cut begins from the flow of the last one, unless arrays are in scratch files: to find the
 * flow again takes less time than to read and write it.
 *
 * Where few tetrahedra are open they lie on nearly all pages of the graph's arrays, and six cuts would read all of it
 * six times. So what the cuts need of them is copied once, in their order.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009. */
#include "reconstruct/labeled_delaunay/vote_cut.h"
#include "base/memory.h"
#include "base/team.h"
#include "reconstruct/labels/cut_in_parts.h"
#include <string.h>

enum { TETS_A_THREAD = 1 << 12, CAPACITY = 1 << 20 };

void brio_vote_cut_free(brio_vote_cut *c) {
    if (!c->g) return;
    brio_release(c->g->ctx, c->list);
    brio_release(c->g->ctx, c->copied);
    brio_release(c->g->ctx, c->copied_vote);
    brio_release(c->g->ctx, c->copied_facet);
    brio_release(c->g->ctx, c->beyond);
    brio_release(c->g->ctx, c->residual);
    *c = (brio_vote_cut){.g = c->g};
}

static int32_t whole(float weight) {
    return (int32_t)(weight * CAPACITY);
}

/* --- which tetrahedra take part --- */

static brio_status list_open(brio_vote_cut *c, const uint8_t *open) {
    brio_status status = BRIO_OK;
    size_t all = c->g->num_free;
    for (size_t tet = 0; tet < all; tet++) c->num_nodes += open[tet] != 0;
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, c->list, c->num_nodes));
    for (size_t tet = 0, i = 0; tet < all; tet++)
        if (open[tet]) c->list[i++] = (uint32_t)tet;
done:
    return status;
}

/* Copies one open tetrahedron.   number  #T: the node of each that is open, UINT32_MAX for others. */
static brio_status copy_tet(brio_vote_cut *c, size_t *room, uint32_t node, const uint32_t *number) {
    brio_status status = BRIO_OK;
    uint32_t tet = c->list[node];
    brio_tetrahedron *copy = &c->copied[node];
    *copy = c->g->dual->t.tet[tet];
    memcpy(c->copied_vote[node], c->g->vote[tet], sizeof c->copied_vote[node]);
    memcpy(c->copied_facet[node], c->g->facet[tet], sizeof c->copied_facet[node]);
    for (int k = 0; k < 4; k++) {
        uint32_t other = brio_tet_of(copy->mate[k]);
        if (number[other] != UINT32_MAX) {
            copy->mate[k] = brio_facet_of(number[other], brio_slot_of(copy->mate[k]));
            continue;
        }
        BRIO_TRY(BRIO_RESERVE(c->g->ctx, c->beyond, *room, c->num_beyond + 1));
        copy->mate[k] = (uint32_t)(4 * c->num_nodes + c->num_beyond);
        c->beyond[c->num_beyond++] = other;
    }
done:
    return status;
}

/* Announces what is copied soon, at the first one of a stretch. */
static void expect_listed(const brio_vote_cut *c, size_t i) {
    size_t n = c->num_nodes, from = i + BRIO_SWEEP_STRETCH;
    size_t to = from + BRIO_SWEEP_STRETCH < n ? from + BRIO_SWEEP_STRETCH : n;
    if (i % BRIO_SWEEP_STRETCH == 0 && from < to)
        brio_expect_rows(c->g->ctx,
                         BRIO_ARRAYS(BRIO_READS(c->g->dual->t.tet), BRIO_READS(c->g->vote), BRIO_READS(c->g->facet)),
                         c->list[from], (size_t)c->list[to - 1] + 1);
}

/* Copies the open tetrahedra. */
static brio_status copy_open(brio_vote_cut *c) {
    brio_status status = BRIO_OK;
    uint32_t *number = NULL;
    size_t room = 0, all = c->g->dual->t.count;
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, number, all));
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, c->copied, c->num_nodes));
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, c->copied_vote, c->num_nodes));
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, c->copied_facet, c->num_nodes));
    memset(number, 0xFF, all * sizeof *number);
    for (size_t i = 0; i < c->num_nodes; i++) number[c->list[i]] = (uint32_t)i;
    for (size_t i = 0; i < c->num_nodes; i++) {
        expect_listed(c, i);
        BRIO_TRY(copy_tet(c, &room, (uint32_t)i, number));
    }
    c->tet = c->copied;
    c->vote = (const float(*)[4])c->copied_vote;
    c->facet = (const float(*)[4])c->copied_facet;
done:
    brio_release(c->g->ctx, number);
    return status;
}

brio_status brio_vote_cut_new(const brio_vote_graph *g, const uint8_t *open, brio_vote_cut *out) {
    *out = (brio_vote_cut){.g = g,
                           .num_nodes = open ? 0 : g->num_free,
                           .tet = g->dual->t.tet,
                           .vote = (const float(*)[4])g->vote,
                           .facet = (const float(*)[4])g->facet};
    if (open) {
        BRIO_FORWARD(list_open(out, open));
        BRIO_FORWARD(copy_open(out));
    }
    return g->ctx->scratch ? BRIO_OK : BRIO_ALLOC(g->ctx, out->residual, 4 * out->num_nodes);
}

/* --- the cut --- */

typedef struct {
    const brio_vote_cut *c;
    const uint8_t *label, *sample; /* of tetrahedra and samples */
    int32_t bias;
    uint8_t *side; /* #nodes */
    uint8_t *out;
} cutting;

static int32_t for_label(uint8_t label, int32_t weight) {
    return label == BRIO_LABEL_OUTER ? weight : -weight;
}

/* Returns the tetrahedron behind a facet that is to no node. */
static uint32_t tet_beyond(const brio_vote_cut *c, uint32_t mate) {
    return c->list ? c->beyond[mate - 4 * c->num_nodes] : brio_tet_of(mate);
}

/* Reads nodes. A terminal is the weight of what wants its node outer less of what wants it inner: the bias, samples,
 * and tetrahedra that are not open. */
static void read_nodes(const void *user, size_t begin, size_t end, uint32_t *mate, int32_t *capacity,
                       int32_t *terminal) {
    const cutting *cut = user;
    const brio_vote_cut *c = cut->c;
    uint32_t infinite = c->g->dual->t.infinite;
    size_t num_facets = 4 * c->num_nodes;
    for (size_t v = begin; v < end; v++, mate += 4, capacity += 4, terminal++) {
        int32_t outer = cut->bias + whole(brio_hull_vote(c->g, c->list ? c->list[v] : v));
        const uint32_t *vertex = c->tet[v].vertex;
        for (int k = 0; k < 4; k++) {
            mate[k] = c->tet[v].mate[k];
            capacity[k] = whole(c->facet[v][k]);
            if (vertex[k] != infinite) outer += for_label(cut->sample[vertex[k]], whole(c->vote[v][k]));
            if (mate[k] < num_facets) continue;
            outer += for_label(cut->label[tet_beyond(c, mate[k])], capacity[k]);
            mate[k] = BRIO_NO_MATE;
            capacity[k] = 0;
        }
        *terminal = outer;
    }
}

static void write_labels(void *user, size_t begin, size_t end, int thread) {
    const cutting *cut = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) cut->out[cut->c->list[i]] = cut->side[i];
}

/* Cuts a graph of which some tetrahedra are open. */
static brio_status cut_open(const brio_cut_graph *graph, cutting *cut) {
    brio_status status = BRIO_OK;
    brio_context *ctx = graph->ctx;
    BRIO_TRY(BRIO_ALLOC(ctx, cut->side, graph->num_nodes));
    BRIO_TRY(brio_cut_in_parts(graph, 0, NULL, cut->side));
    if (cut->out != cut->label) memcpy(cut->out, cut->label, cut->c->g->num_free);
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, graph->num_nodes, TETS_A_THREAD), graph->num_nodes, write_labels, cut));
done:
    brio_release(ctx, cut->side);
    return status;
}

brio_status brio_vote_cut_find(brio_vote_cut *c, double bias, const uint8_t *label, uint8_t *out) {
    cutting cut = {.c = c,
                   .label = label,
                   .sample = label + c->g->dual->t.count,
                   .bias = (int32_t)(bias * BRIO_VOTE_UNIT * CAPACITY),
                   .out = out};
    brio_cut_graph graph = {.ctx = c->g->ctx,
                            .num_nodes = c->num_nodes,
                            .read = read_nodes,
                            .user = &cut,
                            .along = {BRIO_READS(c->tet), BRIO_READS(c->vote), BRIO_READS(c->facet)},
                            .residual = c->residual,
                            .has_flow = c->has_flow};
    c->has_flow = false; /* until all of it is there */
    brio_status status = c->list ? cut_open(&graph, &cut) : brio_cut_in_parts(&graph, 0, NULL, out);
    c->has_flow = status == BRIO_OK && c->residual;
    return status;
}
