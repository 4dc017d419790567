/* Labels of poles from a known surface. */
#ifndef BRIO_RECONSTRUCT_LABEL_SOLID_H
#define BRIO_RECONSTRUCT_LABEL_SOLID_H

#include "reconstruct/labels/labeling.h"

/** Labels a pole inner if a closed mesh winds round its centre, otherwise outer. The decision is exact.
 *  exponent  A coordinate of a pole times 2^exponent is in the unit of the mesh.
 *  label     #poles, written.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (the mesh is not closed), BRIO_ERR_ARGUMENT (an index out of range),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_label_by_solid(brio_context *ctx, const brio_poles *poles, int exponent, const brio_mesh *solid,
                                uint8_t *label);

#endif
