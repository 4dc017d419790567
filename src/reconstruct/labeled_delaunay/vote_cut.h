/* The best labels of tetrahedra for given labels of the samples. */
#ifndef BRIO_RECONSTRUCT_VOTE_CUT_H
#define BRIO_RECONSTRUCT_VOTE_CUT_H

#include "reconstruct/labeled_delaunay/vote_graph.h"

/** Workspace for many cuts of one graph, one after another. Node i of a cut is the i-th open tetrahedron. Where only
 *  some are open, these are copied: so a cut reads nothing of the others. */
typedef struct {
    const brio_vote_graph *g;
    size_t num_nodes;
    const brio_tetrahedron *tet; /* #nodes: those of the graph, or `copied` */
    const float (*vote)[4];      /* #nodes: those of the graph, or `copied_vote` */
    const float (*facet)[4];     /* #nodes: those of the graph, or `copied_facet` */
    uint32_t *list;              /* #nodes: the open tetrahedra, or NULL: then node i is tetrahedron i */
    brio_tetrahedron *copied;    /* vertices as in the graph; mates are facets of nodes. 4 #nodes + j is no facet: it
                                    leads to tetrahedron beyond[j] */
    float (*copied_vote)[4], (*copied_facet)[4];
    uint32_t *beyond; /* tetrahedra that are not open, next to some that are */
    size_t num_beyond;
    int32_t *residual; /* 4 #nodes: what the last flow left; NULL where arrays are in scratch files */
    bool has_flow;     /* whether there was one */
} brio_vote_cut;

/** Makes room for cuts of a graph.
 *  g     kept.
 *  open  #T: 0 for tetrahedra that keep their labels in all cuts; NULL: all are open. Those from g->num_free on are
 *        never open.
 *  out   freed with brio_vote_cut_free, on failure too. */
brio_status brio_vote_cut_new(const brio_vote_graph *g, const uint8_t *open, brio_vote_cut *out);
void brio_vote_cut_free(brio_vote_cut *c);

/** Finds the labels of least energy of open tetrahedra; of all such labels those with the fewest inner ones.
 *  bias   log-odds that are added to the votes of every open tetrahedron for outer; not over 100.
 *  label  #nodes of the graph.
 *  out    #T, written for tetrahedra below g->num_free; may be `label`. On failure undefined. */
brio_status brio_vote_cut_find(brio_vote_cut *c, double bias, const uint8_t *label, uint8_t *out);

#endif
