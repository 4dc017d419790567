/* Handles, tunnels and crumbs that little evidence holds. */
#ifndef BRIO_RECONSTRUCT_WEAK_HANDLES_H
#define BRIO_RECONSTRUCT_WEAK_HANDLES_H

#include "reconstruct/labeled_delaunay/mending.h"

/** Cuts handles, fills tunnels, and drops crumbs and bubbles, if they are small and the energy rises by less than the
 *  price of a handle. The boundary is a manifold after it where it was one before.
 *  removed  receives the number of handles, tunnels, crumbs and bubbles.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
brio_status brio_remove_weak_handles(brio_mending *m, size_t *removed);

#endif
