/* A walk along a segment. */
#ifndef BRIO_TRIANGULATION_LOCATE_SEGMENT_H
#define BRIO_TRIANGULATION_LOCATE_SEGMENT_H

#include "triangulation/inserter.h"

/** The tetrahedron whose closure holds w, or, for w strictly outside the hull, an infinite one whose facet w is strictly
 *  outside of. From u, of whose tetrahedron `tet` the same is true; *entered grows by the tetrahedra entered. */
uint32_t brio_locate_segment(brio_inserter *ins, uint32_t tet, const double *u, const double *w, uint64_t *entered);

#endif
