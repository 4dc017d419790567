/* The confidence of the surface at a sample, from the votes, and at a triangle, from its corners and its size.
 *
 * Two measures were found to tell right places of surfaces of generated solids from wrong ones:
 *   agreement  of the votes of the sample and of its neighbours along the surface, the share that the labels satisfy,
 *              less the share that they contradict, by log-odds. It is low where the labels are a compromise: at wrong
 *              handles, in noise, and at walls as thin as the spacing.
 *   margin     the log-odds of the labels of the two tetrahedra of a facet, by the votes of their samples alone; the
 *              mean over the facets at the sample and at its neighbours. It is low where the area decided and not the
 *              votes: across holes, and where the samples are too few.
 * A logistic regression on both gives the probability that the surface is right. Right are vertices whose triangles are
 * everywhere within 0.6 edges of the solid and whose normal is within 60 degrees of its normal.
 *
 * At a triangle, a logistic regression on two measures: the mean, in log-odds, of the confidences of its corners, and
 * how often its circle is larger than usual there (open_surface/face_sizes.c): the corners of a lid over a hole are
 * samples, of which many are sure, and its width tells it. Right are triangles of which at least half is within two
 * pixels, about two spacings, of what some camera saw, and faces the same way. Fitted to simulated scans, one-sided
 * ones and complete clouds, of models that nothing is judged on (docs/algorithms.md).
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009 (the
 * energy). */
#include "reconstruct/labeled_delaunay/vote_confidence.h"
#include "base/memory.h"
#include "base/team.h"
#include <math.h>

/* Chosen. */
enum { SAMPLES_A_THREAD = 1 << 12 };

/* Measured on 16 generated solids, implicit and machined, each sampled evenly, evenly with noise, at random, and
 * sparsely; the four samplings count equally. */
static const double CONSTANT = -8.80, OF_AGREEMENT = 10.87, OF_MARGIN = 0.075;

/* Mean margins beyond these count as these: the regression is a line between them. */
static const double LEAST_MARGIN = -20, MOST_MARGIN = 30;

/* Sums at a sample, then over the sample and its neighbours. */
typedef struct {
    float kept, all; /* votes satisfied less votes contradicted; all votes */
    float margin, facets;
} evidence;

typedef struct {
    double kept, all;
} own_votes;

typedef struct {
    const brio_vote_graph *g;
    const uint8_t *label;
    const brio_facets *facets;
    brio_tet_slice slice;
    own_votes *votes; /* #P, while they are counted */
    float *margin;    /* #facets */
    evidence *own, *round;
    float *confidence;
} judgement;

/* Adds the vote of a sample on a tetrahedron. */
static void add_vote(const judgement *j, uint32_t tet, int slot, double *kept, double *all) {
    const brio_pole_vectors *v = j->g->dual;
    double vote = (double)j->g->vote[tet][slot], weight = fabs(vote) / BRIO_VOTE_UNIT;
    bool alike = j->label[tet] == j->label[v->t.count + v->t.tet[tet].vertex[slot]];
    *kept += alike == (vote < 0) ? -weight : weight;
    *all += weight;
}

/* Adds the votes of samples along the tetrahedra. */
static void add_own_votes(void *user, size_t begin, size_t end, int thread) {
    const judgement *j = user;
    (void)thread;
    for (size_t tet = j->slice.first; tet < j->slice.end; tet++)
        for (int i = 0; i < 4; i++) {
            size_t p = j->g->dual->t.tet[tet].vertex[i];
            if (p - begin < end - begin) add_vote(j, (uint32_t)tet, i, &j->votes[p].kept, &j->votes[p].all);
        }
}

static brio_status count_own_votes(judgement *j) {
    brio_status status = BRIO_OK;
    brio_context *ctx = j->g->ctx;
    size_t n = j->g->dual->num_points;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, j->votes, n));
    BRIO_TRY(brio_for_tet_slices(j->g, &j->slice, BRIO_ARRAYS(BRIO_READS(j->g->dual->t.tet), BRIO_READS(j->g->vote)),
                                 add_own_votes, j));
    for (size_t p = 0; p < n; p++) j->own[p] = (evidence){(float)j->votes[p].kept, (float)j->votes[p].all, 0, 0};
done:
    brio_release(ctx, j->votes);
    return status;
}

static uint32_t corner_of(const judgement *j, uint32_t facet, int k) {
    return j->g->dual->t.tet[brio_tet_of(facet)].vertex[BRIO_FACET[brio_slot_of(facet)][k]];
}

