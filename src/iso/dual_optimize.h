/* Moves the vertices of an iso-surface so that sharp edges and corners of the function appear. */
#ifndef BRIO_ISO_DUAL_OPTIMIZE_H
#define BRIO_ISO_DUAL_OPTIMIZE_H

#include "iso/iso_surface.h"

/** Moves the vertices of a closed triangle mesh of the function's zero set, in place; the triangles stay. Vertices move
 *  along the surface to even places, and onto the sharp edges and corners that their triangles' tangent planes meet in.
 *  A move that would turn a triangle over is not made.
 *  grid    gives the function and the cell, which bounds the moves.   rounds  2 or 3 suffice.
 *  Cost: about 8 values of the function a triangle and round.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_dual_optimize(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh *mesh, int rounds);

#endif
