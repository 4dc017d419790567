/* Signs of axes that agree along the sheets of a surface. */
#ifndef BRIO_RECONSTRUCT_SHEET_SIGNS_H
#define BRIO_RECONSTRUCT_SHEET_SIGNS_H

#include "dual/pole_vectors.h"

/** What the signs of samples depend on, beside their axes. */
typedef struct {
    const double *spacing; /* #P: of the samples */
    double noise;          /* of the samples, as brio_least_noise finds it */
    const float *told;     /* #P: log-odds that the axis points outwards; NULL: nothing is told */
} brio_sheet_samples;

/** Chooses the sign of each axis, so that neighbours agree. Each piece whose signs depend on each other is turned as is
 *  told of its samples together; where nothing is told, so that most of its samples on the hull look outwards.
 *  v        with its centres and planes.
 *  turned   #P, written: 1 if the outside is opposite to the axis.
 *  alone    #P, written: 1 if no other sample tells anything of this one's sign.
 *  The result does not depend on the number of threads.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_sign_sheets(brio_context *ctx, const brio_pole_vectors *v, const brio_sheet_samples *samples,
                             uint8_t *turned, uint8_t *alone);

#endif
