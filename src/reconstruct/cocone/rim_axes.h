/* Axes of samples at the rims of open sheets. */
#ifndef BRIO_RECONSTRUCT_RIM_AXES_H
#define BRIO_RECONSTRUCT_RIM_AXES_H

#include "dual/pole_vectors.h"

/** Replaces axes of samples on the hull by the normal of the plane through the nearest samples, where these are nearly
 *  in a plane and the axis is far from its normal. The new axes have arbitrary signs.
 *  v  with its planes, which change.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. Does not depend on the number of threads. */
brio_status brio_mend_rim_axes(brio_context *ctx, brio_pole_vectors *v);

#endif
