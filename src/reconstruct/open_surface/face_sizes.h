/* How large the triangles of a surface are, and how large they should be. */
#ifndef BRIO_RECONSTRUCT_FACE_SIZES_H
#define BRIO_RECONSTRUCT_FACE_SIZES_H

#include "reconstruct/open_surface/triangle_net.h"

/** Measures triangles.
 *  radius  #F, written: of the circle of each triangle; INFINITY if its corners are collinear.
 *  usual   #F, written: the radius of the circles round it, where samples are not missing.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_face_sizes(const brio_triangle_net *n, double *radius, double *usual);

#endif
