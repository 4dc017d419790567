/* The inside of a closed mesh. */
#ifndef BRIO_MESH_SOLID_H
#define BRIO_MESH_SOLID_H

#include "mesh/closest_point.h"

typedef struct brio_solid {
    brio_triangle_tree tree;
} brio_solid;

/** Prepares a mesh, which outlives the solid.   out  freed, also after a failure, with brio_solid_free.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (indices out of range, no faces), BRIO_ERR_NO_ANSWER (the faces bound nothing:
 *  vertices at one position counting as one, some edge is not run along as often in one direction as in the other),
 *  BRIO_ERR_NO_MEMORY. */
brio_status brio_solid_new(brio_context *ctx, const brio_mesh *mesh, brio_solid *out);

void brio_solid_free(brio_context *ctx, brio_solid *solid);

/** How often the surface winds round a point: 1 inside of a surface whose faces are seen counterclockwise from outside,
 *  -1 where they are seen clockwise, 0 outside. Exact for every point that is not on the surface. */
int brio_winding_number(const brio_solid *solid, const double *point);

#endif
