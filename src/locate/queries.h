/* Many queries at once: sorted along a Hilbert curve, divided among threads. */
#ifndef BRIO_LOCATE_QUERIES_H
#define BRIO_LOCATE_QUERIES_H

#include "locate/locator.h"

/** What one thread carries from a query to the next, which is usually near. Answers do not depend on it. */
typedef struct {
    const brio_locator *l;
    int thread;
    brio_filter filter;
    brio_walk walk;   /* walk.start: where the next walk starts; BRIO_NO_TET: at a vertex near the query */
    bool near;        /* the next query is usually near the last one */
    uint32_t nearest; /* the last place found, or BRIO_INFINITE */
} brio_querent;

/** Answers query i, at x (three coordinates and a 0).   user  of the batch.   Returns BRIO_OK or an error. */
typedef brio_status (*brio_answer_fn)(void *user, brio_querent *q, size_t i, const double *x);

typedef struct {
    const brio_locator *l;
    const double *queries; /* #Q by 3 */
    size_t count;
    const char *stage; /* for the progress */
    brio_answer_fn answer;
    void *user;
} brio_query_batch;

/** Returns the number of threads for this many queries: brio_answer_all uses thread numbers below it. */
int brio_query_threads(brio_context *ctx, size_t count);

/** Calls `answer` for every query, once, in any order and from several threads.
 *  threads  what brio_query_threads returned.   Needs 16 bytes of workspace a query, for 2^20 queries at most.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE (before any call), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, and what `answer`
 *  returns. */
brio_status brio_answer_all(brio_context *ctx, int threads, const brio_query_batch *batch);

#endif
