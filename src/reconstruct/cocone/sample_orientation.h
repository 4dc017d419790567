/* Which way the pole of each sample lies: outside or inside. */
#ifndef BRIO_RECONSTRUCT_SAMPLE_ORIENTATION_H
#define BRIO_RECONSTRUCT_SAMPLE_ORIENTATION_H

#include "reconstruct/cocone/cocone_candidates.h"

/** turned[p] = 1 when the vector to the pole of sample p points inwards. Agrees along the candidates and between the
 *  sheets of a surface as well as they allow; where there is an outside, the hull is there.
 *  turned  #P, owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_orient_samples(brio_context *ctx, const brio_cocones *c, uint8_t **turned);

#endif
