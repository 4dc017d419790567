/* Less noise in the vertices of a surface. */
#ifndef BRIO_RECONSTRUCT_SMOOTH_SURFACE_H
#define BRIO_RECONSTRUCT_SMOOTH_SURFACE_H

#include "base/context.h"

/** Moves every vertex of a triangulated surface, twice, onto a quadratic surface through the middle of the vertices
 *  that are nearest to it along edges and look the same way. So the two sides of a thin wall do not mix, and no
 *  triangle looks the other way afterwards. Vertices of edges of one face stay. Faces may cross each other
 *  afterwards: brio_back_off.
 *  points  #P by 3, read and written; points that are no vertices stay.   faces  #F by 3.
 *  Cost: 250 bytes a vertex.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_smooth_surface(brio_context *ctx, double *points, size_t num_points, const uint32_t *faces,
                                size_t num_faces);

#endif
