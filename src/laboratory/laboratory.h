/* An experiment: its options, the parts that it has in calls of the library, and what it counts. */
#ifndef BRIO_LABORATORY_LABORATORY_H
#define BRIO_LABORATORY_LABORATORY_H

#include "laboratory/location/trial.h"
#include "order/order.h"
#include "reconstruct/cocone/cocone_surface.h"
#include "reconstruct/labels/labeling.h"

struct brio_laboratory {
    brio_context *ctx;
    brio_laboratory_options options;
    brio_trial trial; /* the last triangulation, and all counts */
    /* What the context sees. The parts point to this struct, so that it does not move. */
    struct brio_experiment experiment;
    struct brio_order_part order;
    struct brio_insertion_part insertion;
    struct brio_label_part labels;
    struct brio_extraction_part extraction;
};

/** Spreads labels, as brio_label_part has it, breadth first from all certain poles, or from one sample of the
 *  hull; the poles that are not reached have greedy labels. The graph of the theoretical labeling has edges over
 *  BRIO_DEEP_WEIGHT alone.   user  the experiment. */
brio_status brio_label_naive(void *user, const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);
brio_status brio_label_theoretical(void *user, const brio_pole_graph *g, uint8_t *label, brio_labeling_stats *stats);

/** Extracts, as brio_extraction_part has it: makes faces of all candidates, of those left at no sharp edge, or of
 *  those that a walk on the outside of each component of these meets. A walk's faces are counterclockwise as seen from
 *  outside; others lie either way.   user  the experiment.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_extract_literally(void *user, brio_context *ctx, const brio_cocones *cocones, size_t *pruned,
                                   uint32_t **faces, size_t *num_faces);

#endif
