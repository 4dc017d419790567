/* Regions of tetrahedra of one label that are too small to be more than a guess, inside and at the hull. */
#ifndef BRIO_RECONSTRUCT_SMALL_REGIONS_H
#define BRIO_RECONSTRUCT_SMALL_REGIONS_H

#include "dual/pole_vectors.h"

/** Gives the other label to every region of tetrahedra, connected across facets, whose boundary has fewer than `least`
 *  facets, unless it holds an infinite tetrahedron. Regions are judged as they are before the call.
 *  least    at most 2^15.
 *  label    #T, read and written: inner or outer; infinite tetrahedra are outer.
 *  changed  receives the number of regions.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_drop_small_regions(brio_context *ctx, const brio_tetrahedra *t, size_t least, uint8_t *label,
                                    size_t *changed);

/** Returns how many facets part two labels. */
size_t brio_count_boundary(const brio_context *ctx, const brio_tetrahedra *t, const uint8_t *label);

/** Gives infinite tetrahedra of one label that hang together the other one, where their hull facets have under a
 *  hundredth of the hull's area: space beyond the hull does not change sides at a speck.
 *  label  #T, read and written.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_drop_hull_patches(brio_context *ctx, const brio_pole_vectors *v, uint8_t *label);

#endif
