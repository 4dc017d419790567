/* Candidates at sharp edges. */
#ifndef BRIO_RECONSTRUCT_COCONE_PRUNE_H
#define BRIO_RECONSTRUCT_COCONE_PRUNE_H

#include "reconstruct/cocone/tetrahedron_labels.h"

/** Drops candidates at sharp edges, and those at edges that become sharp by it. An edge is sharp when the angle between
 *  two consecutive candidates round it is more than 3 pi / 2, or when it has a single one. Not dropped are candidates
 *  that samples see between their outside and their inside, nor those at an edge between boundary samples.
 *  l  with cocones and turned set; labels are not looked at.   dropped  receives their number.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_cocone_prune(brio_context *ctx, const brio_tet_labels *l, size_t *dropped);

#endif
