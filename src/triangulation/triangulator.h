/* Who triangulates: what a context has its triangulations made by, where one process in one memory is not to do it. */
#ifndef BRIO_TRIANGULATION_TRIANGULATOR_H
#define BRIO_TRIANGULATION_TRIANGULATOR_H

#include "base/context.h"

/** A context has at most one, for the time of a call. */
struct brio_triangulator {
    void *user;
    /** Makes what brio_delaunay makes of points without weights. What its statistics say of the way there may differ.
     *  points  num_points by 3, finite.   Returns what brio_delaunay returns. */
    brio_status (*make)(void *user, brio_context *ctx, const double *points, size_t num_points,
                        brio_triangulation **out);
};

/** Triangulates points by the context's triangulator, or by brio_delaunay where it has none.
 *  seed  of brio_delaunay.   Returns what brio_delaunay returns. */
brio_status brio_triangulate(brio_context *ctx, const double *points, size_t num_points, uint64_t seed,
                             brio_triangulation **out);

#endif
