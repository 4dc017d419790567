/* Coordinates and weights that are no numbers. */
#ifndef BRIO_BASE_FINITE_H
#define BRIO_BASE_FINITE_H

#include "base/context.h"

/** Refuses points with a coordinate or a weight that is not finite; the message names the first such point and how many
 *  there are.   points  #P by 3.   weights  #P, or NULL.   file  what the points were read from, or NULL.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE. */
brio_status brio_refuse_not_finite(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const char *file);

#endif
