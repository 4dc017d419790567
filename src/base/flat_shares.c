/* Barycentric coordinates in simplices so flat that rounding makes their volumes meaningless.
 *
 * The hull of points on the sides of a turned box has such simplices: their vertices are in one plane, or on one line,
 * up to rounding. A query inside is in one of the faces up to that rounding. So the query is projected to each
 * triangle, edge and vertex of the simplex, shares below 0 are cleared, and the nearest of these points counts. */
#include "base/flat_shares.h"
#include "base/vector.h"
#include <assert.h>
#include <math.h>
#include <stdbool.h>

/* Returns the square of |sum share[i] row[i]|. */
static double square_of(const double (*row)[3], int count, const double *share) {
    double sum[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < count; i++) sum[k] += share[i] * row[i][k];
    return brio_dot(sum, sum);
}

int brio_shares_hold(const double (*row)[3], int count, const double *share) {
    double most = 0;
    for (int i = 0; i < count; i++) most = fmax(most, brio_dot(row[i], row[i]));
    return square_of(row, count, share) <= BRIO_SHARES_NEAR * most;
}

/* Sets share[0] and share[1] to those of the projection of 0 to the line through two points. */
static void project_to_line(const double *a, const double *b, double share[3]) {
    double along[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    share[1] = -brio_dot(a, along) / brio_dot(along, along);
    share[0] = 1 - share[1];
}

/* Sets share to that of the projection of 0 to the plane through three points. */
static void project_to_plane(const double *a, const double *b, const double *c, double share[3]) {
    double ab[3], ac[3], normal[3], part[3];
    for (int k = 0; k < 3; k++) ab[k] = b[k] - a[k], ac[k] = c[k] - a[k];
    brio_cross(ab, ac, normal);
    double square = brio_dot(normal, normal);
    brio_cross(b, c, part), share[0] = brio_dot(part, normal) / square;
    brio_cross(c, a, part), share[1] = brio_dot(part, normal) / square;
    share[2] = 1 - share[0] - share[1];
}

/* Projects 0 to the face whose vertices are the bits of `face`, one to three of them. Returns false if the face is too
 * flat for that. */
static bool project(const double (*row)[3], int count, unsigned face, double *share) {
    assert(face != 0 && face >> count == 0 && __builtin_popcount(face) <= 3);
    int corner[3], n = 0;
    double part[3] = {1, 0, 0}, sum = 0;
    for (int i = 0; i < count; i++) {
        share[i] = 0;
        if (face >> i & 1) corner[n++] = i;
    }
    if (n == 2) project_to_line(row[corner[0]], row[corner[1]], part);
    if (n == 3) project_to_plane(row[corner[0]], row[corner[1]], row[corner[2]], part);
    for (int i = 0; i < n; i++) sum += part[i] = part[i] > 0 ? part[i] : 0;
    for (int i = 0; i < n; i++) share[corner[i]] = part[i] / sum;
    return sum > 0 && isfinite(sum);
}

void brio_flat_shares(const double (*row)[3], int count, unsigned zeros, double *share) {
    assert((count == 3 || count == 4) && zeros != (1u << count) - 1);
    double least = INFINITY, found[4];
    for (int size = 3; size > 0; size--)
        for (unsigned face = 1; face < 1u << count; face++) {
            if (face & zeros || __builtin_popcount(face) != size || !project(row, count, face, found)) continue;
            double square = square_of(row, count, found);
            if (!(square < least)) continue;
            least = square;
            for (int i = 0; i < count; i++) share[i] = found[i];
        }
}
