/* Cells clipped to the region, as polyhedra relative to their sites. */
#ifndef BRIO_CELLS_CLIP_H
#define BRIO_CELLS_CLIP_H

#include "cells/star_cell.h"

/** Makes the polyhedron of a cell in the region. Neighbours of its faces are indices of points, or -1 - i for wall i of
 *  the region. Named vertices are Voronoi vertices: their name is the tetrahedron that speaks for the centre.
 *  c  filled; its place is not BRIO_PLACE_INSIDE.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_clip_cell(brio_star_cell *c, const brio_region *region, brio_polyhedron *p);

#endif
