/* Flat tetrahedra within the surface. */
#ifndef BRIO_RECONSTRUCT_FLAT_TETRAHEDRA_H
#define BRIO_RECONSTRUCT_FLAT_TETRAHEDRA_H

#include "reconstruct/cocone/tetrahedron_labels.h"

/** Changes labels of tetrahedra that no majority of samples decides, where this makes the boundary between the labels
 *  smaller. Each change replaces one diagonal of a quadrilateral by the other one. Only candidates enter the boundary.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_flatten(brio_context *ctx, const brio_tet_labels *labels);

#endif
