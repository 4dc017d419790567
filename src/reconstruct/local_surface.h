/* A piece of surface fitted to the points about one of them. */
#ifndef BRIO_RECONSTRUCT_LOCAL_SURFACE_H
#define BRIO_RECONSTRUCT_LOCAL_SURFACE_H

#include "order/nearest_points.h"

enum { BRIO_MOST_NEAR = 64 };

typedef struct {
    double normal[3];
    double height; /* of the surface above the point, along the normal */
    double spread; /* standard deviation of the points from the surface */
} brio_local_surface;

/** Fits a quadratic height over the plane that lies best, in the sense of least squares with weights that fall to 0 at
 *  the last point.   near  by distance, the first one being the point itself; 7 points at least, of which
 *  BRIO_MOST_NEAR at most count.   False where the points say nothing: at a line, or at one position. */
bool brio_fit_local_surface(const brio_near_point *near, size_t count, brio_local_surface *out);

#endif
