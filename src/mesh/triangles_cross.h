/* The test under the count of self-intersections. */
#ifndef BRIO_MESH_TRIANGLES_CROSS_H
#define BRIO_MESH_TRIANGLES_CROSS_H

#include "base/context.h"

/** Whether two triangles meet in more than the corners and the edge that they share, exactly. Corners are the same when
 *  their positions are equal. Triangles in one plane that overlap do; triangles without area meet nothing. */
bool brio_triangles_cross(const double *const t[3], const double *const u[3]);

#endif
