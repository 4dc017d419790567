/* A canonical order of points, which does not depend on the order of the input.
 *
 * Surface reconstruction sorts the samples in this order and uses ranks instead of the caller's indices. So every
 * choice by rank depends only on positions: the order of the tetrahedra and of their vertices, the order of additions,
 * ties in sorts and queues, the root of a union-find.
 *
 * The points are sorted along a Hilbert curve, because the insertion is fast when neighbours in space are neighbours in
 * memory. Points with equal keys are sorted lexicographically. The key of a point depends only on the set of positions,
 * so the positions determine the ranks. */
#include "order/canonical_points.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/curve.h"
#include <string.h>

enum { POINTS_A_THREAD = 1 << 12 };

brio_status brio_refuse_points(brio_context *ctx, const double *points, size_t n) {
    BRIO_FORWARD(brio_refuse_many(ctx, n));
    return brio_refuse_not_finite(ctx, points, NULL, n, NULL);
}

/* Writes the indices of the sorted items to `order`, and sorts indices with equal keys by position. */
static void list_indices(const double *points, const uint64_t *items, size_t n, uint32_t *order) {
    for (size_t i = 0; i < n; i++) order[i] = (uint32_t)items[i];
    for (size_t begin = 0, end; begin < n; begin = end) {
        for (end = begin + 1; end < n && items[end] >> 32 == items[begin] >> 32;) end++;
        brio_sort_indices(order + begin, end - begin, brio_compare_points, points);
    }
}

brio_status brio_canonical_points(brio_context *ctx, const double *points, size_t n, uint32_t **order) {
    brio_status status = BRIO_OK;
    uint64_t *items = NULL, *spare = NULL;
    *order = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, items, n));
    BRIO_TRY(BRIO_ALLOC(ctx, spare, n));
    for (size_t i = 0; i < n; i++) items[i] = i;
    BRIO_TRY(brio_sort_along_curve(ctx, points, items, spare, n, brio_threads(ctx, n, POINTS_A_THREAD)));
    brio_release(ctx, spare);
    spare = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, *order, n));
    list_indices(points, items, n, *order);
done:
    brio_release(ctx, items);
    brio_release(ctx, spare);
    return status;
}

void brio_copy_points(const double *points, const uint32_t *order, size_t n, double *rows) {
    for (size_t i = 0; i < n; i++) memcpy(rows + 3 * i, points + 3 * (size_t)order[i], 3 * sizeof *rows);
}

/* Relies on coincident points having consecutive ranks, the lowest index first. */
void brio_name_coincident(const double *points, size_t n, uint32_t *order) {
    for (size_t i = 1; i < n; i++)
        if (brio_same_position(points + 3 * (size_t)order[i - 1], points + 3 * (size_t)order[i]))
            order[i] = order[i - 1];
}
