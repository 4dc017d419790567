/* The tetrahedra that hold a query. */
#ifndef BRIO_LOCATE_HOLDER_H
#define BRIO_LOCATE_HOLDER_H

#include "locate/locator.h"

/* --- the order of queries --- */

/* Many queries at once: sorted along a Hilbert curve, divided among threads.
 *
 * A thread answers a row of queries at a time. The queries of a row are far from each other, and each is near the one
 * in its column in the row before. So the walks of a row do not wait for each other's memory. */

/** A row of queries. */
typedef struct {
    size_t count;               /* at most BRIO_ABREAST */
    size_t index[BRIO_ABREAST]; /* the caller's */
    double x[BRIO_ABREAST][4];  /* three coordinates and a 0 */
} brio_query_row;

/** What one thread carries from a row of queries to the next. Answers do not depend on it. */
typedef struct {
    const brio_locator *l;
    int thread;
    brio_filter filter;
    brio_walk walk[BRIO_ABREAST];   /* of a column: start: of the next walk; BRIO_NO_TET: at a vertex near the query */
    uint32_t nearest[BRIO_ABREAST]; /* of a column: the last place found, or BRIO_INFINITE */
    bool near;                      /* the next query of a column is usually near the last one */
} brio_querent;

/** Answers a row of queries.   user  of the batch.   Returns BRIO_OK or an error. */
typedef brio_status (*brio_answer_fn)(void *user, brio_querent *q, const brio_query_row *row);

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

/** Returns BRIO_OK, or BRIO_ERR_NOT_FINITE and names the first query that is not finite.   queries  #Q by 3. */
brio_status brio_refuse_queries(brio_context *ctx, const double *queries, size_t count);

/** Calls `answer` for rows that have every query once, in any order and from several threads.
 *  threads  what brio_query_threads returned.   Needs 16 bytes of workspace a query, for 2^20 queries at most.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE (before any call), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, and what `answer`
 *  returns. */
brio_status brio_answer_all(brio_context *ctx, int threads, const brio_query_batch *batch);

/** A tetrahedron that holds a query, and where in it the query lies. */
typedef struct {
    uint32_t tet; /* a finite tetrahedron whose closure holds the query; BRIO_INFINITE outside the hull */
    unsigned
        zeros; /* bit i: the query is in the plane of the facet opposite to vertex i. One bit: on the facet. Two: on
                       the edge that these facets share. Three: at a vertex. */
} brio_holder;

/** Locates the queries of a row, exactly. Which of several holders is found depends on the querent. */
void brio_find_holders(brio_querent *q, const brio_query_row *row, brio_holder holders[BRIO_ABREAST]);

/** Returns the tetrahedron of lowest index that holds the query; BRIO_INFINITE for a query outside the hull. */
uint32_t brio_lowest_holder(const brio_locator *l, const brio_holder *h);

/** Locates queries in the tetrahedra of lowest index that hold them. So the result does not depend on the querent. */
void brio_find_lowest_holders(brio_querent *q, const brio_query_row *row, brio_holder holders[BRIO_ABREAST]);

/** Returns whether the query is on the boundary of the hull.   h  not outside, and not at a vertex. */
bool brio_holder_on_hull(const brio_locator *l, const brio_holder *h);

#endif
