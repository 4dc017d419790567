/* The best labels of tetrahedra for given labels of the samples. */
#ifndef BRIO_RECONSTRUCT_VOTE_CUT_H
#define BRIO_RECONSTRUCT_VOTE_CUT_H

#include "reconstruct/labeled_delaunay/vote_graph.h"
#include "reconstruct/labels/max_flow.h"

/** Workspace for many cuts of one graph, one after another. */
typedef struct {
    const brio_vote_graph *g;
    const uint8_t *open; /* #T, or NULL */
    brio_flow flow;
    brio_flow_edge *edge;
    int64_t *terminal;
    int64_t *wanted; /* of each node in the last cut: the weight of what wants it outer, less of what wants it inner */
    uint32_t *node;  /* #T: of the flow, or none */
    uint32_t *tet;   /* of each node */
    uint8_t *side;
    size_t num_nodes, num_edges;
    bool begun; /* there was a cut: its flow is where the next one begins */
} brio_vote_cut;

/** g     kept.
 *  open  #T, kept: 0 for tetrahedra that keep their labels in all cuts; NULL: all are open.
 *  out   freed with brio_vote_cut_free, on failure too. */
brio_status brio_vote_cut_new(const brio_vote_graph *g, const uint8_t *open, brio_vote_cut *out);
void brio_vote_cut_free(brio_vote_cut *c);

/** Finds the labels of least energy of open finite tetrahedra; of all such labels those with the fewest inner ones.
 *  bias   log-odds that are added to the votes of every open tetrahedron for outer.
 *  label  #nodes of the graph.
 *  out    #T, written for finite tetrahedra; may be `label`.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_vote_cut_find(brio_vote_cut *c, double bias, const uint8_t *label, uint8_t *out);

#endif
