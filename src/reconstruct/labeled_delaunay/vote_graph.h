/* The graph of votes: tetrahedra and samples, joined where the place of one tells about the side of the other. */
#ifndef BRIO_RECONSTRUCT_VOTE_GRAPH_H
#define BRIO_RECONSTRUCT_VOTE_GRAPH_H

#include "dual/pole_vectors.h"
#include "reconstruct/labels/signed_graph.h"

/** The weight of an edge of one log-odds: so no weight is over 1. */
#define BRIO_VOTE_UNIT (1 / 21.0)

/** Node t < #T is tetrahedron t. Node #T + p is sample p: its label is that of the side to which its axis points. */
typedef struct {
    brio_context *ctx;
    const brio_pole_vectors *dual;
    size_t *first;
    brio_signed_edge *edge;
    double *position; /* #nodes by 3: centroids and samples */
} brio_vote_graph;

/** Builds the graph. A tetrahedron and a sample of it share an edge: its weight is the log-odds that the tetrahedron is
 *  on the side to which the sample's axis points (vote_weight.h). Two neighbours share an edge that wants one label: its
 *  weight is the area of their facet.
 *  dual     kept: it must outlive the graph.
 *  spacing  #P: of the samples.
 *  noise    of the samples, as brio_least_noise finds it.
 *  out      freed with brio_vote_graph_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_vote_graph_new(brio_context *ctx, const brio_pole_vectors *dual, const double *spacing, double noise,
                                brio_vote_graph *out);
void brio_vote_graph_free(brio_vote_graph *g);

/** Returns the graph without the triangulation, which must outlive the result. */
static inline brio_signed_graph brio_vote_signs(const brio_vote_graph *g) {
    return (brio_signed_graph){.ctx = g->ctx,
                               .count = g->dual->t.count + g->dual->num_points,
                               .position = g->position,
                               .first = g->first,
                               .edge = g->edge};
}

#endif
