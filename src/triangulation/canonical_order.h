/* The canonical order of the tetrahedra. */
#ifndef BRIO_TRIANGULATION_CANONICAL_ORDER_H
#define BRIO_TRIANGULATION_CANONICAL_ORDER_H

#include "triangulation/store.h"

/** Sorts the tetrahedra of a store into their canonical order, *finite finite ones first, and gives their vertices the
 *  caller's names. The last step: afterwards slots [0, live) hold the tetrahedra, and the states are freed.
 *  live  slots that hold a tetrahedron. */
brio_status brio_canonical_order(brio_store *store, size_t live, size_t *finite);

/** Does what brio_canonical_order does, by files that are read and written in sequence. */
brio_status brio_canonical_files(brio_store *store, size_t live, size_t *finite);

#endif
