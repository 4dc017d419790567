/* What files know of the side from which samples were seen: normals, and places of scanners. */
#ifndef BRIO_RECONSTRUCT_EVIDENCE_H
#define BRIO_RECONSTRUCT_EVIDENCE_H

#include "reconstruct/cocone/cocone_candidates.h"

/** As in brio_labeled_delaunay_options: arrays in the order of the caller's points. */
typedef struct {
    const double *normals;     /* #P by 3, or NULL */
    const double *origins;     /* num_origins by 3, or NULL */
    const uint32_t *origin_of; /* #P, or NULL */
    size_t num_origins;
    const uint32_t *order; /* #P: the caller's index of each sample */
    int exponent;          /* the samples are the caller's points times 2^-exponent */
} brio_evidence;

enum { BRIO_EVIDENCE_NORMALS = 1, BRIO_EVIDENCE_ORIGINS = 2 };

/** Weighs for each sample whether its axis points outwards. Outside is where the normal points, and where the scanner
 *  stands. Evidence whose neighbours contradict each other as often as not weighs nothing.
 *  c     with its candidates.
 *  own   #P, owned by the caller (brio_release): log-odds in units of BRIO_VOTE_UNIT; NULL if no evidence weighs anything.
 *  used  receives the set of kinds that weigh something.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. Does not depend on the number of threads. */
brio_status brio_weigh_evidence(brio_context *ctx, const brio_evidence *e, const brio_cocones *c, float **own,
                                unsigned *used);

#endif
