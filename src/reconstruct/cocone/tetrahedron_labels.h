/* Labels of Delaunay tetrahedra: inside or outside the surface that the co-cones suggest. */
#ifndef BRIO_RECONSTRUCT_TETRAHEDRON_LABELS_H
#define BRIO_RECONSTRUCT_TETRAHEDRON_LABELS_H

#include "reconstruct/cocone/cocone_candidates.h"
#include "reconstruct/labels/label.h"

/** The label of each tetrahedron, and what the votes of the samples need. */
typedef struct {
    const brio_cocones *cocones;
    const brio_pole_vectors *dual; /* of the cocones */
    const uint8_t *turned;         /* #P, from brio_orient_samples */
    bool watertight;               /* whether infinite tetrahedra are outer whatever the votes */
    uint8_t *label;                /* #T: a brio_label each */
    uint32_t *undecided;           /* the tetrahedra without a majority of votes, ascending */
    size_t num_undecided;
} brio_tet_labels;

/** Labels each tetrahedron by the majority of its samples. Tetrahedra without a majority get BRIO_LABEL_NONE.
 *  labels  The caller sets cocones, dual, turned and watertight, and the rest to 0. Freed with brio_tet_labels_free, on
 *          failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_tet_labels_vote(brio_context *ctx, brio_tet_labels *labels);

/** Labels the tetrahedra that have BRIO_LABEL_NONE. Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_tet_labels_spread(brio_context *ctx, brio_tet_labels *labels);

void brio_tet_labels_free(brio_context *ctx, brio_tet_labels *labels);

/** Returns the number of the tetrahedron's samples that see it outside, minus the number that see it inside. */
int brio_tet_vote(const brio_tet_labels *labels, size_t tet);

#endif
