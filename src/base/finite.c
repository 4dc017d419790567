/* Coordinates and weights that are no numbers, see finite.h. */
#include "base/finite.h"
#include <inttypes.h>
#include <math.h>

static bool is_finite(const double *points, const double *weights, size_t i) {
    const double *p = points + 3 * i;
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) && (!weights || isfinite(weights[i]));
}

void brio_count_not_finite(brio_not_finite *found, uint64_t first, const double *points, const double *weights,
                           size_t n) {
    static const char *const NAME[] = {"x", "y", "z", "weight"};
    for (size_t i = 0; i < n; i++) {
        if (is_finite(points, weights, i) || found->count++ > 0) continue;
        size_t c = 0;
        while (c < 3 && isfinite(points[3 * i + c])) c++;
        found->first = first + i;
        found->axis = NAME[c];
        found->what = isnan(c < 3 ? points[3 * i + c] : weights[i]) ? "NaN" : "infinite";
    }
}

brio_status brio_refuse_counted(brio_context *ctx, const brio_not_finite *found, const char *file) {
    if (found->count == 0) return BRIO_OK;
    if (!file)
        return brio_fail(ctx, BRIO_ERR_NOT_FINITE, "point %" PRIu64 ": %s is %s (%" PRIu64 " such points in all)",
                         found->first, found->axis, found->what, found->count);
    return brio_fail(ctx, BRIO_ERR_NOT_FINITE,
                     "%s: point %" PRIu64 ": %s is %s (%" PRIu64 " such point%s in all); points are counted from 0",
                     file, found->first, found->axis, found->what, found->count, found->count == 1 ? "" : "s");
}

brio_status brio_refuse_not_finite(brio_context *ctx, const double *points, const double *weights, size_t n,
                                   const char *file) {
    brio_not_finite found = {.count = 0};
    brio_count_not_finite(&found, 0, points, weights, n);
    return brio_refuse_counted(ctx, &found, file);
}
