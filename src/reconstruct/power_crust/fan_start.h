/* The corner from which a face of the crust is cut into a fan of triangles. */
#ifndef BRIO_RECONSTRUCT_FAN_START_H
#define BRIO_RECONSTRUCT_FAN_START_H

#include <stddef.h>
#include <stdint.h>

/** Turns the list of a polygon's corners so that the fan of triangles from the first corner follows the polygon's
 *  plane.
 *  vertices  #V by 3.   corner  #size: indices of vertices.
 *  normal    of the polygon's plane, of any length, on the side from which the corners are counterclockwise. */
void brio_turn_to_fan_start(const double *vertices, uint32_t *corner, size_t size, const double normal[3]);

#endif
