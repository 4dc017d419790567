/* The best labels of tetrahedra: a minimum cut. With the labels of the samples known, all other edges want one label,
 * so a minimum cut has the least energy.
 *
 * Where few tetrahedra are open they lie on nearly all pages of the graph's arrays, and six cuts would read all of it
 * six times. So what the cuts need of them is copied once, in their order.
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
    brio_release(c->g->ctx, c->copied.tet);
    brio_release(c->g->ctx, c->own_vote);
    brio_release(c->g->ctx, c->border);
    brio_release(c->g->ctx, c->wanted);
    *c = (brio_vote_cut){.g = c->g};
}

static uint32_t tet_at(const brio_vote_cut *c, size_t i) {
    return c->list ? c->list[i] : (uint32_t)i;
}

static int32_t whole(float weight) {
    return (int32_t)(weight * CAPACITY);
}

/* --- which tetrahedra take part --- */

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

static brio_status add_border(brio_vote_cut *c, size_t *room, uint32_t node, uint32_t facet) {
    brio_status status = BRIO_OK;
    uint32_t beyond = brio_tet_of(*brio_mate(&c->g->dual->t, facet));
    int32_t weight = whole(c->g->facet[brio_tet_of(facet)][brio_slot_of(facet)]);
    if (weight == 0) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(c->g->ctx, c->border, *room, c->num_border + 1));
    c->border[c->num_border++] = (brio_cut_border){node, beyond, weight, 0};
done:
    return status;
}

/* Lists the facets of all that is open to the rest, which is beyond the hull. */
static brio_status list_hull(brio_vote_cut *c) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *t = c->t;
    size_t room = 0;
    for (size_t tet = c->g->num_free; tet < t->count; tet++)
        for (int k = 0; k < 4; k++) {
            uint32_t facet = t->tet[tet].mate[k];
            if (brio_tet_of(facet) < c->g->num_free) BRIO_TRY(add_border(c, &room, brio_tet_of(facet), facet));
        }
done:
    return status;
}

/* Copies one open tetrahedron.   number  #T: the node of each that is open. */
static brio_status copy_tet(brio_vote_cut *c, size_t *room, uint32_t node, const uint32_t *number) {
    brio_status status = BRIO_OK;
    uint32_t tet = c->list[node];
    brio_tetrahedron *copy = &c->copied.tet[node];
    *copy = c->g->dual->t.tet[tet];
    memcpy(c->own_vote[node], c->g->vote[tet], sizeof c->own_vote[node]);
    for (int k = 0; k < 4; k++) {
        uint32_t other = brio_tet_of(copy->mate[k]);
        bool in = other < c->g->num_free && c->open[other];
        if (!in) BRIO_TRY(add_border(c, room, node, brio_facet_of(tet, k)));
        copy->mate[k] = in ? brio_facet_of(number[other], brio_slot_of(copy->mate[k])) : brio_facet_of(node, k);
    }
done:
    return status;
}

/* Announces what is copied soon, at the first one of a stretch. */
static void expect_listed(const brio_vote_cut *c, size_t i, size_t count) {
    size_t from = i + BRIO_SWEEP_STRETCH, to = from + BRIO_SWEEP_STRETCH < count ? from + BRIO_SWEEP_STRETCH : count;
    if (i % BRIO_SWEEP_STRETCH == 0 && from < to)
        brio_expect_rows(c->g->ctx,
                         BRIO_ARRAYS(BRIO_READS(c->g->dual->t.tet), BRIO_READS(c->g->vote), BRIO_READS(c->g->facet)),
                         c->list[from], (size_t)c->list[to - 1] + 1);
}

/* Copies the open tetrahedra, and lists their facets to others. */
static brio_status copy_open(brio_vote_cut *c, size_t count) {
    brio_status status = BRIO_OK;
    uint32_t *number = NULL;
    size_t room = 0;
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, number, c->g->dual->t.count));
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, c->copied.tet, count));
    BRIO_TRY(BRIO_ALLOC(c->g->ctx, c->own_vote, count));
    c->copied.count = count;
    c->t = &c->copied;
    c->vote = (const float(*)[4])c->own_vote;
    for (size_t i = 0; i < count; i++) number[c->list[i]] = (uint32_t)i;
    for (size_t i = 0; i < count; i++) {
        expect_listed(c, i, count);
        BRIO_TRY(copy_tet(c, &room, (uint32_t)i, number));
    }
done:
    brio_release(c->g->ctx, number);
    return status;
}

