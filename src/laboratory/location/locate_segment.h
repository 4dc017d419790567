/* A walk along a segment. */
#ifndef BRIO_LABORATORY_LOCATE_SEGMENT_H
#define BRIO_LABORATORY_LOCATE_SEGMENT_H

#include "triangulation/inserter.h"

/** Returns the tetrahedron whose closure holds w. For w strictly outside the hull, returns an infinite tetrahedron
 *  whose facet has w strictly outside. Tetrahedron `tet` has this property for u. Adds the number of tetrahedra
 *  entered to *entered. */
uint32_t brio_locate_segment(brio_inserter *ins, uint32_t tet, const double *u, const double *w, uint64_t *entered);

#endif
