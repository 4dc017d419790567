/* Point location by descent to the nearest vertex. */
#ifndef BRIO_TRIANGULATION_LOCATE_DESCENT_H
#define BRIO_TRIANGULATION_LOCATE_DESCENT_H

#include "triangulation/inserter.h"

/** Sets *tet to a tetrahedron in conflict with p near the last insertion, or to the result of a walk. The result is
 *  BRIO_NO_TET when the walk leaves the zone. */
brio_status brio_locate_descent(brio_inserter *ins, const double *p, uint32_t *tet);

#endif
