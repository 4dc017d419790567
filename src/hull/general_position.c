/* Records in general position, far from each other.
 *
 * Each record is chosen by rounded arithmetic, as the one that is farthest from those before, and checked exactly. If
 * the check fails, the first record that passes it takes its place; if there is none, the records before span all. */
#include "base/vector.h"
#include "hull/polytope.h"
#include <assert.h>
#include <math.h>

typedef struct {
    brio_filter *filter;
    const double (*record)[4];
    size_t n;
    const uint32_t *corner;
} search;

/* Returns whether record i is off the affine hull of the first `count` corners; exact. */
static bool is_off(const search *s, size_t i, int count) {
    assert(0 < count && count < 4 && i < s->n);
    const double(*r)[4] = s->record;
    const uint32_t *c = s->corner;
    if (count == 1) return !brio_same_position(r[c[0]], r[i]);
    if (count == 2) return !brio_collinear(r[c[0]], r[c[1]], r[i]);
    return brio_orient3d_sign(s->filter, r[c[0]], r[c[1]], r[c[2]], r[i]) != 0;
}

/* Returns a number that grows with the distance of record i from the affine hull of the first `count` corners. Halved
 * coordinates do not overflow where they are subtracted; where products do, the exact search decides. */
static double distance(const search *s, size_t i, int count) {
    double d[3][3], normal[3];
    for (int c = 0; c < count; c++)
        for (int k = 0; k < 3; k++)
            d[c][k] = 0.5 * s->record[c + 1 < count ? s->corner[c + 1] : i][k] - 0.5 * s->record[s->corner[0]][k];
    if (count == 1) return brio_dot(d[0], d[0]);
    brio_cross(d[0], d[1], normal);
    return count == 2 ? brio_dot(normal, normal) : fabs(brio_dot(normal, d[2]));
}

int brio_general_position(brio_filter *f, const double (*record)[4], size_t n, uint32_t corner[4]) {
    search s = {f, record, n, corner};
    if (n == 0) return -1;
    corner[0] = 0;
    for (int count = 1; count < 4; count++) {
        size_t best = 0;
        double most = 0;
        for (size_t i = 0; i < n; i++) {
            double d = distance(&s, i, count);
            if (d > most) most = d, best = i;
        }
        if (!is_off(&s, best, count))
            for (best = 0; best < n && !is_off(&s, best, count);) best++;
        if (best == n) return count - 1;
        corner[count] = (uint32_t)best;
    }
    return 3;
}
