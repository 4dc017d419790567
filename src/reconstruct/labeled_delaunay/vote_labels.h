/* Labels of tetrahedra and samples of low energy along the graph of votes. */
#ifndef BRIO_RECONSTRUCT_VOTE_LABELS_H
#define BRIO_RECONSTRUCT_VOTE_LABELS_H

#include "reconstruct/labeled_delaunay/vote_graph.h"

/** Finds labels by turns: the best labels of the tetrahedra, then those of the samples. Tetrahedra from g->num_free on
 *  are outer.
 *  turned     #P: 1 where the axis of a sample points inwards, a first guess.
 *  label      #nodes of the graph, written.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
brio_status brio_vote_labels(const brio_vote_graph *g, const uint8_t *turned, uint8_t *label);

/** Lowers the energy of labels where samples and their tetrahedra have to change at once.
 *  label      #nodes of the graph, from brio_vote_labels; changed.
 *  undecided  receives the nodes that the last roof duality did not decide.
 *  Returns what brio_vote_labels returns. */
brio_status brio_settle_labels(const brio_vote_graph *g, uint8_t *label, size_t *undecided);

#endif
