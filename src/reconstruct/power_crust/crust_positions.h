/* Where the vertices of the crust are. */
#ifndef BRIO_RECONSTRUCT_CRUST_POSITIONS_H
#define BRIO_RECONSTRUCT_CRUST_POSITIONS_H

#include "dual/power_diagram.h"

/** Computes the positions of `count` vertices of the power diagram, at most BRIO_CENTRE_BATCH.
 *  pole      #count by 4: the poles whose cells meet in the vertex.
 *  position  #count by 3: the result; its bits depend on the poles and their samples only. */
void brio_crust_positions(const brio_power_diagram *d, const uint32_t (*pole)[4], size_t count, double *position);

#endif
