/* Parts of a mesh. */
#ifndef BRIO_IO_FILTER_H
#define BRIO_IO_FILTER_H

#include "base/context.h"

/** Finds the vertices in a closed box.   box  x0, y0, z0, x1, y1, z1.   stays  #V: receives 1 or 0. */
void brio_find_in_box(const brio_mesh *mesh, const double *box, uint8_t *stays);

/** Removes vertices with their properties, in place, and the polygons, tetrahedra and edges that use them. The rest
 *  keeps
 *  its order.   stays  #V.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_filter_mesh(brio_context *ctx, brio_mesh *mesh, const uint8_t *stays);

#endif
