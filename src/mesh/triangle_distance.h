/* The distance of a triangle from a surface. */
#ifndef BRIO_MESH_TRIANGLE_DISTANCE_H
#define BRIO_MESH_TRIANGLE_DISTANCE_H

#include "mesh/closest_point.h"

/** Finds the least distance between a triangle and the triangles of a tree. Returns its square, and writes the point of
 *  the triangle where it is taken; returns INFINITY, and writes nothing, if it is not below `bound`.
 *  corners  of the triangle, which may be degenerate.   bound  square of a distance. */
double brio_triangle_distance(const brio_triangle_tree *tree, const double *const corners[3], double bound, double *at);

#endif
