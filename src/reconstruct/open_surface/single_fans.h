/* One fan of triangles at each sample. */
#ifndef BRIO_RECONSTRUCT_SINGLE_FANS_H
#define BRIO_RECONSTRUCT_SINGLE_FANS_H

#include "reconstruct/open_surface/hole_cut.h"

/** Lets triangles go until those that stay make one fan at each sample: a part of a manifold is then a manifold
 *  with boundary.
 *  part  #F, read and written: a brio_triangle_part.
 *  The result does not depend on the order of the faces. Among fans of one length at a sample, the numbers of the
 *  samples decide.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_keep_single_fans(const brio_triangle_net *n, uint8_t *part);

#endif
