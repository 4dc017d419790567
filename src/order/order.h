/* Insertion orders: permutations of the points for the incremental construction. */
#ifndef BRIO_ORDER_ORDER_H
#define BRIO_ORDER_ORDER_H

#include "base/context.h"

/** order[0 .. num_points) = the indices of the #P by 3 points in the order of insertion. Depends on the options and the
 *  points alone. rank  NULL, or receives for each place in the order the point's rank along the curve through all
 *  points. Needs 17 bytes a point of workspace. */
brio_status brio_order_points(brio_context *ctx, const double *points, size_t num_points, const brio_options *options,
                              uint32_t *order, uint32_t *rank);

#endif
