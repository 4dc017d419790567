/* Labelling of poles as inner or outer. */
#ifndef BRIO_RECONSTRUCT_LABELLING_H
#define BRIO_RECONSTRUCT_LABELLING_H

#include "reconstruct/pole_graph.h"

/** label[p] of every pole, hidden ones too. Poles whose tetrahedron has a bounding point and the poles on the hull of
 *  the power diagram's dual are outer from the start and for good: only then does every crust face close. *confused
 *  counts the poles that had evidence for both labels when they were labelled. */
brio_status brio_label_greedy(const brio_pole_graph *g, uint8_t *label, size_t *confused);

#endif
