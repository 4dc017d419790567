/* Part of the graph of votes as a signed graph of its own. */
#ifndef BRIO_RECONSTRUCT_VOTE_REGION_H
#define BRIO_RECONSTRUCT_VOTE_REGION_H

#include "reconstruct/labeled_delaunay/vote_graph.h"
#include "reconstruct/labels/signed_graph.h"

/** The free nodes and, fixed, those that edges join to them. Fixed nodes have no edges here. In memory they are in the
 *  order of the graph of votes. In scratch files they are along a curve, so that what is near in space is on few
 *  pages. */
typedef struct {
    brio_context *ctx;
    size_t count, num_nodes; /* the last node, if there is one more, is the evidence: outer for good */
    uint32_t *node;          /* #nodes: of the graph of votes */
    uint8_t *fixed, *label;
    size_t *first;
    brio_signed_edge *edge;
    double *position; /* of free nodes: of tetrahedra their centroids */
} brio_vote_region;

/** Copies the part of the graph around the nodes whose fixed[node] is 0, with their labels. Infinite tetrahedra
 *  are fixed.
 *  out  freed with brio_vote_region_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_vote_region_new(const brio_vote_graph *g, const uint8_t *fixed, const uint8_t *label,
                                 brio_vote_region *out);
void brio_vote_region_free(brio_vote_region *r);

/** Returns the region without the arrays that only it has; it must outlive the result. */
static inline brio_signed_graph brio_vote_region_signs(const brio_vote_region *r) {
    return (brio_signed_graph){r->ctx, r->count, r->position, 0, r->first, r->edge};
}

#endif
