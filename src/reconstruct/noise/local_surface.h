/* A piece of surface fitted to the neighbourhood of a point. */
#ifndef BRIO_RECONSTRUCT_LOCAL_SURFACE_H
#define BRIO_RECONSTRUCT_LOCAL_SURFACE_H

#include "query/nearest_points.h"

/** The neighbours of a point, in any order, the point included. */
typedef struct {
    size_t count;
    double offset[3][BRIO_MOST_NEAR]; /* neighbour minus point */
    double square[BRIO_MOST_NEAR];    /* squared distance from the point */
    double weight[BRIO_MOST_NEAR];    /* written by brio_fit_local_surface */
} brio_neighbourhood;

/** Adds the neighbour at q to the neighbourhood of p. */
static inline void brio_add_neighbour(brio_neighbourhood *n, const double *p, const double *q) {
    double x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
    n->offset[0][n->count] = x, n->offset[1][n->count] = y, n->offset[2][n->count] = z;
    n->square[n->count++] = x * x + y * y + z * z;
}

enum { BRIO_SURFACE_COEFFICIENTS = 6 };

/** The graph of a quadratic polynomial over a plane through the point. */
typedef struct {
    double frame[3][3]; /* two orthonormal directions of the plane, and its normal */
    /* of 1, u, v, u^2, uv, v^2; u, v and the height are in `unit` */
    double coefficient[BRIO_SURFACE_COEFFICIENTS];
    double unit;   /* distance of the farthest neighbour */
    double height; /* of the surface above the point, along the normal, in the unit of the points */
} brio_local_surface;

/** Fits a plane to the neighbours, and a quadratic height over the plane, both by weighted least squares. The weights
 *  fall to 0 at the farthest neighbour. Where the neighbours do not determine the polynomial, it is a constant.
 *  Returns false if the neighbours are fewer than 7, on a line, or at one position. */
bool brio_fit_local_surface(brio_neighbourhood *n, brio_local_surface *out);

/** Returns the weighted standard deviation of the neighbours from the surface that was fitted to them. */
double brio_local_spread(const brio_neighbourhood *n, const brio_local_surface *s);

/** Returns the standard deviation of the neighbours from the best plane through their mean, INFINITY if they are on a
 *  line.   n  the weights are overwritten. */
double brio_plane_spread(brio_neighbourhood *n);

#endif
