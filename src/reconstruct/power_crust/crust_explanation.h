/* How a power crust came to be at its samples. */
#ifndef BRIO_RECONSTRUCT_CRUST_EXPLANATION_H
#define BRIO_RECONSTRUCT_CRUST_EXPLANATION_H

#include "reconstruct/power_crust/labeled_poles.h"

/** Fills *options->explanation; does nothing without.
 *  l  with `order` and the poles of the samples.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, and what brio_delaunay returns. */
brio_status brio_explain_crust(brio_labeled_poles *l, const brio_surface_options *options);

#endif
