/* Insertion orders: permutations of the points for the incremental construction. */
#ifndef BRIO_ORDER_ORDER_H
#define BRIO_ORDER_ORDER_H

#include "order/rounds.h"

/** order[0 .. num_points) = the indices of the #P by 3 points in the order of insertion. Depends on the options and the
 *  points alone.
 *  rank    NULL, or receives for each place in the order the point's rank in the order of the curve, or of the blocks,
 *          through all points; it rises inside a round. Only where brio_order_has_ranks.
 *  rounds  NULL, or receives where the rounds end.
 *  Workspace, bytes a point: brio, hilbert and random 16, brio-octree 5, octree 4, brio-kdtree 20, input none. */
brio_status brio_order_points(brio_context *ctx, const double *points, size_t num_points,
                              const brio_delaunay_options *options, uint32_t *order, uint32_t *rank,
                              brio_round_ends *rounds);

/** Whether the order follows a path through space. */
bool brio_order_has_ranks(brio_order order);

#endif
