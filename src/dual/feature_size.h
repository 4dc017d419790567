/* The local feature size, from the poles. */
#ifndef BRIO_DUAL_FEATURE_SIZE_H
#define BRIO_DUAL_FEATURE_SIZE_H

#include "dual/pole_vectors.h"

/** Allocates *size and fills it: size[p] is the distance from sample p to the nearest pole of any sample, an estimate
 *  of the distance from p to the medial axis. size[p] is infinite when there are no finite poles, and 0 for points that
 *  are not vertices.   size  #P, owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_feature_sizes(brio_context *ctx, const brio_pole_vectors *v, double **size);

#endif
