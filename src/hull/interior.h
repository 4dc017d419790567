/* Points that are certainly inside the convex hull, found in two passes over the points. */
#ifndef BRIO_HULL_INTERIOR_H
#define BRIO_HULL_INTERIOR_H

#include "base/context.h"

/** Lists, in ascending order, the points that may be on the convex hull. All others are strictly inside it.
 *  points      #P by 3, finite, fewer than 2^32 - 16.
 *  candidate   receives the list, owned by the caller (brio_release); NULL on failure.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_hull_candidates(brio_context *ctx, const double *points, size_t num_points, uint32_t **candidate,
                                 size_t *num_candidates);

#endif
