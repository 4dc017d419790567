/* Labels of low energy.
 *
 * Finding the least energy is as hard as a maximum cut, because edges that want different labels make the energy not
 * submodular. Roof duality finds part of an optimal labeling by one flow. On all nodes of a large graph the flow is
 * slow and may decide almost none of them. On a block of nodes, with the labels around it fixed, it is fast and decides
 * nearly all. So the method improves one block after the other, then blocks with other borders and of twice the size.
 * No step raises the energy.
 *
 * Based on: Rother, Kolmogorov, Lempitsky, Szummer. Optimizing binary MRFs via extended roof duality. CVPR 2007 (to
 *           improve labels by roof duality with the labels of some nodes kept).
 * Differs from the paper: the nodes that are free are blocks of nodes near each other in space. Threads work on many
 *                         blocks at a time. */
#include "base/memory.h"
#include "base/read_ahead.h"
#include "base/rng.h"
#include "base/team.h"
#include "reconstruct/labels/roof_duality.h"
#include <math.h>

/* FEW: the passes end with one that flips at most 1/FEW of all nodes flipped so far. All chosen. */
enum { FEW = 100, NODES_A_THREAD = 512, NODES_A_SUM = 2048 };

/* What is worked on together takes one in SHARE bytes of the memory (chosen). NODE_BYTES: of a node of a graph of votes
 * with its edges. */
enum { SHARE = 32, NODE_BYTES = 128 };

typedef struct {
    const brio_signed_graph *g;
    const uint8_t *fixed;
    uint8_t *label;
    brio_energy_descent *descent;
    int threads;
    brio_roof *roof;           /* one for each thread */
    brio_read_ahead *ahead;    /* one for each thread */
    size_t undecided, toggled; /* in the last pass */
} problem;

/* --- passes --- */

typedef struct {
    const problem *pr;
    const brio_node_blocks *b;
    const uint32_t *block; /* the blocks of the round */
    size_t blocks;
    brio_status status;
} round_of_blocks;

/* Announces the edges of a block that a thread settles soon. */
static void expect_block(const round_of_blocks *r, size_t i, brio_read_ahead *ahead) {
    const brio_signed_graph *g = r->pr->g;
    if (!ahead->active || i >= r->blocks) return;
    for (size_t n = r->b->begin[r->block[i]]; n < r->b->end[r->block[i]]; n++)
        brio_expect(ahead, g->edge + g->first[r->b->node[n]]);
}

/* Settles blocks of one colour. By I1 of brio_node_blocks no thread reads a label that another thread writes. */
static void settle_part(void *user, size_t begin, size_t end, int thread) {
    round_of_blocks *r = user;
    const problem *pr = r->pr;
    for (size_t i = begin; i < end; i++) {
        expect_block(r, i + (size_t)pr->threads, &pr->ahead[thread]);
        brio_report(&r->status, brio_roof_settle(&pr->roof[thread], pr->g, r->b, r->block[i], pr->label));
    }
}

static brio_status settle_round(const problem *pr, const brio_node_blocks *b, size_t round) {
    size_t blocks = b->first_round[round + 1] - b->first_round[round];
    round_of_blocks r = {pr, b, b->block + b->first_round[round], blocks, BRIO_OK};
    int threads = blocks < (size_t)pr->threads ? (int)blocks : pr->threads;
    brio_report(&r.status, brio_for_chunks(pr->g->ctx, threads, blocks, 1, settle_part, &r));
    return r.status;
}

static void sum_up(problem *pr) {
    pr->undecided = pr->toggled = 0;
    for (int t = 0; t < pr->threads; t++) {
        pr->undecided += pr->roof[t].undecided, pr->toggled += pr->roof[t].toggled;
        pr->roof[t].undecided = pr->roof[t].toggled = 0;
    }
}

/* Returns how many nodes are worked on together: all, or where the graph is in scratch files as many as a part of the
 * memory holds, so that they are read once for all their rounds. */
