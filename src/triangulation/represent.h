/* Representatives of the points that are no vertices. */
#ifndef BRIO_TRIANGULATION_REPRESENT_H
#define BRIO_TRIANGULATION_REPRESENT_H

#include "triangulation/inserter.h"

/** Gives every point that is no vertex the vertex that represents it. Counts duplicates and hidden points. Call it
 *  after all insertions. */
brio_status brio_represent(brio_inserter *ins);

#endif
