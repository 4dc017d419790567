/* Oriented normals of samples. */
#ifndef BRIO_RECONSTRUCT_SAMPLE_NORMALS_H
#define BRIO_RECONSTRUCT_SAMPLE_NORMALS_H

#include "dual/power_diagram.h"
#include "reconstruct/labels/label.h"

/** normals[3 order[s] ..], #samples by 3, of length 1 and pointing outwards. Samples without poles get the normal of the
 *  crust where it is nearest; rows at equal positions the same one.
 *  representative  #samples: for each the sample at its position that has the poles.
 *  order           #samples: the row of each.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_sample_normals(const brio_power_diagram *d, const uint8_t *label, const uint32_t *representative,
                                const uint32_t *order, const brio_mesh *crust, double *normals);

#endif
