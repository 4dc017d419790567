/* Experiments: what a laboratory beside the library puts in the place of steps of a call.
 *
 * A context has at most one experiment, for the time of the calls that it is about; without one, which is usual, each
 * step asks once whether there is one. The library has no experiment itself. Each room declares the part that
 * concerns it, with its own types; a part that is NULL leaves the room's step as it is. */
#ifndef BRIO_BASE_EXPERIMENT_H
#define BRIO_BASE_EXPERIMENT_H

#include "base/context.h"

struct brio_experiment {
    const struct brio_order_part *order;           /* order/order.h: the insertion order */
    const struct brio_insertion_part *insertion;   /* triangulation/insertion_part.h: location, and who watches */
    const struct brio_label_part *labels;          /* reconstruct/labels/labeling.h: labels of poles */
    const struct brio_extraction_part *extraction; /* reconstruct/cocone/cocone_surface.h: triangles of candidates */
};

/** Returns a part of the context's experiment, NULL where there is none. */
#define BRIO_PART(ctx, name) ((ctx)->experiment ? (ctx)->experiment->name : NULL)

#endif
