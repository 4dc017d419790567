/* The predicate of the count of self-intersections. */
#ifndef BRIO_MESH_TRIANGLES_CROSS_H
#define BRIO_MESH_TRIANGLES_CROSS_H

#include "base/context.h"

/** Returns whether two triangles meet in more than the corners and the edge that they share; exact. Corners are shared
 *  when their positions are equal. Overlapping triangles in one plane cross. Triangles without area cross nothing. */
bool brio_triangles_cross(const double *const t[3], const double *const u[3]);

#endif
