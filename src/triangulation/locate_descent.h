/* Point location by descent to the nearest vertex. */
#ifndef BRIO_TRIANGULATION_LOCATE_DESCENT_H
#define BRIO_TRIANGULATION_LOCATE_DESCENT_H

#include "triangulation/inserter.h"

/** *tet = a tetrahedron in conflict with p near the last insertion, or what a walk gives; BRIO_NO_TET where the walk
 *  leads out of the zone. */
brio_status brio_locate_descent(brio_inserter *ins, const double *p, uint32_t *tet);

#endif
