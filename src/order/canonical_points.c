/* An order of points that is the same for every order in which they come.
 *
 * A surface is computed from samples in this order, and their ranks take the place of the caller's indices. So whatever
 * goes by rank on the way depends on positions alone: the order of the tetrahedra and of their vertices, the order in
 * which numbers are added, a tie in a sort or in a queue, the root of a union-find.
 *
 * The points are sorted along a Hilbert curve, which the insertion needs near each other in memory; points that the curve
 * does not tell apart are sorted lexicographically. A cell of the curve is a set of positions, so the ranks are a function
 * of these. */
#include "order/canonical_points.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/curve.h"
#include <string.h>

enum { POINTS_A_THREAD = 1 << 12 };

brio_status brio_refuse_points(brio_context *ctx, const double *points, size_t n) {
    if (n >= UINT32_MAX - 16) return brio_fail(ctx, BRIO_ERR_TOO_LARGE, "%zu points; at most 2^32 - 17", n);
    return brio_refuse_not_finite(ctx, points, NULL, n, NULL);
}

/* Turns the sorted items into indices, those with equal keys sorted by position. */
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

/* Coincident points have ranks one after the other, the lowest index first. */
void brio_name_coincident(const double *points, size_t n, uint32_t *order) {
    for (size_t i = 1; i < n; i++)
        if (brio_same_position(points + 3 * (size_t)order[i - 1], points + 3 * (size_t)order[i]))
            order[i] = order[i - 1];
}
