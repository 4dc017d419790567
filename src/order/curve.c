/* Sorting of points along a Hilbert curve: a radix sort of the keys of ten levels; cells with many points are sorted
 * again, along the curve through their own cube, so that clusters of any size are resolved. */
#include "order/curve.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/hilbert.h"

enum { CURVE_BITS = 10, CELL_MOST = 8 };

/* Levels of the curve for n points: enough to tell them apart where they are spread evenly over a surface. */
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

/* The refinement of the cells of [begin, end). */
typedef struct {
    const curve *c;
    size_t begin, end;
    brio_status status;
} refinement;

static brio_status sort_along_curve(const curve *c, size_t begin, size_t end, int threads);

/* Sorts the cells of [begin, end) that start in [from, to) and have many points. */
static brio_status refine_cells(const curve *c, size_t begin, size_t end, size_t from, size_t to) {
    const uint64_t *items = c->items;
    brio_status status = BRIO_OK;
    while (from > begin && from < end && items[from] >> 32 == items[from - 1] >> 32) from++;
    for (size_t next; from < to && status == BRIO_OK; from = next) {
        for (next = from + 1; next < end && items[next] >> 32 == items[from] >> 32;) next++;
        bool crowded =
            next - from > CELL_MOST && next - from < end - begin; /* else the cube is too small to be divided */
        if (crowded) status = sort_along_curve(c, from, next, 1);
    }
    return status;
}

/* Refines the cells that start in a part of the items, from the first one of the refinement on. */
static void refine_part(void *user, size_t from, size_t to, int thread) {
    refinement *r = user;
    (void)thread;
    brio_report(&r->status, refine_cells(r->c, r->begin, r->end, r->begin + from, r->begin + to));
}

/* Sorts the items [begin, end) along the curve through their points' cube. */
static brio_status sort_along_curve(const curve *c, size_t begin, size_t end, int threads) {
    size_t n = end - begin;
    int bits = curve_bits(n);
    if (!brio_hilbert_items(c->ctx, c->points, c->items + begin, n, bits, threads)) return BRIO_OK;
    brio_status status = brio_sort_items(c->ctx, c->items + begin, c->spare + begin, n, 3 * bits, threads);
    if (status != BRIO_OK) return status;
    refinement r = {c, begin, end, BRIO_OK};
    brio_for(c->ctx, threads, n, refine_part, &r);
    return r.status;
}

brio_status brio_sort_along_curve(brio_context *ctx, const double *points, uint64_t *items, uint64_t *spare, size_t n,
                                  int threads) {
    return sort_along_curve(&(curve){ctx, points, items, spare}, 0, n, threads);
}
