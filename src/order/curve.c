/* Sorts points along a Hilbert curve: a radix sort by keys of at most ten levels. Cells with more than CELL_MOST points
 * are sorted again, along the curve through the cube of their own points. So clusters of any size are resolved. */
#include "order/curve.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/hilbert.h"

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

/* The refinement of the cells of n items. Part i of the cells is at the positions [start[i], start[i + 1]). */
typedef struct {
    const curve *c;
    const size_t *start;
    size_t n;
    brio_status status;
} refinement;

static brio_status sort_along_curve(const curve *c, size_t begin, size_t end, int threads);

/* Returns the first position of [from, end) where a cell of [begin, end) starts, or `end` if there is none. */
static size_t start_of_cell(const curve *c, size_t begin, size_t end, size_t from) {
    while (from > begin && from < end && c->items[from] >> 32 == c->items[from - 1] >> 32) from++;
    return from;
}

/* Sorts the cells of [from, to) that have more than CELL_MOST points. A cell starts at `from`, and one ends at `to`.
 * Skips a cell with all `all` points: its cube is too small to be divided. */
static brio_status refine_cells(const curve *c, size_t from, size_t to, size_t all) {
    const uint64_t *items = c->items;
    brio_status status = BRIO_OK;
    for (size_t next; from < to && status == BRIO_OK; from = next) {
        for (next = from + 1; next < to && items[next] >> 32 == items[from] >> 32;) next++;
        if (next - from > CELL_MOST && next - from < all) status = sort_along_curve(c, from, next, 1);
    }
    return status;
}

static void refine_part(void *user, size_t part, size_t end, int thread) {
    refinement *r = user;
    (void)end, (void)thread;
    brio_report(&r->status, refine_cells(r->c, r->start[part], r->start[part + 1], r->n));
}

/* Sorts the items [begin, end) along the curve through the cube of their points. */
static brio_status sort_along_curve(const curve *c, size_t begin, size_t end, int threads) {
    brio_status status = BRIO_OK;
    size_t n = end - begin, *start = NULL; /* the bounds of each thread's cells, found before a thread changes a key */
    int bits = curve_bits(n);
    if (!brio_hilbert_items(c->ctx, c->points, c->items + begin, n, bits, threads)) return BRIO_OK;
    BRIO_TRY(brio_sort_items(c->ctx, c->items + begin, c->spare + begin, n, 3 * bits, threads));
    if (threads == 1) return refine_cells(c, begin, end, n);
    BRIO_TRY(BRIO_ALLOC(c->ctx, start, (size_t)threads + 1));
    for (int t = 0; t <= threads; t++) start[t] = start_of_cell(c, begin, end, begin + brio_part(n, t, threads));
    refinement r = {c, start, n, BRIO_OK};
    brio_for_chunks(c->ctx, threads, (size_t)threads, 1, refine_part, &r);
    status = r.status;
done:
    brio_release(c->ctx, start);
    return status;
}

brio_status brio_sort_along_curve(brio_context *ctx, const double *points, uint64_t *items, uint64_t *spare, size_t n,
                                  int threads) {
    return sort_along_curve(&(curve){ctx, points, items, spare}, 0, n, threads);
}
