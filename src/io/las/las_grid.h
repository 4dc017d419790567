/* Scale and offset of the coordinates of a LAS file. */
#ifndef BRIO_IO_LAS_GRID_H
#define BRIO_IO_LAS_GRID_H

#include "base/context.h"

typedef struct brio_las_grid {
    double step[3], origin[3];
} brio_las_grid;

/** Finds, for each axis, a step and an origin from which a reader computes the same doubles. Tries those of the mesh,
 *  powers of 1/10 and powers of 1/2. If none gives all coordinates back, takes the finest power of 10 for which the
 *  whole numbers have 32 bits: coordinates are then rounded to the nearest multiple. */
void brio_las_grid_find(const brio_mesh *mesh, brio_las_grid *grid);

/** Returns the greatest distance between a vertex and the point that a reader computes. */
double brio_las_grid_moved(const brio_las_grid *grid, const brio_mesh *mesh);

/** Returns the whole number that stands for a coordinate. */
int32_t brio_las_grid_number(const brio_las_grid *grid, int axis, double x);

#endif
