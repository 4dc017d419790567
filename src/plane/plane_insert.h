/* Incremental insertion into a triangulation of the plane. */
#ifndef BRIO_PLANE_PLANE_INSERT_H
#define BRIO_PLANE_PLANE_INSERT_H

#include "plane/plane_store.h"

/** Inserts the records [begin, end), which come next in the order. A record that becomes no vertex has a representative
 *  afterwards: one at its place, or any vertex. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_plane_insert(brio_plane_store *store, size_t begin, size_t end);

#endif
