/* The beginning of a triangulation. */
#ifndef BRIO_TRIANGULATION_START_H
#define BRIO_TRIANGULATION_START_H

#include "triangulation/store.h"

/** Finds four points in general position, or the input's dimension when it is below 3, and moves the points found to
 *  the front. Adds apexes off the points' affine hull, so that every input of at least two distinct positions becomes
 *  three-dimensional. Makes the first tetrahedron, in slot 0, and the infinite tetrahedra around it; makes none for
 *  dimensions -1 and 0. Sets the store's dimension and filter. */
brio_status brio_start(brio_store *store);

#endif
