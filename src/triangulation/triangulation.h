/* The result behind the public handle. */
#ifndef BRIO_TRIANGULATION_TRIANGULATION_H
#define BRIO_TRIANGULATION_TRIANGULATION_H

#include "triangulation/tetrahedra.h"

struct brio_triangulation {
    brio_context *ctx;
    brio_tetrahedron *tet;    /* finite ones first; vertices are the caller's indices or BRIO_INFINITE */
    uint32_t *representative; /* of each point of the caller */
    brio_delaunay_stats stats;
    brio_round *round; /* NULL when nothing was recorded */
    size_t num_rounds;
};

/** A private copy of the caller's points as records, -0 made 0; BRIO_ERR_NOT_FINITE names the first bad one.
 *  order  NULL for the caller's own; `room` further records are left free at the end. */
brio_status brio_records_new(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                             const uint32_t *order, size_t room, brio_record **out);

#endif
