/* Sorts points along a Hilbert curve: a radix sort by keys of at most ten levels. Cells with more than CELL_MOST points
 * are sorted again, along the curve through the cube of their own points. So clusters of any size are resolved.
 *
 * The caller's points may change meanwhile. A pass reads them twice, for the cube and for the keys; the order of the
 * items follows from the keys alone, so it stays a permutation, and each pass leaves a cell with fewer points. */
#include "order/curve.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/hilbert.h"
#include <assert.h>

enum { CURVE_BITS = 10, CELL_MOST = 8 };

/* Returns the number of levels of the curve for n points: enough to separate points spread evenly over a surface. */
static int curve_bits(size_t n) {
    int bits = 2;
    while (bits < CURVE_BITS && (size_t)1 << 2 * (bits - 1) < n) bits++;
    return bits;
}

typedef struct {
    brio_context *ctx;
    const double *points;
    uint64_t *items, *spare;
} curve;

/* The positions [begin, end) of items. */
typedef struct {
    size_t begin, end;
} range;

static inline size_t size_of(range r) {
    return r.end - r.begin;
}

static brio_status sort_range(const curve *c, range r);

/* Sorts the cells of a range that have more than CELL_MOST points, except the largest one, which it writes to *largest;
 * without any, *largest is empty. A cell starts where the range starts, and one ends where it ends. The cells that it
 * sorts have at most half of the points, so the recursion is as deep as the logarithm of the number of points. */
static brio_status refine_cells(const curve *c, range r, range *largest) {
    const uint64_t *items = c->items;
    brio_status status = BRIO_OK;
    *largest = (range){r.begin, r.begin};
    for (size_t from = r.begin, next; from < r.end && status == BRIO_OK; from = next) {
        for (next = from + 1; next < r.end && items[next] >> 32 == items[from] >> 32;) next++;
        range cell = {from, next};
        assert(next == r.end || items[from] >> 32 < items[next] >> 32); /* the keys ascend */
        if (size_of(cell) <= CELL_MOST) continue;
        if (size_of(cell) > size_of(*largest)) {
            range smaller = *largest;
            *largest = cell, cell = smaller;
        }
        if (size_of(cell)) status = sort_range(c, cell);
    }
    return status;
}

/* Sorts a range along the curve through the cube of its points, and goes on with the largest cell. Stops at a cell with
 * all points of its range: its cube is too small to be divided. */
static brio_status sort_range(const curve *c, range r) {
    assert(r.begin <= r.end);
    for (range largest; size_of(r); r = largest) {
        uint64_t *items = c->items + r.begin;
        int bits = curve_bits(size_of(r));
        BRIO_FORWARD(brio_hilbert_items(c->ctx, c->points, items, size_of(r), &bits, 1));
        if (!bits) break;
        BRIO_FORWARD(brio_sort_items(c->ctx, items, c->spare + r.begin, size_of(r), 3 * bits, 1));
        BRIO_FORWARD(refine_cells(c, r, &largest));
        if (size_of(largest) == size_of(r)) break;
    }
    return BRIO_OK;
}

/* --- with several threads --- */

/* The refinement of the cells of n items. Part i of the cells is at the positions [start[i], start[i + 1]). */
typedef struct {
    const curve *c;
    const size_t *start;
    size_t n;
    brio_status status;
} refinement;

/* Returns the first position from `from` on where a cell of the first n items starts, or n if there is none. */
static size_t start_of_cell(const curve *c, size_t n, size_t from) {
    while (from > 0 && from < n && c->items[from] >> 32 == c->items[from - 1] >> 32) from++;
    return from;
}

static void refine_part(void *user, size_t part, size_t end, int thread) {
    refinement *r = user;
    range largest;
    (void)end, (void)thread;
    brio_report(&r->status, refine_cells(r->c, (range){r->start[part], r->start[part + 1]}, &largest));
    if (size_of(largest) < r->n) brio_report(&r->status, sort_range(r->c, largest));
}

/* Sorts all n items. */
static brio_status sort_together(const curve *c, size_t n, int threads) {
    brio_status status = BRIO_OK;
    size_t *start = NULL; /* the bounds of each thread's cells, found before a thread changes a key */
    int bits = curve_bits(n);
    BRIO_TRY(brio_hilbert_items(c->ctx, c->points, c->items, n, &bits, threads));
    if (!bits) goto done;
    BRIO_TRY(brio_sort_items(c->ctx, c->items, c->spare, n, 3 * bits, threads));
    BRIO_TRY(BRIO_ALLOC(c->ctx, start, (size_t)threads + 1));
    for (int t = 0; t <= threads; t++) start[t] = start_of_cell(c, n, brio_part(n, t, threads));
    assert(start[0] == 0 && start[threads] == n);
    refinement r = {c, start, n, BRIO_OK};
    BRIO_TRY(brio_for_chunks(c->ctx, threads, (size_t)threads, 1, refine_part, &r));
    status = r.status;
done:
    brio_release(c->ctx, start);
    return status;
}

brio_status brio_sort_along_curve(brio_context *ctx, const double *points, uint64_t *items, uint64_t *spare, size_t n,
                                  int threads) {
    assert(threads >= 1 && (n == 0 || (items && spare && items != spare)));
    const curve c = {ctx, points, items, spare};
    return threads > 1 ? sort_together(&c, n, threads) : sort_range(&c, (range){0, n});
}
