/* The insertion of one point, and of many by all threads. */
#ifndef BRIO_TRIANGULATION_INSERT_H
#define BRIO_TRIANGULATION_INSERT_H

#include "triangulation/inserter.h"

/** What became of a record. */
typedef enum {
    BRIO_INSERTED, /* it is a vertex */
    BRIO_ABSORBED, /* a vertex at its position represents it */
    BRIO_HIDDEN,   /* with weights: its cell would be empty; for now a vertex near it represents it */
    BRIO_DEFERRED  /* in a parallel pass: it needs what may be another thread's; nothing has changed */
} brio_insertion;

/** Inserts record p, which is not yet in. *outcome is set with BRIO_OK only. After a failure the store and the inserter
 *  are good for nothing but to be freed. */
brio_status brio_insert(brio_inserter *ins, uint32_t p, brio_insertion *outcome);

/** Inserts the records [begin, end), which follow the curve, by all threads of the context. The store has ranks; `ins`
 *  works alone before and after, and locates by walks. */
brio_status brio_insert_parallel(brio_inserter *ins, size_t begin, size_t end);

#endif
