/* Oriented normals of samples. */
#ifndef BRIO_RECONSTRUCT_SAMPLE_NORMALS_H
#define BRIO_RECONSTRUCT_SAMPLE_NORMALS_H

#include "dual/power_diagram.h"
#include "reconstruct/labels/label.h"

/** Computes unit normals of the samples, pointing outwards, from their poles. A sample without poles gets the normal of
 *  the crust at the nearest point. Samples at one position get one normal.
 *  representative  #samples: the sample at the same position that has the poles.
 *  order           #samples: the row of each sample in `normals`.
 *  normals         #samples by 3, written.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_sample_normals(const brio_power_diagram *d, const uint8_t *label, const uint32_t *representative,
                                const uint32_t *order, const brio_mesh *crust, double *normals);

#endif
