/* Labelings of poles as inner or outer. */
#ifndef BRIO_RECONSTRUCT_LABELING_H
#define BRIO_RECONSTRUCT_LABELING_H

#include "base/experiment.h"
#include "reconstruct/labels/pole_graph.h"

/** What a labeling counts. A labeling leaves the fields that it does not compute unchanged. */
typedef struct {
    size_t confused;      /* greedy: poles that had evidence for both labels when they were labeled */
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

/** Starts from the greedy labels and sets poles far outside the samples' bounding box to outer. Then repeats over
 *  blocks of poles: roof duality finds poles whose flip lowers the energy, and flips them. Stops after five passes, or
 *  after a pass that flips next to nothing. */
brio_status brio_label_global(const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** An experiment's part: a labeling in place of those above. */
struct brio_label_part {
    void *user;
    double least_weight; /* of the edges of the graph, as brio_pole_evidence has it */
    brio_status (*label)(void *user, const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);
};

/** Sets certain[p] to 1 for the certain poles and to 0 for all others.   certain  #poles, written. */
void brio_label_certain(const brio_pole_graph *g, uint8_t *certain);

#endif
