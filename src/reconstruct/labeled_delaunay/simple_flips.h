/* Flips that only deform the boundary of labels. */
#ifndef BRIO_RECONSTRUCT_SIMPLE_FLIPS_H
#define BRIO_RECONSTRUCT_SIMPLE_FLIPS_H

#include "reconstruct/labeled_delaunay/mending.h"

enum { BRIO_MOST_SIMPLE = 256 };

/** Looks for an order in which tetrahedra of one label can be flipped so that each flip only deforms the boundary: its
 *  Euler characteristic stays, and no sample becomes singular. Returns whether it found one; that it found none proves
 *  nothing. Labels and counts are as before the call.
 *  tet  finite, at most BRIO_MOST_SIMPLE. */
bool brio_flips_deform(brio_mending *m, const uint32_t *tet, size_t count);

#endif
