/* Centres of circles in the plane, as centres of spheres.
 *
 * Let a, b, c be points of the plane z = 0 and d the point a raised by a height h. The points of equal (power) distance
 * from a, b and c are a line along z through the centre of their circle. The centre of the sphere through a, b, c and d
 * is on that line, so its first two coordinates are the centre of the circle. */
#ifndef BRIO_PLANE_PLANE_CENTRE_H
#define BRIO_PLANE_PLANE_CENTRE_H

#include "predicates/circumcentre.h"

/** Triangles whose centres are to be computed. */
typedef struct {
    double point[4 * BRIO_CENTRE_BATCH][3], weight[4 * BRIO_CENTRE_BATCH];
    uint32_t vertex[BRIO_CENTRE_BATCH][4];
    size_t count;
} brio_plane_circles;

/** Adds the triangle of three records: u, v, any number, weight. The batch is not full. */
void brio_plane_circles_add(brio_plane_circles *b, const double *p, const double *q, const double *r);

/** Computes the centres and empties the batch. The error is at most 2^-44 of the centre's distance from the points,
 *  plus the rounding to doubles; a centre that doubles cannot hold has NaN first.   centre  #count by 3; the third
 *  number is of no use. */
void brio_plane_circles_solve(brio_plane_circles *b, bool weighted, double (*centre)[3]);

#endif
