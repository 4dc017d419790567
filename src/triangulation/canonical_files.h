/* The canonical order of tetrahedra in scratch files. */
#ifndef BRIO_TRIANGULATION_CANONICAL_FILES_H
#define BRIO_TRIANGULATION_CANONICAL_FILES_H

#include "triangulation/store.h"

/** Does what brio_canonical_order does, by files that are read and written in sequence. */
brio_status brio_canonical_files(brio_store *store, size_t live, size_t *finite);

#endif
