/* The best labels of tetrahedra for given labels of the samples. */
#ifndef BRIO_RECONSTRUCT_VOTE_CUT_H
#define BRIO_RECONSTRUCT_VOTE_CUT_H

#include "reconstruct/labeled_delaunay/vote_graph.h"
#include "reconstruct/labels/tetrahedra_flow.h"

/** A facet of an open tetrahedron to one that keeps its label. */
typedef struct {
    uint32_t node, beyond; /* a node of the flow; a tetrahedron of the graph */
    int32_t weight, wants; /* of the facet; what it wanted in the last cut, for outer */
} brio_cut_border;

/** Workspace for many cuts of one graph, one after another. Node i of the flow is the i-th open tetrahedron. Where only
 *  some are open, these are copied: so a cut reads nothing of the others. */
typedef struct {
    const brio_vote_graph *g;
    const uint8_t *open;      /* #T, or NULL */
    uint32_t *list;           /* the open tetrahedra, or NULL: then node i is tetrahedron i */
    const brio_tetrahedra *t; /* of the nodes: those of the graph, or `copied` */
    brio_tetrahedra copied;   /* vertices as in the graph; mates are nodes, a facet to what is no node is its own */
    const float (*vote)[4];   /* of the nodes: those of the graph, or `own_vote` */
    float (*own_vote)[4];
    brio_cut_border *border; /* by nodes */
    size_t num_border;
    brio_tet_flow flow;
    int32_t *wanted; /* #nodes: the weight of what wants an open tetrahedron outer, less of what wants it inner, in the
                        last cut, without the border */
} brio_vote_cut;

/** Makes room for cuts of a graph.
 *  g     kept.
 *  open  #T, kept: 0 for tetrahedra that keep their labels in all cuts; NULL: all are open. Those from
 *        g->num_free on are never open.
 *  out   freed with brio_vote_cut_free, on failure too. */
brio_status brio_vote_cut_new(const brio_vote_graph *g, const uint8_t *open, brio_vote_cut *out);
void brio_vote_cut_free(brio_vote_cut *c);

/** Finds the labels of least energy of open tetrahedra; of all such labels those with the fewest inner ones.
 *  bias   log-odds that are added to the votes of every open tetrahedron for outer; not over 100.
 *  label  #nodes of the graph.
 *  out    #T, written for tetrahedra below g->num_free; may be `label`. */
brio_status brio_vote_cut_find(brio_vote_cut *c, double bias, const uint8_t *label, uint8_t *out);

#endif
