/* Samples at boundaries and where the sampling is too sparse. */
#ifndef BRIO_RECONSTRUCT_BOUNDARY_SAMPLES_H
#define BRIO_RECONSTRUCT_BOUNDARY_SAMPLES_H

#include "reconstruct/cocone/cocone_candidates.h"

/** boundary[p] = 1 for the samples whose Voronoi cells are not long and thin along the normal, as those in the middle
 *  of a well-sampled surface are.
 *  boundary  #P, owned by the caller (brio_release).   count  receives their number.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_boundary_samples(brio_context *ctx, const brio_cocones *c, uint8_t **boundary, size_t *count);

#endif