/* Measures the margins of facets. */
static void measure_margins(void *user, size_t begin, size_t end, int thread) {
    const judgement *j = user;
    const brio_tetrahedra *t = &j->g->dual->t;
    (void)thread;
    for (size_t f = begin; f < end; f++) {
        uint32_t facet = j->facets->facet[f], sides[2] = {brio_tet_of(facet), brio_tet_of(*brio_mate(t, facet))};
        double kept = 0, all = 0;
        for (int i = 0; i < 8; i++)
            if (t->tet[sides[i / 4]].vertex[i % 4] != t->infinite) add_vote(j, sides[i / 4], i % 4, &kept, &all);
        j->margin[f] = (float)kept;
    }
}

/* Adds the margin of a facet to its samples. */
static void add_margin(const judgement *j, size_t f) {
    for (int k = 0; k < 3; k++) {
        evidence *e = &j->own[corner_of(j, j->facets->facet[f], k)];
        e->margin += j->margin[f];
        e->facets++;
    }
}

/* Adds the evidence of the samples of a facet, the margins as means, to each of them. */
static void pool(const judgement *j, uint32_t facet) {
    evidence sum = {0, 0, 0, 0};
    for (int k = 0; k < 3; k++) {
        const evidence *own = &j->own[corner_of(j, facet, k)];
        double margin = fmin(fmax((double)(own->margin / own->facets), LEAST_MARGIN), MOST_MARGIN);
        sum.kept += own->kept, sum.all += own->all, sum.margin += (float)margin, sum.facets++;
    }
    for (int k = 0; k < 3; k++) {
        evidence *round = &j->round[corner_of(j, facet, k)];
        round->kept += sum.kept, round->all += sum.all, round->margin += sum.margin, round->facets += sum.facets;
    }
}

static void judge(void *user, size_t begin, size_t end, int thread) {
    const judgement *j = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        evidence e = j->round[p];
        double agreement = e.all > 0 ? (double)(e.kept / e.all) : 0, margin = (double)(e.margin / e.facets);
        j->confidence[p] =
            e.facets > 0 ? (float)(1 / (1 + exp(-CONSTANT - OF_AGREEMENT * agreement - OF_MARGIN * margin))) : 0;
    }
}

brio_status brio_vote_confidence(const brio_vote_graph *g, const uint8_t *label, const brio_facets *facets,
                                 float *confidence) {
    brio_status status = BRIO_OK;
    size_t n = g->dual->num_points;
    int threads = brio_threads(g->ctx, n, SAMPLES_A_THREAD);
    judgement j = {.g = g, .label = label, .facets = facets, .confidence = confidence};
    BRIO_TRY(BRIO_ALLOC(g->ctx, j.own, n));
    BRIO_TRY(count_own_votes(&j));
    BRIO_TRY(BRIO_ALLOC(g->ctx, j.margin, facets->count));
    BRIO_TRY(BRIO_ALLOC_ZERO(g->ctx, j.round, n));
    BRIO_TRY(brio_for(g->ctx, threads, facets->count, measure_margins, &j));
    for (size_t i = 0; i < facets->count; i++) add_margin(&j, i);
    for (size_t i = 0; i < facets->count; i++) pool(&j, facets->facet[i]);
    BRIO_TRY(brio_for(g->ctx, threads, n, judge, &j));
done:
    brio_release(g->ctx, j.margin);
    brio_release(g->ctx, j.own);
    brio_release(g->ctx, j.round);
    return status;
}

/* --- tetrahedra --- */

void brio_tetrahedron_confidence(const brio_vote_graph *g, const uint8_t *label, float *confidence) {
    const judgement j = {.g = g, .label = label};
    const brio_tetrahedra *t = &g->dual->t;
    for (uint32_t tet = 0; tet < t->count; tet++) {
        double kept = 0, all = 0;
        for (int i = 0; i < 4; i++)
            if (t->tet[tet].vertex[i] != t->infinite) add_vote(&j, tet, i, &kept, &all);
        confidence[tet] = (float)(1 / (1 + exp(-kept)));
    }
}

/* --- triangles --- */

/* Measured on 27 surfaces of 5 models, with holes left open and closed; each counts equally, and in it each triangle by
 * its area. */
static const double CONSTANT_OF_FACE = 4.94, OF_CORNERS = 0.678, OF_SIZE = -3.64;

/* Confidences below this, mean log-odds over this, and sizes beyond this, count as these. Chosen. */
static const double LEAST = 1e-6, MOST_ODDS = 4, MOST_SIZE = 20;

float brio_face_confidence(const float corners[3], float size) {
    double odds = 0;
    for (int k = 0; k < 3; k++) {
        double p = fmin(fmax((double)corners[k], LEAST), 1 - LEAST);
        odds += log(p / (1 - p)) / 3;
    }
    double wide = log(fmin(fmax((double)size, 1), MOST_SIZE));
    return (float)(1 / (1 + exp(-CONSTANT_OF_FACE - OF_CORNERS * fmin(odds, MOST_ODDS) - OF_SIZE * wide)));
}
