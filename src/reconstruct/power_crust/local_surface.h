/* A piece of surface fitted to the points about one of them. */
#ifndef BRIO_RECONSTRUCT_LOCAL_SURFACE_H
#define BRIO_RECONSTRUCT_LOCAL_SURFACE_H

#include "query/nearest_points.h"

/** Points about a point, in any order; the point itself is among them. */
typedef struct {
    size_t count;
    double offset[BRIO_MOST_NEAR][3]; /* from the point */
    double square[BRIO_MOST_NEAR];    /* of the distance */
    double weight[BRIO_MOST_NEAR];    /* set by the fit */
} brio_neighbourhood;

enum { BRIO_SURFACE_COEFFICIENTS = 6 };

/** A quadratic height over a plane through the point. */
typedef struct {
    double frame[3][3]; /* two directions of the plane, its normal */
    double coefficient[BRIO_SURFACE_COEFFICIENTS];
    double unit;   /* of length */
    double height; /* of the surface above the point, along the normal */
} brio_local_surface;

/** Fits a quadratic height over the plane that lies best, in the sense of least squares with weights that fall to 0 at
 *  the farthest point.   False where the points say nothing: fewer than 7, on a line, or at one position. */
bool brio_fit_local_surface(brio_neighbourhood *n, brio_local_surface *out);

/** Standard deviation of the points from the surface that was fitted to them. */
double brio_local_spread(const brio_neighbourhood *n, const brio_local_surface *s);

#endif
