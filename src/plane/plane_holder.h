/* The triangles that hold a query. */
#ifndef BRIO_PLANE_PLANE_HOLDER_H
#define BRIO_PLANE_PLANE_HOLDER_H

#include "plane/locator2.h"

/* --- the order of queries --- */

/* Many queries of a triangulation of the plane, divided among threads. */

/** What one thread carries from query to query. Answers do not depend on it. */
typedef struct {
    const brio_locator2 *l;
    int thread;
    brio_plane_filter filter;
} brio_plane_querent;

/** Answers query `index` at x, which is a record: two coordinates and zeros.   user  of the batch.
 *  Returns BRIO_OK or an error. */
typedef brio_status (*brio_plane_answer_fn)(void *user, brio_plane_querent *q, size_t index, const double *x);

typedef struct {
    const brio_locator2 *l;
    const double *queries; /* #Q by 2 */
    size_t count;
    const char *stage; /* for the progress */
    brio_plane_answer_fn answer;
    void *user;
} brio_plane_batch;

/** Returns the number of threads for this many queries: brio_plane_answer_all uses thread numbers below it. */
int brio_plane_query_threads(brio_context *ctx, size_t count);

/** Calls `answer` once for each query, in any order and from several threads. Each number of a query is read once after
 *  the check that all are finite, and what is read is checked again: the caller's array may change meanwhile.
 *  threads  what brio_plane_query_threads returned.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE, BRIO_ERR_CANCELLED, and what `answer` returns. */
brio_status brio_plane_answer_all(brio_context *ctx, int threads, const brio_plane_batch *batch);

/** A triangle that holds a query, and where in it the query lies. */
typedef struct {
    uint32_t triangle; /* a finite triangle whose closure holds the query; BRIO_INFINITE outside the hull */
    unsigned zeros;    /* bit i: the query is on the line of the edge opposite to vertex i. Two bits: at a vertex. */
} brio_plane_holder;

/** Returns the triangle of lowest index that holds x. Exact. */
brio_plane_holder brio_plane_find_holder(brio_plane_querent *q, const double *x);

/** Returns whether the query is on an edge of the hull.   h  not outside, and not at a vertex. */
bool brio_plane_holder_on_hull(const brio_locator2 *l, const brio_plane_holder *h);

#endif
