/* Labels of low energy along the graph of votes.
 *
 * If the labels of the samples are known, the energy is submodular: all other edges want one label. Then one minimum
 * cut finds the best labels of all tetrahedra. If the labels of the tetrahedra are known, each sample's best label is
 * that of the majority. The two steps take turns until no sample changes; on dense samples once is enough. What remains
 * are places where several samples and their tetrahedra must change at once. They show by samples that contradict many
 * of their own votes: round these, roof duality frees samples and tetrahedra together.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009 (the cut).
 * Differs from the paper: samples are unknowns, too. */
#include "reconstruct/labeled_delaunay/vote_labels.h"
#include "base/memory.h"
#include "base/team.h"
#include "reconstruct/labeled_delaunay/vote_cut.h"
#include "reconstruct/labeled_delaunay/vote_region.h"
#include <stdlib.h>
#include <string.h>

/* TURNS: most cuts; they end with one after which at most 1/FEW of the samples change. FIRST_BITS, PASSES: of the
 * descent. All chosen on generated solids. */
enum { TURNS = 4, FEW = 10000, FIRST_BITS = 8, PASSES = 3, NODES_A_THREAD = 1 << 12 };

/* A sample is contested if its violated votes are over this share of its votes. Chosen on generated solids. */
static const double CONTESTED = 0.4;

typedef struct {
    const brio_vote_graph *g;
    brio_context *ctx;
    size_t num_tets, num_finite, num_samples;
    uint8_t *label, *fixed;
    int64_t *outer, *all; /* #P each: sums of votes */
    size_t turned;        /* samples that changed their label in the last turn */
} voting;

/* --- one turn --- */

/* Votes in whole numbers: a star has less than 2^30 tetrahedra, so the sum of its votes has room. */
static const brio_vote_unit WHOLE = {1, 0x1p32};

static void turn_part(void *user, size_t begin, size_t end, int thread) {
    voting *v = user;
    size_t turned = 0;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        int64_t outer = v->outer[p];
        uint8_t label = outer > 0 ? BRIO_LABEL_OUTER : outer < 0 ? BRIO_LABEL_INNER : v->label[v->num_tets + p];
        turned += label != v->label[v->num_tets + p];
        v->label[v->num_tets + p] = label;
    }
    __atomic_fetch_add(&v->turned, turned, __ATOMIC_RELAXED);
}

static brio_status take_turns(voting *v) {
    brio_status status = BRIO_OK;
    brio_vote_cut cut = {0};
    BRIO_TRY(BRIO_ALLOC(v->ctx, v->outer, v->num_samples));
    BRIO_TRY(brio_vote_cut_new(v->g, NULL, &cut));
    for (int turn = 0; turn < TURNS; turn++) {
        BRIO_TRY(brio_progress(v->ctx, "label", 0.6 * turn / TURNS));
        BRIO_TRY(brio_vote_cut_find(&cut, 0, v->label, v->label));
        v->turned = 0;
        BRIO_TRY(brio_sum_votes(v->g, WHOLE, v->label, v->outer, NULL));
        BRIO_TRY(brio_for(v->ctx, brio_threads(v->ctx, v->num_samples, NODES_A_THREAD), v->num_samples, turn_part, v));
        if (v->turned <= v->num_samples / FEW) break;
    }
done:
    brio_vote_cut_free(&cut);
    brio_release(v->ctx, v->outer);
    return status;
}

/* --- contested places --- */

/* Frees a node. Threads may free one node at once. */
static void free_node(const voting *v, size_t node) {
    __atomic_store_n(&v->fixed[node], 0, __ATOMIC_RELAXED);
}

/* Frees a sample and its finite tetrahedra. */
static void free_star(const voting *v, uint32_t sample) {
    free_node(v, v->num_tets + sample);
    for (size_t i = v->g->first[sample]; i < v->g->first[sample + 1]; i++) {
        uint32_t tet = brio_star_tet(v->g->star[i]);
        if (tet < v->num_finite) free_node(v, tet);
    }
}

/* Frees contested samples, their tetrahedra, the samples of these, and the tetrahedra of these. */
static void free_contested(void *user, size_t begin, size_t end, int thread) {
    const voting *v = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        if (!((double)(v->all[p] - llabs(v->outer[p])) > 2 * CONTESTED * (double)v->all[p])) continue;
        for (size_t i = v->g->first[p]; i < v->g->first[p + 1]; i++) {
            uint32_t tet = brio_star_tet(v->g->star[i]);
            for (int k = 0; k < 4 && tet < v->num_finite; k++) free_star(v, v->g->dual->t.tet[tet].vertex[k]);
        }
    }
}

/* Lowers the energy of the labels of free nodes. */
static brio_status settle_contested(const voting *v, size_t *undecided) {
    brio_status status = BRIO_OK;
    brio_vote_region r;
    brio_energy_descent descent = {.first_bits = FIRST_BITS, .passes = PASSES, .from = 0.6};
    BRIO_TRY(brio_vote_region_new(v->g, v->fixed, v->label, &r));
    brio_signed_graph signs = brio_vote_region_signs(&r);
    BRIO_TRY(brio_lower_energy(&signs, r.fixed, &descent, r.label));
    for (size_t i = 0; i < r.num_nodes; i++) v->label[r.node[i]] = r.label[i];
    *undecided = descent.undecided;
done:
    brio_vote_region_free(&r);
    return status;
}

static voting begin(const brio_vote_graph *g, uint8_t *label) {
    const brio_pole_vectors *dual = g->dual;
    return (voting){.g = g,
                    .ctx = g->ctx,
                    .num_tets = dual->t.count,
                    .num_finite = dual->num_finite,
                    .num_samples = dual->num_points,
                    .label = label};
}

brio_status brio_vote_labels(const brio_vote_graph *g, const uint8_t *turned, uint8_t *label) {
    voting v = begin(g, label);
    for (size_t tet = 0; tet < v.num_tets; tet++) label[tet] = BRIO_LABEL_OUTER;
    for (size_t p = 0; p < v.num_samples; p++) label[v.num_tets + p] = turned[p] ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    return take_turns(&v);
}

brio_status brio_settle_labels(const brio_vote_graph *g, uint8_t *label, size_t *undecided) {
    brio_status status = BRIO_OK;
    voting v = begin(g, label);
    BRIO_TRY(BRIO_ALLOC(v.ctx, v.fixed, v.num_tets + v.num_samples));
    BRIO_TRY(BRIO_ALLOC(v.ctx, v.outer, v.num_samples));
    BRIO_TRY(BRIO_ALLOC(v.ctx, v.all, v.num_samples));
    memset(v.fixed, 1, v.num_tets + v.num_samples);
    BRIO_TRY(brio_sum_votes(g, WHOLE, label, v.outer, v.all));
    BRIO_TRY(brio_for(v.ctx, brio_threads(v.ctx, v.num_samples, NODES_A_THREAD), v.num_samples, free_contested, &v));
    brio_release(v.ctx, v.outer);
    brio_release(v.ctx, v.all);
    v.outer = v.all = NULL;
    BRIO_TRY(settle_contested(&v, undecided));
done:
    brio_release(v.ctx, v.outer);
    brio_release(v.ctx, v.all);
    brio_release(v.ctx, v.fixed);
    return status;
}
