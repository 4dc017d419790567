/* Ties of insphere and of the power test, broken by a symbolic perturbation of the lifted coordinate.
 *
 * Each point's lift |p|^2 - w grows by an infinitesimal of its own, by far the largest for the lexicographically largest
 * point, and so on downwards. The first point of that order whose cofactor is not zero decides: for the query itself the
 * cofactor is the (positive) tetrahedron, and lifting the query puts it outside; for another vertex it is the tetrahedron
 * with that vertex replaced by the query. Coordinates are never perturbed, so no flat tetrahedron ever appears, and the
 * answer depends on the points alone.
 *
 * Based on: Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011. */
#include "predicates/predicates.h"

static void sort_descending(const double *p[5]) {
    for (int i = 1; i < 5; i++)
        for (int j = i; j > 0 && brio_lexicographic(p[j - 1], p[j]) < 0; j--) {
            const double *swap = p[j];
            p[j] = p[j - 1], p[j - 1] = swap;
        }
}

int brio_insphere_tie(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                      const double *e) {
    const double *p[5] = {a, b, c, d, e};
    sort_descending(p);
    for (int i = 0; i < 5; i++) {
        int sign = 0;
        if (p[i] == e) return -1;
        if (p[i] == a) sign = brio_orient3d_sign(f, e, b, c, d);
        if (p[i] == b) sign = brio_orient3d_sign(f, a, e, c, d);
        if (p[i] == c) sign = brio_orient3d_sign(f, a, b, e, d);
        if (p[i] == d) sign = brio_orient3d_sign(f, a, b, c, e);
        if (sign) return sign;
    }
    return -1; /* not reached: e is among the five */
}
