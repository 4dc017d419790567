/* The power crust of labeled poles. */
#ifndef BRIO_RECONSTRUCT_POWER_CRUST_H
#define BRIO_RECONSTRUCT_POWER_CRUST_H

#include "reconstruct/power_crust/labeled_poles.h"

/** Writes the power crust of the poles into an empty mesh, in the unit of the points. Every hull vertex of l->power
 *  must be outer.
 *  l        `open` and `simplify` need l->spacing; normals need l->representative, l->order and the poles of the
 *           samples.
 *  normals  #P by 3, written, or NULL.
 *  stats    receives left_out and the seconds; other fields stay unchanged.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (no pole with a cell is inner, or every face spans a hole), BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
brio_status brio_make_crust(brio_labeled_poles *l, const brio_surface_options *o, brio_mesh *mesh, double *normals,
                            brio_surface_stats *stats);

/** Copies what was counted of poles and of their samples. */
void brio_give_pole_stats(const brio_labeled_poles *l, brio_surface_stats *stats);

#endif
