/* The best labels of tetrahedra: a minimum cut. With the labels of the samples known, all other edges want one label,
 * so a minimum cut has the least energy.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009. */
#include "reconstruct/labeled_delaunay/vote_cut.h"
#include "base/memory.h"
#include "base/team.h"
#include <string.h>

enum { TETS_A_THREAD = 1 << 12, CAPACITY = 1 << 20 };

void brio_vote_cut_free(brio_vote_cut *c) {
    if (!c->g) return;
    brio_tet_flow_free(&c->flow);
    brio_release(c->g->ctx, c->list);
    brio_release(c->g->ctx, c->wanted);
    *c = (brio_vote_cut){.g = c->g};
}

/* Returns whether a tetrahedron takes part. */
static bool is_in(const brio_vote_cut *c, uint32_t tet) {
    return tet < c->g->num_free && (!c->open || c->open[tet]);
}

static uint32_t tet_at(const brio_vote_cut *c, size_t i) {
    return c->list ? c->list[i] : (uint32_t)i;
}

static brio_status list_open(brio_vote_cut *c, size_t *count) {
    brio_status status = BRIO_OK;
    size_t all = c->g->num_free;
    *count = all;
    if (!c->open) return BRIO_OK;
    *count = 0;
    for (size_t tet = 0; tet < all; tet++) *count += c->open[tet] != 0;
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, c->list, *count));
    for (size_t tet = 0, i = 0; tet < all; tet++)
        if (c->open[tet]) c->list[i++] = (uint32_t)tet;
done:
    return status;
}

static int32_t whole(float weight) {
    return (int32_t)(weight * CAPACITY);
}

static void set_capacities(void *user, size_t begin, size_t end, int thread) {
    const brio_vote_cut *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        uint32_t tet = tet_at(c, i);
        c->flow.terminal[tet] = c->wanted[tet] = 0;
        for (int k = 0; k < 4; k++) {
            uint32_t mate = c->g->dual->t.tet[tet].mate[k];
            bool in = is_in(c, brio_tet_of(mate));
            c->flow.residual[tet][k] = in ? whole(c->g->facet[tet][k]) : 0;
            if (!in) c->flow.residual[brio_tet_of(mate)][brio_slot_of(mate)] = 0;
        }
    }
}

brio_status brio_vote_cut_new(const brio_vote_graph *g, const uint8_t *open, brio_vote_cut *out) {
    brio_status status = BRIO_OK;
    size_t count;
    *out = (brio_vote_cut){.g = g, .open = open, .flow.ctx = g->ctx};
    BRIO_TRY(list_open(out, &count));
    BRIO_TRY(BRIO_ALLOC(g->ctx, out->wanted, g->dual->t.count));
    BRIO_TRY(brio_tet_flow_new(g->ctx, &g->dual->t, out->list, count, &out->flow));
    BRIO_TRY(brio_for(g->ctx, brio_threads(g->ctx, count, TETS_A_THREAD), count, set_capacities, out));
done:
    return status;
}

typedef struct {
    brio_vote_cut *c;
    const uint8_t *label;
    int32_t bias;
} terminals;

/* Sums the weights of each tetrahedron's edges to what has a label, for outer less for inner. */
static void sum_votes(void *user, size_t begin, size_t end, int thread) {
    const terminals *t = user;
    const brio_vote_graph *g = t->c->g;
    const uint8_t *sample = t->label + g->dual->t.count;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        uint32_t v = tet_at(t->c, i);
        const brio_tetrahedron *tet = &g->dual->t.tet[v];
        int32_t outer = t->bias + whole(brio_hull_vote(g, v));
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(tet->mate[k]);
            int32_t vote = whole(g->vote[v][k]);
            if (tet->vertex[k] != g->dual->t.infinite)
                outer += sample[tet->vertex[k]] == BRIO_LABEL_OUTER ? vote : -vote;
            if (is_in(t->c, other)) continue;
            outer += t->label[other] == BRIO_LABEL_OUTER ? whole(g->facet[v][k]) : -whole(g->facet[v][k]);
        }
        t->c->flow.terminal[v] += outer - t->c->wanted[v];
        t->c->wanted[v] = outer;
    }
}

typedef struct {
    const brio_vote_cut *c;
    const uint8_t *label;
    uint8_t *out;
} results;

static void copy_labels(void *user, size_t begin, size_t end, int thread) {
    const results *r = user;
    (void)thread;
    memcpy(r->out + begin, r->label + begin, end - begin);
}

static void write_labels(void *user, size_t begin, size_t end, int thread) {
    const results *r = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        uint32_t tet = tet_at(r->c, i);
        r->out[tet] = r->c->flow.side[tet] == BRIO_FLOW_SINK ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    }
}

brio_status brio_vote_cut_find(brio_vote_cut *c, double bias, const uint8_t *label, uint8_t *out) {
    brio_status status = BRIO_OK;
    brio_context *ctx = c->g->ctx;
    terminals t = {c, label, (int32_t)(bias * BRIO_VOTE_UNIT * CAPACITY)};
    results r = {c, label, out};
    size_t open = c->flow.num_open, all = c->g->num_free;
    int threads = brio_threads(ctx, open, TETS_A_THREAD);
    BRIO_TRY(brio_for(ctx, threads, open, sum_votes, &t));
    BRIO_TRY(brio_tet_flow_run(&c->flow));
    if (out != label) BRIO_TRY(brio_for(ctx, brio_threads(ctx, all, TETS_A_THREAD), all, copy_labels, &r));
    BRIO_TRY(brio_for(ctx, threads, open, write_labels, &r));
done:
    return status;
}
