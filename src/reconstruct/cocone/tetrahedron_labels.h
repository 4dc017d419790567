/* Delaunay tetrahedra inside and outside of the surface that the co-cones suggest. */
#ifndef BRIO_RECONSTRUCT_TETRAHEDRON_LABELS_H
#define BRIO_RECONSTRUCT_TETRAHEDRON_LABELS_H

#include "reconstruct/cocone/cocone_candidates.h"
#include "reconstruct/labels/label.h"

/** Tetrahedra with a brio_label each, which samples can be held against. */
typedef struct {
    const brio_cocones *cocones;
    const uint8_t *turned; /* #P, from brio_orient_samples */
    bool watertight;       /* infinite tetrahedra are outer */
    uint8_t *label;        /* #T */
    uint32_t *undecided;   /* the tetrahedra that the samples have no majority for, ascending */
    size_t num_undecided;
} brio_tet_labels;

/** Labels the tetrahedra that the samples have a majority for, the first three fields of *l being set; the others have
 *  BRIO_LABEL_NONE. The arrays are to be freed (brio_tet_labels_free) on failure too. */
brio_status brio_tet_labels_vote(brio_context *ctx, brio_tet_labels *l);

/** Labels the others. */
brio_status brio_tet_labels_spread(brio_context *ctx, brio_tet_labels *l);

void brio_tet_labels_free(brio_context *ctx, brio_tet_labels *l);

/** How many of its samples see a tetrahedron outside, less those that see it inside. */
int brio_tet_vote(const brio_tet_labels *l, size_t tet);

#endif
