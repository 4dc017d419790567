/* The points of a finished triangulation of the plane, taken from the caller again. */
#ifndef BRIO_PLANE_PLANE_POINTS_H
#define BRIO_PLANE_PLANE_POINTS_H

#include "plane/plane_input.h"
#include "plane/triangulation2.h"

/** Copies the points of a triangulation as records, in the caller's order. They must be its points: with others, walks
 *  might not end. The arrays may change meanwhile; what counts is the copy.
 *  record  owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (other points; points in space), BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY. */
brio_status brio_plane_take_points(brio_context *ctx, const brio_triangulation2 *t, brio_plane_input *given,
                                   brio_plane_record **record);

#endif
