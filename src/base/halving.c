/* Divide and conquer by threads, level by level.
 *
 * The halves of a range are equally large, so all ranges of one depth take about the same time. The threads cut all
 * ranges of a depth, then all ranges of the next depth, until every thread has some pieces to finish. No list of open
 * ranges is needed: the bits of a range's number tell which half to take at each depth. */
#include "base/halving.h"
#include "base/team.h"
#include <assert.h>

/* LOOKED_AT: most places of a piece, so that a look comes between two pieces in time. All chosen. */
enum { PIECES_A_THREAD = 4, LOOKED_AT = 1 << 17 };

/* The 2^depth ranges of a depth, in order. */
typedef struct {
    const brio_halving *h;
    int depth;
} level;

static inline size_t middle_of(size_t begin, size_t end) {
    return begin + (end - begin) / 2;
}

static void range_of(const level *l, size_t i, size_t *begin, size_t *end) {
    assert(i >> l->depth == 0);
    *begin = 0;
    *end = l->h->count;
    for (int d = l->depth; d-- > 0;) {
        size_t middle = middle_of(*begin, *end);
        if (i >> d & 1)
            *begin = middle + l->h->gap;
        else
            *end = middle;
    }
    assert(*begin <= *end && *end <= l->h->count);
}

static void cut_ranges(void *user, size_t from, size_t to, int thread) {
    const level *l = user;
    (void)thread;
    for (size_t i = from, begin, end; i < to; i++) {
        range_of(l, i, &begin, &end);
        assert(begin < end); /* ranges that are cut have a middle */
        l->h->cut(l->h->user, begin, middle_of(begin, end), end);
    }
}

static void finish_ranges(void *user, size_t from, size_t to, int thread) {
    const level *l = user;
    (void)thread;
    for (size_t i = from, begin, end; i < to; i++) {
        range_of(l, i, &begin, &end);
        l->h->finish(l->h->user, begin, end, l->depth);
    }
}

static brio_status do_level(brio_context *ctx, int threads, level *l, brio_part_fn body) {
    size_t ranges = (size_t)1 << l->depth;
    return brio_for_chunks(ctx, ranges < (size_t)threads ? (int)ranges : threads, ranges, 1, body, l);
}

brio_status brio_halve(brio_context *ctx, const brio_halving *h) {
    brio_status status = BRIO_OK;
    assert(h->gap <= 1);
    int threads = brio_threads(ctx, h->count, h->least);
    size_t pieces = threads > 1 ? (size_t)threads * PIECES_A_THREAD : 1;
    if (pieces < h->count / LOOKED_AT) pieces = h->count / LOOKED_AT;
    level l = {h, 0};
    /* each of 2^d ranges has at least count / 2^d - gap places */
    for (; (size_t)1 << l.depth < pieces && h->count >> l.depth > h->least; l.depth++)
        BRIO_TRY(do_level(ctx, threads, &l, cut_ranges));
    status = do_level(ctx, threads, &l, finish_ranges);
done:
    return status;
}
