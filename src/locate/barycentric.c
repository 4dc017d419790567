/* Coordinates of a query in the tetrahedron that holds it: the volumes of the four tetrahedra that the query makes with
 * the facets, divided by their sum. Coordinates are relative to the query.
 *
 * A flat tetrahedron makes the volumes inexact. So the shares are refined: while the shares do not reproduce the query,
 * the shares of the residual are taken off. Where that does not reproduce the query, the tetrahedron is flat up to rounding,
 * and its faces take its place (base/flat_shares.h). So linear functions are reproduced almost to the rounding of their
 * values, whatever the shape. */
#include "locate/barycentric.h"
#include "base/flat_shares.h"
#include "base/scale.h"
#include "base/vector.h"

enum { REFINEMENTS = 2 };

double brio_offset_scale(const brio_locator *l, const uint32_t *places, size_t count, const double *x) {
    double most = 0;
    int exponent;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) most = fmax(most, fabs(l->record[places[i]][k] - x[k]));
    if (!(most < INFINITY)) return 0;
    frexp(most, &exponent);
    return exponent < -1000 ? 0x1p1000 : exponent > 1000 ? 0x1p-1020 : brio_power_of_two(-exponent);
}

/* Returns det [a, b, c]. */
static double triple(const double *a, const double *b, const double *c) {
    double bc[3];
    brio_cross(b, c, bc);
    return brio_dot(a, bc);
}

/* Sets share to the solution of sum share[i] row[i] = target, sum share[i] = total: Cramer's rule. */
static bool solve(const double row[4][3], const double *target, double total, double share[4]) {
    double edge[3][3], rest[3], volume;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) edge[i][k] = row[i + 1][k] - row[0][k];
        rest[k] = target[k] - total * row[0][k];
    }
    volume = triple(edge[0], edge[1], edge[2]);
    share[1] = triple(rest, edge[1], edge[2]) / volume;
    share[2] = triple(edge[0], rest, edge[2]) / volume;
    share[3] = triple(edge[0], edge[1], rest) / volume;
    share[0] = total - share[1] - share[2] - share[3];
    return isfinite(share[0]);
}

/* Sets residual to -sum share[i] row[i]. */
static void find_residual(const double row[4][3], const double share[4], double residual[3]) {
    for (int k = 0; k < 3; k++) {
        residual[k] = 0;
        for (int i = 0; i < 4; i++) residual[k] -= share[i] * row[i][k];
    }
}

/* Clears the shares that are 0 exactly or would be negative, and divides the others by their sum. */
static void normalize(unsigned zeros, double share[4]) {
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        if (zeros >> i & 1 || !(share[i] > 0)) share[i] = 0;
        sum += share[i];
    }
    for (int i = 0; i < 4; i++) share[i] = sum > 0 ? share[i] / sum : 0.25;
}

void brio_barycentric(const brio_locator *l, const brio_holder *h, const double *x, double share[4]) {
    const uint32_t *v = l->t.tet[h->tet].vertex;
    double row[4][3], residual[3] = {0, 0, 0}, more[4], scale = brio_offset_scale(l, v, 4, x);
    if (__builtin_popcount(h->zeros) == 3) {
        for (int i = 0; i < 4; i++) share[i] = !(h->zeros >> i & 1);
        return;
    }
    for (int i = 0; i < 4; i++) brio_offset(l, v[i], x, scale, row[i]);
    bool solved = solve(row, residual, 1, share);
    for (int n = 0; n < REFINEMENTS && solved; n++) {
        find_residual(row, share, residual);
        solved = solve(row, residual, 0, more);
        for (int i = 0; i < 4 && solved; i++) share[i] += more[i];
    }
    normalize(h->zeros, share);
    if (!brio_shares_hold((const double(*)[3])row, 4, share))
        brio_flat_shares((const double(*)[3])row, 4, h->zeros, share);
}
