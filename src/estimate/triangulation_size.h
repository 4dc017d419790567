/* How large the triangulation of many points will be, estimated from few of them. */
#ifndef BRIO_ESTIMATE_TRIANGULATION_SIZE_H
#define BRIO_ESTIMATE_TRIANGULATION_SIZE_H

#include "base/context.h"

typedef struct {
    double tetrahedra; /* infinite ones included */
    double hidden;     /* points without a cell */
} brio_triangulation_size;

/** Estimates the size of the Delaunay triangulation of finite points or, with weights, of the regular triangulation.
 *  Triangulates up to 4,096 points, or the surroundings of twelve points if there are more tetrahedra or points.
 *  points  #P by 3.   weights  #P, or NULL.
 *  Cost: about 20,000 insertions and fifty passes over the points; one megabyte.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_estimate_size(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                               brio_triangulation_size *size);

#endif
