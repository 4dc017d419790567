/* Axes of samples at the rims of open sheets. */
#ifndef BRIO_RECONSTRUCT_RIM_AXES_H
#define BRIO_RECONSTRUCT_RIM_AXES_H

#include "dual/pole_vectors.h"

/** Replaces the axes of samples on the hull whose hull facets look in opposite directions, as at the rim of a sheet: there
 *  the sum of the normals is next to nothing, and its direction an accident. The new axis is the line to which the normals
 *  are nearest. Its sign tells nothing.
 *  v  with its planes, which change.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. Does not depend on the number of threads. */
brio_status brio_mend_rim_axes(brio_context *ctx, brio_pole_vectors *v);

#endif
