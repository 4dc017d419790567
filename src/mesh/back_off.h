/* Vertices that have moved go back until their faces cross no others. */
#ifndef BRIO_MESH_BACK_OFF_H
#define BRIO_MESH_BACK_OFF_H

#include "base/context.h"

/** Moves vertices back towards where they were, where faces cross. Each goes half of its way back, a quarter, and then
 *  all of it; vertices of no face that crosses another stay where they are. So no faces cross at the end if none
 *  crossed before the vertices moved. Those that crossed before are where they were.
 *  mesh    triangles; its vertices are read and written.   before  #V by 3: where the vertices were.
 *  moved   NULL, or receives the number of vertices that went back.
 *  Cost: that of brio_mesh_self_intersections, some times over; 100 bytes a face and one a vertex.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_back_off(brio_context *ctx, brio_mesh *mesh, const double *before, size_t *moved);

#endif
