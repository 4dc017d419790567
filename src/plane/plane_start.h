/* The beginning of a triangulation of the plane. */
#ifndef BRIO_PLANE_PLANE_START_H
#define BRIO_PLANE_PLANE_START_H

#include "plane/plane_store.h"

/** Moves up to three records in general position to the front, and sets the store's dimension and filter. Adds an apex
 *  to points on a line. Makes the first triangle and the infinite triangles around it; makes none for dimensions -1 and
 *  0. */
void brio_plane_start(brio_plane_store *store);

/** Writes a record off the line through a and b. */
void brio_plane_place_apex(const double *a, const double *b, double *apex);

#endif
