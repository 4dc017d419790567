/* Numbers on a grid in space, whose axes may be skewed: maps of densities. */
#ifndef BRIO_ISO_VOLUME_H
#define BRIO_ISO_VOLUME_H

#include "base/memory.h"

typedef struct brio_volume {
    uint32_t size[3];  /* number of values along each axis */
    float *values;     /* finite; the first axis runs fastest */
    double origin[3];  /* position of value (0, 0, 0) */
    double step[3][3]; /* step from a value to the next along each axis; right-handed */
} brio_volume;

void brio_volume_free(brio_context *ctx, brio_volume *volume);

/** Computes mean and standard deviation of the values. */
void brio_volume_statistics(const brio_volume *volume, double *mean, double *deviation);

/** Meshes the surface of the part of a volume whose values are above a level. Flat pieces half a cell inside the
 *  volume's border close the surface. The mesh is closed, manifold and oriented, counterclockwise seen from outside.
 *  resolution  cells along the longest side; 0: one for each step.   Memory: the mesh and two layers of cells.
 *  conforming  Delaunay triangles: brio_conforming_surface.
 *  Returns BRIO_OK (no faces when nothing is above the level), BRIO_ERR_NO_ANSWER (a volume less than two values
 *  wide), BRIO_ERR_ARGUMENT (a resolution above 2^15), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_volume_surface(brio_context *ctx, const brio_volume *volume, double level, size_t resolution,
                                bool conforming, brio_mesh **out);

#endif
