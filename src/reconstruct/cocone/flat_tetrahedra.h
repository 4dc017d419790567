/* Flat tetrahedra within the surface. */
#ifndef BRIO_RECONSTRUCT_FLAT_TETRAHEDRA_H
#define BRIO_RECONSTRUCT_FLAT_TETRAHEDRA_H

#include "reconstruct/cocone/tetrahedron_labels.h"

/** Changes the labels of tetrahedra that no majority of samples decides where that makes the boundary between the
 *  labels smaller: one diagonal of a quadrilateral gives way to the other. Only candidates enter the boundary.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_flatten(brio_context *ctx, const brio_tet_labels *l);

#endif
