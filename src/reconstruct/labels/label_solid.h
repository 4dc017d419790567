/* Labels of poles from a known surface. */
#ifndef BRIO_RECONSTRUCT_LABEL_SOLID_H
#define BRIO_RECONSTRUCT_LABEL_SOLID_H

#include "reconstruct/labels/labeling.h"

/** label[p]: inner for the poles whose centres a closed mesh winds round, outer for the others.
 *  exponent  the poles are in the unit of the mesh times 2^-exponent.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (a mesh that is not closed), BRIO_ERR_ARGUMENT (indices out of range),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_label_by_solid(brio_context *ctx, const brio_poles *poles, int exponent, const brio_mesh *solid,
                                uint8_t *label);

#endif
