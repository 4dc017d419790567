/* Samples at boundaries and in places where samples are too few. */
#ifndef BRIO_RECONSTRUCT_BOUNDARY_SAMPLES_H
#define BRIO_RECONSTRUCT_BOUNDARY_SAMPLES_H

#include "reconstruct/cocone/cocone_candidates.h"

/** Finds the boundary samples. A sample in the middle of a well-sampled surface has a Voronoi cell that is long and
 *  thin along the normal; a boundary sample has not.
 *  boundary  #P, 1 for boundary samples, 0 for others; owned by the caller (brio_release).
 *  count     receives the number of boundary samples.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_boundary_samples(brio_context *ctx, const brio_cocones *c, uint8_t **boundary, size_t *count);

#endif
