/* What files know of the side from which samples were seen: normals, and places of scanners. */
#ifndef BRIO_RECONSTRUCT_SAMPLE_EVIDENCE_H
#define BRIO_RECONSTRUCT_SAMPLE_EVIDENCE_H

#include "reconstruct/cocone/cocone_candidates.h"

/** Evidence of the caller's points, and which of them the samples are. */
typedef struct {
    brio_evidence given;
    const uint32_t *order; /* #P: the caller's index of each sample */
    int exponent;          /* the samples are the caller's points times 2^-exponent */
} brio_sample_evidence;

/** Takes the caller's evidence.   given  NULL: none.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (its size, or places without a number). */
brio_status brio_take_evidence(brio_context *ctx, const brio_evidence *given, size_t num_points,
                               brio_sample_evidence *out);

/** Weighs for each sample whether its axis points outwards. Outside is where the normal points, and where the scanner
 *  stands. Evidence whose neighbours contradict each other as often as not weighs nothing, nor do normals that
 *  contradict the places of the scanners as often as not.
 *  c     with its candidates.
 *  own   #P, owned by the caller (brio_release): log-odds; NULL if no evidence weighs anything.
 *  used  receives the set of kinds that weigh something, as in brio_surface_stats.evidence.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. Does not depend on the number of threads. */
brio_status brio_weigh_evidence(brio_context *ctx, const brio_sample_evidence *e, const brio_cocones *c, float **own,
                                unsigned *used);

/** Orients samples by their evidence, where there is any: the sign of each axis is then what its own evidence says.
 *  turned  #P, read and written: as brio_orient_samples finds it.
 *  own, used  as above. */
brio_status brio_orient_by_evidence(brio_context *ctx, const brio_sample_evidence *e, const brio_cocones *c,
                                    uint8_t *turned, float **own, unsigned *used);

/** Writes the place of the scanner that saw sample p, scaled as the samples are. Returns whether it is known; it need
 *  not be finite. */
bool brio_scanner_place(const brio_sample_evidence *e, size_t p, double place[3]);

/** Finds the directions from the samples to their scanners.
 *  points  #P by 3: the samples.
 *  out     #P, owned by the caller (brio_release): unit vectors, zero where no place is known.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_scanner_directions(brio_context *ctx, const brio_sample_evidence *e, const double *points,
                                    size_t num_points, float (**out)[3]);

/** Returns the share of what evidence tells of samples that is so in the result.
 *  kinds    the set of kinds that count.
 *  outside  of each sample: the direction to the outside; of any length, 0 where it has none.
 *  told     receives the number of samples of which the evidence tells anything. */
double brio_evidence_agreement(const brio_sample_evidence *e, unsigned kinds, const double *points,
                               const float (*outside)[3], size_t num_points, size_t *told);

#endif
