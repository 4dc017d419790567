/* The result behind the public handle. */
#ifndef BRIO_TRIANGULATION_TRIANGULATION_H
#define BRIO_TRIANGULATION_TRIANGULATION_H

#include "triangulation/page_touches.h"

struct brio_triangulation {
    brio_context *ctx;
    brio_tetrahedron *tet;    /* finite ones first; vertices are the caller's indices or BRIO_INFINITE */
    uint32_t *representative; /* of each point of the caller */
    bool leaves_hidden;       /* hidden points and their duplicates have BRIO_INFINITE for a representative */
    brio_delaunay_stats stats;
    uint64_t points_hash; /* base/points_hash.h */
    brio_round *round;    /* NULL when nothing was recorded */
    size_t num_rounds;
    uint64_t cache_faults[BRIO_TOUCH_CACHES]; /* in caches of 2^0, 2^1, ... pages, where touches were counted */
    size_t num_caches;
};

/** Checks the options of brio_delaunay for num_points points.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_TOO_LARGE (the edges). */
brio_status brio_delaunay_check_options(brio_context *ctx, size_t num_points, const brio_delaunay_options *options);

#endif
