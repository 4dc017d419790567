/* Coordinates and weights that are no numbers, see finite.h. */
#include "base/finite.h"
#include <math.h>

static bool is_finite(const double *points, const double *weights, size_t i) {
    const double *p = points + 3 * i;
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) && (!weights || isfinite(weights[i]));
}

brio_status brio_refuse_not_finite(brio_context *ctx, const double *points, const double *weights, size_t n,
                                   const char *file) {
    static const char *const NAME[] = {"x", "y", "z", "weight"};
    size_t first = n, count = 0, c = 0;
    for (size_t i = 0; i < n; i++)
        if (!is_finite(points, weights, i) && count++ == 0) first = i;
    if (count == 0) return BRIO_OK;
    while (c < 3 && isfinite(points[3 * first + c])) c++;
    const char *what = isnan(c < 3 ? points[3 * first + c] : weights[first]) ? "NaN" : "infinite";
    if (!file)
        return brio_fail(ctx, BRIO_ERR_NOT_FINITE, "point %zu: %s is %s (%zu such points in all)", first, NAME[c], what,
                         count);
    return brio_fail(ctx, BRIO_ERR_NOT_FINITE,
                     "%s: point %zu: %s is %s (%zu such point%s in all); points are counted from 0", file, first,
                     NAME[c], what, count, count == 1 ? "" : "s");
}
