/* Points that no caller can have, see finite.h. */
#include "base/finite.h"
#include <assert.h>
#include <inttypes.h>
#include <math.h>

/* Indices have 32 bits, and 17 of their values at the end stand for other things. Where addresses have 32 bits, too,
 * each point may take 64 bytes, so that no size in bytes wraps. */
static const size_t MOST_POINTS = SIZE_MAX / 64 < UINT32_MAX - 17 ? SIZE_MAX / 64 : UINT32_MAX - 17;

brio_status brio_refuse_many(brio_context *ctx, size_t num_points) {
    BRIO_EXPECT(ctx, num_points <= MOST_POINTS, BRIO_ERR_TOO_LARGE, "%zu points; at most %zu", num_points, MOST_POINTS);
    return BRIO_OK;
}

/* Copies the numbers of a point: what is judged and named is what was read once, since another thread of the caller may
 * write to them. */
static inline void copy_point(const double *points, const double *weights, size_t i, double row[4]) {
    for (size_t k = 0; k < 3; k++) row[k] = points[3 * i + k];
    row[3] = weights ? weights[i] : 0;
}

/* Counts a row that is not finite. */
static void count_row(brio_not_finite *found, uint64_t index, const double row[4]) {
    static const char *const NAME[] = {"x", "y", "z", "weight"};
    size_t c = 0;
    if (found->count++ > 0) return;
    while (c < 3 && isfinite(row[c])) c++;
    assert(!isfinite(row[c]));
    found->first = index;
    found->axis = NAME[c];
    found->what = isnan(row[c]) ? "NaN" : "infinite";
}

void brio_count_not_finite(brio_not_finite *found, uint64_t first, const double *points, const double *weights,
                           size_t n) {
    double row[4];
    for (size_t i = 0; i < n; i++) {
        copy_point(points, weights, i, row);
        if (!brio_all_finite(row, 4)) count_row(found, first + i, row);
    }
}

brio_status brio_refuse_counted(brio_context *ctx, const brio_not_finite *found, const char *file) {
    if (found->count == 0) return BRIO_OK;
    assert(found->axis && found->what);
    if (!file)
        return brio_fail(ctx, BRIO_ERR_NOT_FINITE, "point %" PRIu64 ": %s is %s (%" PRIu64 " such point%s in all)",
                         BRIO_POINT(ctx, found->first), found->axis, found->what, found->count,
                         found->count == 1 ? "" : "s");
    return brio_fail(ctx, BRIO_ERR_NOT_FINITE,
                     "%s: point %" PRIu64 ": %s is %s (%" PRIu64 " such point%s in all); points are counted from 0",
                     file, BRIO_POINT(ctx, found->first), found->axis, found->what, found->count,
                     found->count == 1 ? "" : "s");
}

brio_status brio_refuse_not_finite(brio_context *ctx, const double *points, const double *weights, size_t n,
                                   const char *file) {
    brio_not_finite found = {.count = 0};
    brio_count_not_finite(&found, 0, points, weights, n);
    return brio_refuse_counted(ctx, &found, file);
}

brio_status brio_refuse_vertices(brio_context *ctx, const double *vertices, size_t n, const char *mesh) {
    brio_not_finite found = {.count = 0};
    brio_count_not_finite(&found, 0, vertices, NULL, n);
    if (found.count == 0) return BRIO_OK;
    return brio_fail(ctx, BRIO_ERR_NOT_FINITE, "vertex %" PRIu64 " of %s: %s is %s (%" PRIu64 " such %s in all)",
                     found.first, mesh, found.axis, found.what, found.count, found.count == 1 ? "vertex" : "vertices");
}

brio_status brio_refuse_records(brio_context *ctx, const double (*record)[4], const uint32_t *order, size_t n) {
    brio_not_finite found = {.first = UINT64_MAX};
    for (size_t i = 0; i < n; i++) {
        uint64_t from = order ? order[i] : i, count = found.count;
        if (brio_all_finite(record[i], 4)) continue;
        if (from < found.first) {
            found.count = 0;
            count_row(&found, from, record[i]);
        }
        found.count = count + 1;
    }
    return brio_refuse_counted(ctx, &found, NULL);
}