static size_t worked_on_together(const brio_signed_graph *g) {
    return g->ctx->scratch ? brio_memory_limit(g->ctx) / SHARE / NODE_BYTES : g->count;
}

/* Improves every block that has a violated edge once. Each pass doubles the size of the blocks. */
static brio_status settle_blocks(problem *pr, int pass) {
    brio_status status = BRIO_OK;
    brio_node_blocks b;
    const brio_block_rule rule = {.bits = pr->descent->first_bits + pass,
                                  .together = worked_on_together(pr->g),
                                  .draw = brio_hash(1, (uint64_t)pass)};
    BRIO_TRY(brio_node_blocks_find(pr->g, pr->label, pr->fixed, rule, &b));
    for (size_t round = 0; round < b.num_rounds; round++) {
        double part = (pass + (double)round / (double)b.num_rounds) / pr->descent->passes;
        BRIO_TRY(brio_progress(pr->g->ctx, "label", pr->descent->from + (1 - pr->descent->from) * part));
        BRIO_TRY(settle_round(pr, &b, round));
    }
    sum_up(pr);
done:
    brio_node_blocks_free(&b);
    return status;
}

static brio_status improve(problem *pr) {
    brio_status status = BRIO_OK;
    brio_context *ctx = pr->g->ctx;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, pr->roof, (size_t)pr->threads));
    for (int t = 0; t < pr->threads; t++) pr->roof[t].flow = brio_flow_new(ctx);
    BRIO_TRY(BRIO_ALLOC(ctx, pr->ahead, (size_t)pr->threads));
    for (int t = 0; t < pr->threads; t++) brio_read_ahead_start(&pr->ahead[t], ctx);
    size_t toggled = 0; /* in all passes */
    for (int pass = 0; pass < pr->descent->passes; pass++) {
        BRIO_TRY(settle_blocks(pr, pass));
        toggled += pr->toggled;
        if (pr->toggled <= toggled / FEW) break;
    }
done:
    for (int t = 0; pr->roof && t < pr->threads; t++) brio_roof_free(&pr->roof[t]);
    brio_release(ctx, pr->roof);
    brio_release(ctx, pr->ahead);
    return status;
}

brio_status brio_lower_energy(const brio_signed_graph *g, const uint8_t *fixed, brio_energy_descent *descent,
                              uint8_t *label) {
    problem pr = {.g = g,
                  .fixed = fixed,
                  .label = label,
                  .descent = descent,
                  .threads = brio_threads(g->ctx, g->count, NODES_A_THREAD)};
    brio_status status = improve(&pr);
    descent->undecided = pr.undecided;
    return status;
}

/* --- energy --- */

/* Sums |weight| over the violated edges from node p to nodes of higher number, so that each edge counts once. In whole
 * numbers: sums have room for 2^33 edges. */
static int64_t violated_at(const brio_signed_graph *g, const uint8_t *label, size_t p) {
    int64_t sum = 0;
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
        if (g->edge[e].node > p && brio_label_violates(label, (uint32_t)p, g->edge[e]))
            sum += (int64_t)(0x1p28 * fabs((double)g->edge[e].weight) + 0.5);
    return sum;
}

typedef struct {
    const brio_signed_graph *g;
    const uint8_t *label;
    int64_t all;
} energy;

static void sum_nodes(void *user, size_t begin, size_t end, int thread) {
    energy *e = user;
    int64_t sum = 0;
    (void)thread;
    for (size_t p = begin; p < end; p++) sum += violated_at(e->g, e->label, p);
    __atomic_fetch_add(&e->all, sum, __ATOMIC_RELAXED);
}

/* Adds whole numbers, so that the sum does not depend on the threads. */
brio_status brio_label_energy(const brio_signed_graph *g, const uint8_t *label, double *out) {
    energy e = {.g = g, .label = label};
    brio_status status = brio_for(g->ctx, brio_threads(g->ctx, g->count, NODES_A_SUM), g->count, sum_nodes, &e);
    *out = 0x1p-28 * (double)e.all;
    return status;
}