static void set_capacities(void *user, size_t begin, size_t end, int thread) {
    const brio_vote_cut *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        const float *facet = c->g->facet[tet_at(c, i)];
        c->flow.terminal[i] = c->wanted[i] = 0;
        for (int k = 0; k < 4; k++) {
            uint32_t mate = brio_tet_of(c->t->tet[i].mate[k]);
            c->flow.residual[i][k] = mate != i && mate < c->flow.num_open ? whole(facet[k]) : 0;
        }
    }
}

/* Closes the facets of what is beyond the hull, which the flow reads. */
static void close_hull(brio_vote_cut *c) {
    for (size_t tet = c->flow.num_open; tet < c->t->count; tet++)
        for (int k = 0; k < 4; k++) c->flow.residual[tet][k] = 0;
}

brio_status brio_vote_cut_new(const brio_vote_graph *g, const uint8_t *open, brio_vote_cut *out) {
    brio_status status = BRIO_OK;
    size_t count;
    *out =
        (brio_vote_cut){.g = g, .open = open, .t = &g->dual->t, .vote = (const float(*)[4])g->vote, .flow.ctx = g->ctx};
    BRIO_TRY(list_open(out, &count));
    BRIO_TRY(open ? copy_open(out, count) : list_hull(out));
    BRIO_TRY(BRIO_ALLOC(g->ctx, out->wanted, count));
    BRIO_TRY(brio_tet_flow_new(g->ctx, out->t, NULL, count, &out->flow));
    BRIO_TRY(brio_sweep(g->ctx, brio_threads(g->ctx, count, TETS_A_THREAD), count, set_capacities, out,
                        BRIO_READS(out->t->tet), {open ? NULL : g->facet, sizeof *g->facet, false},
                        BRIO_WRITES(out->flow.residual), BRIO_WRITES(out->flow.terminal), BRIO_WRITES(out->wanted)));
    close_hull(out);
done:
    return status;
}

/* --- what is wanted --- */

typedef struct {
    brio_vote_cut *c;
    const uint8_t *label;
    int32_t bias;
} terminals;

/* Sums the weights of each tetrahedron's edges to samples, for outer less for inner. */
static void sum_votes(void *user, size_t begin, size_t end, int thread) {
    const terminals *t = user;
    const brio_vote_cut *c = t->c;
    const uint8_t *sample = t->label + c->g->dual->t.count;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        const uint32_t *vertex = c->t->tet[i].vertex;
        int32_t outer = t->bias + whole(brio_hull_vote(c->g, tet_at(c, i)));
        for (int k = 0; k < 4; k++) {
            int32_t vote = whole(c->vote[i][k]);
            if (vertex[k] != c->g->dual->t.infinite) outer += sample[vertex[k]] == BRIO_LABEL_OUTER ? vote : -vote;
        }
        c->flow.terminal[i] += outer - c->wanted[i];
        c->wanted[i] = outer;
    }
}

/* Adds what the labels beyond the border want. */
static void add_borders(const terminals *t) {
    for (size_t i = 0; i < t->c->num_border; i++) {
        brio_cut_border *b = &t->c->border[i];
        int32_t wants = t->label[b->beyond] == BRIO_LABEL_OUTER ? b->weight : -b->weight;
        t->c->flow.terminal[b->node] += wants - b->wants;
        b->wants = wants;
    }
}

/* --- results --- */

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
        r->out[tet_at(r->c, i)] = r->c->flow.side[i] == BRIO_FLOW_SINK ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    }
}

brio_status brio_vote_cut_find(brio_vote_cut *c, double bias, const uint8_t *label, uint8_t *out) {
    brio_status status = BRIO_OK;
    brio_context *ctx = c->g->ctx;
    terminals t = {c, label, (int32_t)(bias * BRIO_VOTE_UNIT * CAPACITY)};
    results r = {c, label, out};
    size_t open = c->flow.num_open, all = c->g->num_free;
    int threads = brio_threads(ctx, open, TETS_A_THREAD);
    BRIO_TRY(brio_sweep(ctx, threads, open, sum_votes, &t, BRIO_READS(c->t->tet), BRIO_READS(c->vote),
                        BRIO_WRITES(c->flow.terminal), BRIO_WRITES(c->wanted)));
    add_borders(&t);
    BRIO_TRY(brio_tet_flow_run(&c->flow));
    if (out != label) BRIO_TRY(brio_for(ctx, brio_threads(ctx, all, TETS_A_THREAD), all, copy_labels, &r));
    BRIO_TRY(brio_for(ctx, threads, open, write_labels, &r));
done:
    return status;
}
