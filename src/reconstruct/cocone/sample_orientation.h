/* The orientation of samples: whether the pole of a sample is outside or inside. */
#ifndef BRIO_RECONSTRUCT_SAMPLE_ORIENTATION_H
#define BRIO_RECONSTRUCT_SAMPLE_ORIENTATION_H

#include "reconstruct/cocone/cocone_candidates.h"

/** Sets turned[p] to 1 if the vector from sample p to its pole points inwards, else to 0. The choices agree along the
 *  candidates, and between the sheets of a surface, where they can. The hull is outside.
 *  turned  #P, owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
brio_status brio_orient_samples(brio_context *ctx, const brio_cocones *c, uint8_t **turned);

#endif
