/* A trial: one triangulation of an experiment. What its strategies are told, what they count, and the records of it. */
#ifndef BRIO_LABORATORY_TRIAL_H
#define BRIO_LABORATORY_TRIAL_H

#include "brio/laboratory.h"
#include "laboratory/location/page_touches.h"
#include "triangulation/insertion_part.h"

typedef struct {
    brio_context *ctx;
    const brio_laboratory_options *options;
    uint64_t seed; /* of the triangulation */
    brio_laboratory_stats stats;
    /* page touches */
    brio_page_touches *touches; /* NULL: none are counted */
    brio_touch_view view;       /* of the inserter of all points */
    uint64_t cache_faults[BRIO_TOUCH_CACHES];
    /* rounds */
    brio_round_ends rounds;
    double start; /* time when insertion began */
    brio_round *list;
    size_t count, capacity;
} brio_trial;

/** Returns the trial that an inserter works for. */
static inline brio_trial *brio_trial_of(const brio_inserter *ins) {
    return BRIO_PART(ins->store->ctx, insertion)->user;
}

/** Writes the part of an experiment that makes trials. It keeps the trial. */
void brio_trial_part(brio_trial *trial, struct brio_insertion_part *part);

/** Forgets the records of the last triangulation. */
void brio_trial_clear(brio_trial *trial);

/** Returns the number of points after which the next entry is due, when `inserted` points are in. The result may
 *  exceed the number of points. */
size_t brio_trial_next(const void *trial, size_t inserted);

/** Strategies of location: a file locate_*.c each, and history.c. */
extern const brio_strategy brio_strategy_counted_walk, brio_strategy_jump, brio_strategy_hierarchy,
    brio_strategy_history, brio_strategy_trace, brio_strategy_neighbour;

#endif
