/* Insertion by several threads. */
#ifndef BRIO_TRIANGULATION_PARALLEL_H
#define BRIO_TRIANGULATION_PARALLEL_H

#include "triangulation/inserter.h"

/** Inserts the records [begin, end), which follow the curve, by all threads of the context. The store has ranks; `ins`
 *  works alone before and after, and locates by walks. */
brio_status brio_insert_parallel(brio_inserter *ins, size_t begin, size_t end);

#endif
