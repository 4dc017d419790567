/* Labels of low energy along the graph of votes.
 *
 * If the labels of the samples are known, the energy is submodular: all other edges want one label. Then one minimum cut
 * finds the best labels of all tetrahedra. If the labels of the tetrahedra are known, each sample's best label is that of
 * the majority. The two steps take turns until no sample changes; on dense samples once is enough. What remains are
 * places where several samples and their tetrahedra must change at once. They show by samples that contradict many of
 * their own votes: round these, roof duality frees samples and tetrahedra together.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009 (the cut).
 * Differs from the paper: samples are unknowns, too. */
#include "reconstruct/labeled_delaunay/vote_labels.h"
#include "base/memory.h"
#include "base/team.h"
#include "reconstruct/labeled_delaunay/vote_cut.h"
#include <math.h>

/* TURNS: most cuts; they end with one after which at most 1/FEW of the samples change. FIRST_BITS, PASSES: of the descent. All chosen on generated solids. */
enum { TURNS = 4, FEW = 10000, FIRST_BITS = 9, PASSES = 3, NODES_A_THREAD = 1 << 12 };

/* A sample is contested if its violated votes are over this share of its votes. Chosen on generated solids. */
static const double CONTESTED = 0.4;

typedef struct {
    const brio_vote_graph *g;
    brio_context *ctx;
    size_t num_tets, num_finite, num_samples;
    uint8_t *label, *fixed;
    size_t turned; /* turned: samples that changed their label in the last turn */
} voting;

static bool is_outer(const voting *v, uint32_t node) {
    return v->label[node] == BRIO_LABEL_OUTER;
}

/* --- one turn --- */

/* Returns the sum of the weights of a sample's votes for outer, less those for inner.   all  receives the sum of their
 * magnitudes. */
static double tally(const voting *v, size_t node, double *all) {
    double outer = 0;
    *all = 0;
    for (size_t e = v->g->first[node]; e < v->g->first[node + 1]; e++) {
        double weight = (double)v->g->edge[e].weight;
        outer += is_outer(v, v->g->edge[e].node) ? weight : -weight;
        *all += fabs(weight);
    }
    return outer;
}

static void turn_part(void *user, size_t begin, size_t end, int thread) {
    voting *v = user;
    size_t turned = 0;
    double all;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        double outer = tally(v, v->num_tets + p, &all);
        uint8_t label = outer > 0 ? BRIO_LABEL_OUTER : outer < 0 ? BRIO_LABEL_INNER : v->label[v->num_tets + p];
        turned += label != v->label[v->num_tets + p];
        v->label[v->num_tets + p] = label;
    }
    __atomic_fetch_add(&v->turned, turned, __ATOMIC_RELAXED);
}

static brio_status take_turns(voting *v) {
    brio_status status = BRIO_OK;
    brio_vote_cut cut;
    BRIO_TRY(brio_vote_cut_new(v->g, NULL, &cut));
    for (int turn = 0; turn < TURNS; turn++) {
        BRIO_TRY(brio_progress(v->ctx, "label", 0.6 * turn / TURNS));
        BRIO_TRY(brio_vote_cut_find(&cut, 0, v->label, v->label));
        v->turned = 0;
        brio_for(v->ctx, brio_threads(v->ctx, v->num_samples, NODES_A_THREAD), v->num_samples, turn_part, v);
        if (v->turned <= v->num_samples / FEW) break;
    }
done:
    brio_vote_cut_free(&cut);
    return status;
}

/* --- contested places --- */

/* Frees a node and the nodes that edges join to it, infinite tetrahedra excepted. */
static void free_round(const voting *v, size_t node) {
    v->fixed[node] = 0;
    for (size_t e = v->g->first[node]; e < v->g->first[node + 1]; e++) {
        uint32_t other = v->g->edge[e].node;
        if (other < v->num_finite || other >= v->num_tets) v->fixed[other] = 0;
    }
}

/* Frees contested samples, their tetrahedra, the samples of these, and the tetrahedra of these. */
static brio_status free_contested(const voting *v) {
    brio_status status = BRIO_OK;
    uint32_t *contested = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(v->ctx, contested, v->num_samples));
    for (size_t p = 0; p < v->num_samples; p++) {
        double all, outer = tally(v, v->num_tets + p, &all);
        if (all - fabs(outer) > 2 * CONTESTED * all) contested[count++] = (uint32_t)(v->num_tets + p);
    }
    for (size_t i = 0; i < count; i++)
        for (size_t e = v->g->first[contested[i]]; e < v->g->first[contested[i] + 1]; e++) {
            uint32_t tet = v->g->edge[e].node;
            for (size_t n = v->g->first[tet]; n < v->g->first[tet + 1] && tet < v->num_finite; n++)
                if (v->g->edge[n].node >= v->num_tets) free_round(v, v->g->edge[n].node);
        }
done:
    brio_release(v->ctx, contested);
    return status;
}

brio_status brio_vote_labels(const brio_vote_graph *g, const uint8_t *turned, uint8_t *label, size_t *undecided) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *dual = g->dual;
    brio_signed_graph signs = brio_vote_signs(g);
    brio_energy_descent descent = {.first_bits = FIRST_BITS, .passes = PASSES, .from = 0.6};
    voting v = {.g = g,
                .ctx = g->ctx,
                .num_tets = dual->t.count,
                .num_finite = dual->num_finite,
                .num_samples = dual->num_points,
                .label = label};
    for (size_t tet = 0; tet < v.num_tets; tet++) label[tet] = BRIO_LABEL_OUTER;
    for (size_t p = 0; p < v.num_samples; p++) label[v.num_tets + p] = turned[p] ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    BRIO_TRY(take_turns(&v));
    BRIO_TRY(BRIO_ALLOC(v.ctx, v.fixed, signs.count));
    for (size_t i = 0; i < signs.count; i++) v.fixed[i] = 1;
    BRIO_TRY(free_contested(&v));
    BRIO_TRY(brio_lower_energy(&signs, v.fixed, &descent, label));
    *undecided = descent.undecided;
done:
    brio_release(v.ctx, v.fixed);
    return status;
}
