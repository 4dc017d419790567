/* Small patches of the hull whose labels differ from those round them. */
#ifndef BRIO_RECONSTRUCT_HULL_PATCHES_H
#define BRIO_RECONSTRUCT_HULL_PATCHES_H

#include "dual/pole_vectors.h"
#include "reconstruct/labels/label.h"

/** Gives infinite tetrahedra of one label that hang together the other one, where their hull facets have under a hundredth
 *  of the hull's area: space beyond the hull does not change sides at a speck.
 *  label  #T, read and written.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_drop_hull_patches(brio_context *ctx, const brio_pole_vectors *v, uint8_t *label);

#endif
