/* An experiment's part in a triangulation of space: another strategy of point location, and somebody who watches. */
#ifndef BRIO_TRIANGULATION_INSERTION_PART_H
#define BRIO_TRIANGULATION_INSERTION_PART_H

#include "base/experiment.h"
#include "order/rounds.h"
#include "triangulation/inserter.h"

struct brio_insertion_part {
    void *user;                    /* of the functions, and of the strategy */
    const brio_strategy *strategy; /* of point location */
    bool walks;                    /* it walks from the point inserted last, as without an experiment */
    bool alone;                    /* one thread inserts */
    /** Before anything else of a call of brio_delaunay or its estimate. */
    brio_status (*begin)(void *user, brio_context *ctx, size_t num_points);
    /** Once the first tetrahedron stands, before the strategy starts.   since  the time when insertion began. */
    void (*start)(void *user, brio_inserter *ins, const brio_delaunay_options *options, const brio_round_ends *rounds,
                  double since);
    /** Returns the number of points after which `note` is wanted next, when `inserted` points are in; it may exceed the
     *  number of points. */
    size_t (*next)(const void *user, size_t inserted);
    /** When `inserted` points are in: there, at times of the engine's own, and at the end. */
    brio_status (*note)(void *user, const brio_inserter *ins, size_t inserted);
    /** Returns the bytes that the strategy takes beyond the walk's. */
    double (*bytes)(const void *user, double points);
};

#endif
