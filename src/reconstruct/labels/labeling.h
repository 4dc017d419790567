/* Labelings of poles as inner or outer. */
#ifndef BRIO_RECONSTRUCT_LABELING_H
#define BRIO_RECONSTRUCT_LABELING_H

#include "reconstruct/labels/pole_graph.h"

/** What a labeling counts. A labeling leaves the fields that it does not compute unchanged. */
typedef struct {
    size_t confused;      /* greedy: poles that had evidence for both labels when they were labeled */
    size_t unreached;     /* naive, theoretical: poles that were left to the greedy labeling */
    size_t undecided;     /* global: poles that the last roof duality of their block did not decide */
    size_t toggled;       /* global: poles whose final label differs from the one it started from */
    double energy_greedy; /* global: the energy of the labels that it started from */
} brio_labeling_stats;

/* Every labeling writes label[p] for every pole p, hidden poles included. The caller sets all labels to BRIO_LABEL_NONE
 * before.
 *
 * A pole is certain if its tetrahedron has a bounding point, or if it is on the hull of the dual of the power diagram.
 * Every labeling makes certain poles outer, because only then is the crust closed.
 *
 * All labelings return BRIO_OK, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */

/** Labels the pole with the strongest evidence first. A pole that has a label keeps it, and its evidence is as strong
 *  as that of a certain pole. */
brio_status brio_label_greedy(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** Spreads labels breadth first from all certain poles. The greedy labeling labels the poles that are not reached. */
brio_status brio_label_naive(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** Spreads labels breadth first from one sample of the hull. The edges of the graph must weigh more than
 *  BRIO_THEORETICAL_WEIGHT. The greedy labeling labels the poles that are not reached. */
brio_status brio_label_theoretical(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** Starts from the greedy labels and sets poles far outside the samples' bounding box to outer. Then repeats over
 *  blocks of poles: roof duality finds poles whose flip lowers the energy, and flips them. Stops after five passes, or
 *  after a pass that flips next to nothing. */
brio_status brio_label_global(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** -cos of pi / 4. The theoretical labeling joins two poles whose balls intersect at a larger angle than pi / 4. */
#define BRIO_THEORETICAL_WEIGHT (-0.70710678118654752)

/** Sets certain[p] to 1 for the certain poles and to 0 for all others.   certain  #poles, written. */
void brio_label_certain(const brio_pole_graph *g, uint8_t *certain);

/** Spreads labels breadth first along the edges to poles without a label. A certain pole becomes outer. Any other pole
 *  takes the label of the pole that reaches it, or the opposite label if the weight of the edge is negative.
 *  queue  #poles, workspace: the first `size` entries are the labeled poles to start from. */
void brio_label_spread(const brio_pole_graph *g, const uint8_t *certain, uint8_t *label, uint32_t *queue, size_t size);

/** Counts the poles without a label in stats->unreached and lets the greedy labeling label them. */
brio_status brio_label_finish(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

#endif
