/* Points in a plane, on a line, or at one position, completed to a set of dimension 3. */
#ifndef BRIO_CELLS_FLAT_POINTS_H
#define BRIO_CELLS_FLAT_POINTS_H

#include "base/context.h"

enum { BRIO_MOST_ADDED = 3 };

/** Points of dimension 3. */
typedef struct {
    double *points, *weights; /* num_points + 3 rows; weights NULL without weights */
    size_t added;             /* rows after num_points; the rows beyond them repeat the first point */
} brio_completed_points;

/** Copies the points, and adds points off their affine hull until the dimension is 3.
 *  points, weights  #P by 3; #P, or NULL.   num_points  at least 1.
 *  out  its arrays are owned by the caller (brio_release).
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_complete_flat_points(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                      brio_completed_points *out);

#endif
