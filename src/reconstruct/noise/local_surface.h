/* A piece of surface fitted to the neighbourhood of a point. */
#ifndef BRIO_RECONSTRUCT_LOCAL_SURFACE_H
#define BRIO_RECONSTRUCT_LOCAL_SURFACE_H

#include "query/nearest_points.h"

/** The neighbours of a point, in any order, the point included. */
typedef struct {
    size_t count;
    double offset[3][BRIO_MOST_NEAR]; /* neighbour minus point */
    double square[BRIO_MOST_NEAR];    /* squared distance from the point; written by brio_fit_local_surfaces */
    double weight[BRIO_MOST_NEAR];    /* likewise */
} brio_neighbourhood;

/** Adds the neighbour at q to the neighbourhood of p. */
static inline void brio_add_neighbour(brio_neighbourhood *n, const double *p, const double *q) {
    for (int k = 0; k < 3; k++) n->offset[k][n->count] = q[k] - p[k];
    n->count++;
}

/** BATCH: surfaces that are fitted side by side. */
enum { BRIO_SURFACE_COEFFICIENTS = 6, BRIO_SURFACE_BATCH = 4 };

/** The graph of a quadratic polynomial over a plane through the point. */
typedef struct {
    double frame[3][3]; /* two orthonormal directions of the plane, and its normal */
    /* of 1, u, v, u^2, uv, v^2; u, v and the height are in `unit` */
    double coefficient[BRIO_SURFACE_COEFFICIENTS];
    double unit;   /* distance of the farthest neighbour */
    double height; /* of the surface above the point, along the normal, in the unit of the points */
} brio_local_surface;

/** Fits a plane to the neighbours of each of `count` points, and a quadratic height over the plane, both by weighted
 *  least squares. The weights fall to 0 at the farthest neighbour. Where the neighbours do not determine the
 *  polynomial, it is a constant. The bits of a surface do not depend on the other surfaces of the batch.
 *  count   at most BRIO_SURFACE_BATCH.
 *  fitted  #count: false if the neighbours are fewer than 7, on a line, or at one position. */
void brio_fit_local_surfaces(brio_neighbourhood *n, size_t count, brio_local_surface *out, bool *fitted);

/** Moves the point to which a surface was fitted onto the surface, unless the surface is farther away than the
 *  neighbours. */
void brio_move_onto(const brio_local_surface *s, double *point);

/** Returns the weighted standard deviation of the neighbours from the surface that was fitted to them. */
double brio_local_spread(const brio_neighbourhood *n, const brio_local_surface *s);

/** Finds the heights of the neighbours over the best plane through their mean.
 *  n  the weights are overwritten.   height  n->count, written: their sum is 0.   Returns false if they are on a
 *     line. */
bool brio_plane_heights(brio_neighbourhood *n, double *height);

/** Returns the standard deviation of the neighbours from the best plane through their mean, INFINITY if they are on a
 *  line.   n  the weights are overwritten. */
double brio_plane_spread(brio_neighbourhood *n);

#endif
