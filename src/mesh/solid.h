/* The inside of a closed mesh. */
#ifndef BRIO_MESH_SOLID_H
#define BRIO_MESH_SOLID_H

#include "mesh/closest_point.h"

typedef struct brio_solid {
    brio_triangle_tree tree;
} brio_solid;

/** Prepares a mesh, which outlives the solid.   out  freed with brio_solid_free, also after a failure.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (indices out of range, no faces), BRIO_ERR_NO_ANSWER (the faces bound no solid:
 *  with vertices at one position counted as one, some edge has more half-edges in one direction than in the opposite
 *  one), BRIO_ERR_NO_MEMORY. */
brio_status brio_solid_new(brio_context *ctx, const brio_mesh *mesh, brio_solid *out);

void brio_solid_free(brio_context *ctx, brio_solid *solid);

/** Returns how often the surface winds round a point: 1 inside a surface whose faces are counterclockwise seen from
 *  outside, -1 inside a surface whose faces are clockwise, 0 outside. Exact for every point that is not on the
 *  surface. */
int brio_winding_number(const brio_solid *solid, const double *point);

#endif
