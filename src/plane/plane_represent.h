/* Representatives of points that are no vertex. */
#ifndef BRIO_PLANE_PLANE_REPRESENT_H
#define BRIO_PLANE_PLANE_REPRESENT_H

#include "plane/plane_store.h"

/** Gives each record that is no vertex the vertex that represents it. Sets the numbers of vertices, duplicates and hidden
 *  points. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_plane_represent(brio_plane_store *store);

#endif
