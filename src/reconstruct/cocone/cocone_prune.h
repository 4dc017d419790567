/* Removes candidates at sharp edges. */
#ifndef BRIO_RECONSTRUCT_COCONE_PRUNE_H
#define BRIO_RECONSTRUCT_COCONE_PRUNE_H

#include "reconstruct/cocone/tetrahedron_labels.h"

/** Removes candidates at sharp edges, and then those at edges that have become sharp. An edge is sharp if it has one
 *  candidate only, or if two consecutive candidates round it make an angle over 3 pi / 2. The function keeps candidates
 *  between a tetrahedron voted outer and one voted inner. It ignores edges between two boundary samples.
 *  labels   after brio_tet_labels_vote.
 *  dropped  receives the number of candidates removed.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_cocone_prune(brio_context *ctx, const brio_tet_labels *labels, size_t *dropped);

#endif
