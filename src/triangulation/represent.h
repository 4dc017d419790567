/* Representatives of the points that are no vertices. */
#ifndef BRIO_TRIANGULATION_REPRESENT_H
#define BRIO_TRIANGULATION_REPRESENT_H

#include "triangulation/inserter.h"

/** Gives every point that is no vertex the vertex that represents it. Counts duplicates and hidden points. Call it
 *  after all insertions.
 *  leaves_hidden  Hidden points and their duplicates receive BRIO_INFINITE instead. */
brio_status brio_represent(brio_inserter *ins, bool leaves_hidden);

#endif
