/* The graph of votes: tetrahedra and samples, joined where the place of one tells about the side of the other. The
 * triangulation has the edges; here are their weights. */
#ifndef BRIO_RECONSTRUCT_VOTE_GRAPH_H
#define BRIO_RECONSTRUCT_VOTE_GRAPH_H

#include "base/team.h"
#include "dual/pole_vectors.h"
#include "reconstruct/labels/label.h"

/** The weight of an edge of one log-odds: so no weight is over 1. */
#define BRIO_VOTE_UNIT (1 / 21.0)

/** In log-odds. Chosen: the least that decides between votes that cancel; six times as much changes nothing more. */
#define BRIO_HULL_VOTE 1.0

/** Labels are those of the nodes: node t < #T is tetrahedron t. Node #T + p is sample p: its label is that of the side
 *  to which its axis points. */
typedef struct {
    brio_context *ctx;
    const brio_pole_vectors *dual;
    size_t num_free;   /* tetrahedra below this have labels to be found: the finite ones, or all; others are outer */
    const float *own;  /* #P, or NULL: what evidence wants for the samples: weights for outer */
    float (*vote)[4];  /* #T by 4: of the edge from a tetrahedron to the sample in slot i; 0 for the infinite vertex */
    float (*facet)[4]; /* #T by 4: of the edge across facet i, at both ends; 0 between infinite tetrahedra */
    size_t *first;     /* #P + 1 */
    uint32_t *star;    /* star[first[p]] to star[first[p + 1] - 1]: 4 t + i for each tetrahedron t that has p in slot i,
                          in ascending order */
} brio_vote_graph;

/** Returns what evidence wants for a sample: the weight for outer, negative for inner, or 0. */
static inline float brio_own_vote(const brio_vote_graph *g, size_t sample) {
    return g->own ? g->own[sample] : 0;
}

/** Returns what speaks for outer before any sample votes: BRIO_HULL_VOTE for tetrahedra beyond the hull, 0 for others.
 *  Where no sample tells, what is beyond the hull is outside: flat tetrahedra within a side of the hull tell next to
 *  nothing, and those beyond it would else take the label of what is behind the side. */
static inline float brio_hull_vote(const brio_vote_graph *g, size_t tet) {
    return tet < g->dual->num_finite ? 0 : (float)(BRIO_HULL_VOTE * BRIO_VOTE_UNIT);
}

/** Builds the graph. A tetrahedron and a sample of it share an edge: its weight is the log-odds that the tetrahedron is
 *  on the side to which the sample's axis points (vote_weight.h). Two neighbours share an edge that wants one label:
 *  its weight is the area of their facet.
 *  dual     kept: it must outlive the graph. Its centres, planes and poles are freed (brio_pole_vectors_drop).
 *  spacing  #P: of the samples.
 *  noise    of the samples, as brio_least_noise finds it.
 *  own      #P, kept, or NULL: what evidence wants for the samples. With evidence the infinite tetrahedra have labels
 *           to be found, too: scans of rooms are seen from inside.
 *  out      freed with brio_vote_graph_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_vote_graph_new(brio_context *ctx, brio_pole_vectors *dual, const double *spacing, double noise,
                                const float *own, brio_vote_graph *out);
void brio_vote_graph_free(brio_vote_graph *g);

/** Return what the sample of an entry of `star` votes for, and its tetrahedron. */
static inline float brio_star_vote(const brio_vote_graph *g, uint32_t entry) {
    return g->vote[entry >> 2][entry & 3];
}
static inline uint32_t brio_star_tet(uint32_t entry) {
    return entry >> 2;
}

/** Announces the stars that a loop over samples reaches soon, and their tetrahedra. For each of its samples. */
void brio_expect_stars(const brio_vote_graph *g, size_t sample);

/** A slice of the tetrahedra. */
typedef struct {
    size_t first, end;
} brio_tet_slice;

/** Calls body for parts of the samples, for one slice of the tetrahedra after another: each thread reads all
 *  tetrahedra, in ascending order, and writes what its samples get of them. So sums at a sample are in the order of its
 *  star, without reading through its star.
 *  slice  written before each call: that of body's user.   along  what is read of the tetrahedra.
 *  Returns BRIO_OK or BRIO_ERR_CANCELLED. */
brio_status brio_for_tet_slices(const brio_vote_graph *g, brio_tet_slice *slice, const brio_swept *along,
                                brio_part_fn body, void *user);

/** What a weight is in whole numbers: weight / divisor * factor, rounded towards 0. */
typedef struct {
    double divisor, factor;
} brio_vote_unit;

static inline int64_t brio_in_vote_units(brio_vote_unit unit, float weight) {
    return (int64_t)((double)weight / unit.divisor * unit.factor);
}

/** Sums the votes on each sample along the tetrahedra, which are read once and in order.
 *  unit   so that the order of a sum does not matter.
 *  label  #nodes of the graph.
 *  outer  #P, written: the weights of a sample's votes for outer, less those for inner.
 *  all    #P, written: the sum of their magnitudes; or NULL. */
brio_status brio_sum_votes(const brio_vote_graph *g, brio_vote_unit unit, const uint8_t *label, int64_t *outer,
                           int64_t *all);

/** Returns the energy of labels, in the unit of the weights: the sum of |weight| over the edges that the labels
 *  contradict. Does not depend on the number of threads. */
brio_status brio_vote_energy(const brio_vote_graph *g, const uint8_t *label, double *out);

#endif
