/* brio delaunay --plane: triangles of two coordinates of the points. */
#ifndef BRIO_CLI_PLANE_H
#define BRIO_CLI_PLANE_H

#include "cli/steps/order.h"

/** The planes that --plane can name. The first coordinate of plane p is p, the second the one after it, cyclically. */
enum { PLANE_XY = 0, PLANE_YZ = 1, PLANE_ZX = 2, NO_PLANE = 3 };

extern const option_choice cli_planes[];

/** Triangulates, reports the facts, and writes the triangles over the points of the mesh to -o.
 *  plane  one of the planes.   weights  may be NULL.   verify  checks the result. */
brio_status cli_plane(run *r, int plane, brio_mesh *mesh, const double *weights, const order_options *order,
                      bool verify);

#endif
