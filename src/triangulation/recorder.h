/* Counters during insertion, for brio_triangulation_rounds. */
#ifndef BRIO_TRIANGULATION_RECORDER_H
#define BRIO_TRIANGULATION_RECORDER_H

#include "order/rounds.h"
#include "triangulation/inserter.h"

typedef struct {
    uint64_t every; /* as brio_delaunay_options.record_every */
    brio_round_ends rounds;
    double start; /* time when insertion began */
    brio_round *list;
    size_t count, capacity;
} brio_recorder;

/** Returns the number of points after which the next entry is due, when `inserted` points are in. The result may
 *  exceed the number of points. */
size_t brio_recorder_next(const brio_recorder *r, size_t inserted);

/** Adds an entry when one is due, or when all points are in. */
brio_status brio_recorder_note(brio_recorder *r, const brio_inserter *ins, size_t inserted);

#endif
