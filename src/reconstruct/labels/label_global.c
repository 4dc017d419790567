/* Global labeling of poles: seeks labels of low energy. The energy is the sum of |weight| over the edges that the
 * labels contradict, with the balanced weights of the graph of poles.
 *
 * Finding the least energy is as hard as a maximum cut, because edges that want different labels make the energy not
 * submodular. Roof duality finds part of an optimal labeling by one flow. On all poles of a large sample the flow is
 * slow and decides almost none of them. On a block of poles, with the labels around it fixed, it is fast and decides
 * nearly all. So the method starts from the greedy labels and improves one block after the other, then blocks with
 * other borders and of twice the size. No step raises the energy.
 *
 * Based on: Rother, Kolmogorov, Lempitsky, Szummer. Optimizing binary MRFs via extended roof duality. CVPR 2007 (to
 *           improve labels by roof duality with the labels of some nodes kept).
 * Differs from the paper: the nodes that are free are blocks of poles near each other in space. Threads work on many
 *                         blocks at a time. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/team.h"
#include "reconstruct/labels/labeling.h"
#include "reconstruct/labels/roof_duality.h"
#include <math.h>
#include <string.h>

/* All chosen. PASSES: most passes. Pass i has blocks of 2^(FIRST_BITS + i) poles. FEW: the passes end with one that
 * flips at most 1/FEW of all poles flipped so far. */
enum { PASSES = 5, FIRST_BITS = 9, FEW = 100, POLES_A_THREAD = 1 << FIRST_BITS };

typedef struct {
    const brio_pole_graph *g;
    uint8_t *label, *certain;
    int threads;
    brio_roof *roof;           /* one for each thread */
    size_t undecided, toggled; /* in the last pass */
} problem;

/* --- passes --- */

typedef struct {
    const problem *pr;
    const brio_pole_blocks *b;
    const uint32_t *block; /* the blocks of the round */
    brio_status status;
} round_of_blocks;

/* By I1 of brio_pole_blocks no thread reads a label that another thread writes. */
static void settle_part(void *user, size_t begin, size_t end, int thread) {
    round_of_blocks *r = user;
    const problem *pr = r->pr;
    for (size_t i = begin; i < end; i++)
        brio_report(&r->status, brio_roof_settle(&pr->roof[thread], pr->g, r->b, r->block[i], pr->label));
}

static brio_status settle_round(const problem *pr, const brio_pole_blocks *b, size_t round) {
    round_of_blocks r = {pr, b, b->block + b->first_round[round], BRIO_OK};
    size_t blocks = b->first_round[round + 1] - b->first_round[round];
    int threads = blocks < (size_t)pr->threads ? (int)blocks : pr->threads;
    brio_for_chunks(pr->g->ctx, threads, blocks, 1, settle_part, &r);
    return r.status;
}

static void sum_up(problem *pr) {
    pr->undecided = pr->toggled = 0;
    for (int t = 0; t < pr->threads; t++) {
        pr->undecided += pr->roof[t].undecided, pr->toggled += pr->roof[t].toggled;
        pr->roof[t].undecided = pr->roof[t].toggled = 0;
    }
}

/* Improves every block that has a violated edge once. Each pass doubles the size of the blocks. */
static brio_status settle_blocks(problem *pr, int pass) {
    brio_status status = BRIO_OK;
    brio_pole_blocks b;
    BRIO_TRY(brio_pole_blocks_find(pr->g, pr->label, pr->certain, FIRST_BITS + pass, brio_hash(1, (uint64_t)pass), &b));
    for (size_t round = 0; round < b.num_rounds; round++) {
        BRIO_TRY(
            brio_progress(pr->g->ctx, "label", 0.6 + 0.4 * (pass + (double)round / (double)b.num_rounds) / PASSES));
        BRIO_TRY(settle_round(pr, &b, round));
    }
    sum_up(pr);
done:
    brio_pole_blocks_free(&b);
    return status;
}

static brio_status lower_energy(problem *pr) {
    brio_status status = BRIO_OK;
    brio_context *ctx = pr->g->ctx;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, pr->roof, (size_t)pr->threads));
    for (int t = 0; t < pr->threads; t++) pr->roof[t].flow = brio_flow_new(ctx);
    size_t toggled = 0; /* in all passes */
    for (int pass = 0; pass < PASSES; pass++) {
        BRIO_TRY(settle_blocks(pr, pass));
        toggled += pr->toggled;
        if (pr->toggled <= toggled / FEW) break;
    }
done:
    for (int t = 0; pr->roof && t < pr->threads; t++) brio_roof_free(&pr->roof[t]);
    brio_release(ctx, pr->roof);
    return status;
}

/* --- the whole --- */

/* Sets a pole to outer and certain if its centre is beyond the samples' bounding box by half its radius or more
 * (docs/decisions/008-balanced-weights.md). Five sixths of such a ball are outside the box, and a solid is inside the
 * convex hull of its surface. Balls less far outside may be inner balls that reach through an opening. The greedy
 * labeling does not get these certain poles: on sparse samples they misled it. */
static void settle_beyond_box(const brio_pole_graph *g, uint8_t *certain, uint8_t *label) {
    for (size_t k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t s = 0; s < g->diagram->num_samples; s++) {
            low = fmin(low, g->diagram->samples[3 * s + k]);
            high = fmax(high, g->diagram->samples[3 * s + k]);
        }
        for (size_t p = 0; p < g->diagram->poles->count; p++) {
            double x = g->diagram->poles->centre[3 * p + k], half = 0.5 * sqrt(g->diagram->poles->square[p]);
            if (x < low - half || x > high + half) certain[p] = 1, label[p] = BRIO_LABEL_OUTER;
        }
    }
}

brio_status brio_label_global(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats) {
    brio_status status = BRIO_OK;
    size_t n = g->diagram->poles->count;
    problem pr = {.g = g, .label = label, .threads = brio_threads(g->ctx, n, POLES_A_THREAD)};
    uint8_t *before = NULL;
    BRIO_TRY(brio_label_greedy(g, label, stats));
    BRIO_TRY(BRIO_ALLOC(g->ctx, pr.certain, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, before, n));
    brio_label_certain(g, pr.certain);
    settle_beyond_box(g, pr.certain, label);
    stats->energy_greedy = brio_label_energy(g, label);
    memcpy(before, label, n);
    BRIO_TRY(lower_energy(&pr));
    stats->undecided = pr.undecided;
    for (size_t p = 0; p < n; p++) stats->toggled += label[p] != before[p];
done:
    brio_release(g->ctx, pr.certain);
    brio_release(g->ctx, before);
    return status;
}
