/* The zero set of a function as a closed triangle mesh. */
#ifndef BRIO_SURFACE_ISO_SURFACE_H
#define BRIO_SURFACE_ISO_SURFACE_H

#include "base/memory.h"

/** A function of space, negative inside; 0 counts as outside. Called from several threads at once. */
typedef double (*brio_implicit_fn)(const double *p, const void *user);

/** A function on a grid of cubes. The function is continuous, and not negative on the border of the grid. */
typedef struct brio_implicit_grid {
    brio_implicit_fn value;
    const void *user;
    double low[3];     /* the corner of least coordinates */
    double cell;       /* side of a cube */
    uint32_t cells[3]; /* number of cubes along each axis, at least 1 */
} brio_implicit_grid;

/** Meshes the zero set. The mesh is closed, manifold and oriented, and seen counterclockwise from outside; it has no
 *  faces when no node of the grid is inside. Memory: the mesh and two layers of nodes.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (negative on the border), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
brio_status brio_iso_surface(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh **out);

#endif
