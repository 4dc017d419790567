/* The caller's points as records. */
#ifndef BRIO_TRIANGULATION_RECORDS_H
#define BRIO_TRIANGULATION_RECORDS_H

#include "triangulation/tetrahedra.h"

/** A private copy of the caller's points as records, -0 made 0; BRIO_ERR_NOT_FINITE names the first bad one.
 *  order  NULL for the caller's own; `room` further records are left free at the end. */
brio_status brio_records_new(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                             const uint32_t *order, size_t room, brio_record **out);

#endif
