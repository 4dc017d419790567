/* Coordinates of a query in the triangle that holds it: areas divided by their sum, and refined while they do not reproduce
 * the query, as in locate/barycentric.c, where the reasons stand. */
#include "plane/plane_barycentric.h"
#include "base/flat_shares.h"
#include "base/scale.h"
#include <assert.h>
#include <math.h>

enum { REFINEMENTS = 2 };

double brio_plane_offset_scale(const brio_locator2 *l, const uint32_t *points, size_t count, const double *x) {
    double most = 0;
    int exponent;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) most = fmax(most, fabs(l->record[points[i]][k] - x[k]));
    if (!(most < INFINITY)) return 0;
    frexp(most, &exponent);
    return exponent < -1000 ? 0x1p1000 : exponent > 1000 ? 0x1p-1020 : brio_power_of_two(-exponent);
}

/* Sets share to the solution of sum share[i] row[i] = target, sum share[i] = total: Cramer's rule. */
static bool solve(const double row[3][2], const double *target, double total, double share[3]) {
    double edge[2][2], rest[2];
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 2; i++) edge[i][k] = row[i + 1][k] - row[0][k];
        rest[k] = target[k] - total * row[0][k];
    }
    double area = brio_plane_cross(edge[0], edge[1]);
    share[1] = brio_plane_cross(rest, edge[1]) / area;
    share[2] = brio_plane_cross(edge[0], rest) / area;
    share[0] = total - share[1] - share[2];
    return isfinite(share[0]);
}

/* Sets residual to -sum share[i] row[i]. */
static void find_residual(const double row[3][2], const double share[3], double residual[2]) {
    for (int k = 0; k < 2; k++) {
        residual[k] = 0;
        for (int i = 0; i < 3; i++) residual[k] -= share[i] * row[i][k];
    }
}

/* Clears the shares that are 0 exactly or would be negative, and divides the others by their sum. */
static void normalize(unsigned zeros, double share[3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        if (zeros >> i & 1 || !(share[i] > 0)) share[i] = 0;
        sum += share[i];
    }
    for (int i = 0; i < 3; i++) share[i] = sum > 0 ? share[i] / sum : 1.0 / 3;
}

void brio_plane_barycentric(const brio_locator2 *l, const brio_plane_holder *h, const double *x, double share[3]) {
    assert(h->triangle < l->num_finite && h->zeros < 7);
    const uint32_t *v = l->triangle[h->triangle].vertex;
    double row[3][2], residual[2] = {0, 0}, more[3], scale = brio_plane_offset_scale(l, v, 3, x);
    if (__builtin_popcount(h->zeros) == 2) {
        for (int i = 0; i < 3; i++) share[i] = !(h->zeros >> i & 1);
        return;
    }
    for (int i = 0; i < 3; i++) brio_plane_offset(l, v[i], x, scale, row[i]);
    bool solved = solve((const double(*)[2])row, residual, 1, share);
    for (int n = 0; n < REFINEMENTS && solved; n++) {
        find_residual((const double(*)[2])row, share, residual);
        solved = solve((const double(*)[2])row, residual, 0, more);
        for (int i = 0; i < 3 && solved; i++) share[i] += more[i];
    }
    normalize(h->zeros, share);
    double offset[3][3] = {{row[0][0], row[0][1]}, {row[1][0], row[1][1]}, {row[2][0], row[2][1]}};
    if (!brio_shares_hold((const double(*)[3])offset, 3, share))
        brio_flat_shares((const double(*)[3])offset, 3, h->zeros, share);
}
