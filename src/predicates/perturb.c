/* Ties of insphere and of the power test, broken by a symbolic perturbation of the lifted coordinate.
 *
 * Each point's lift |p|^2 - w grows by an infinitesimal of its own, by far the largest for the lexicographically
 * largest point, and so on downwards. The largest point whose cofactor is not zero decides: for the query itself the
 * cofactor is the (positive) tetrahedron, and lifting the query puts it outside; for another vertex it is the
 * tetrahedron with that vertex replaced by the query. Coordinates are never perturbed, so no flat tetrahedron ever
 * appears, and the answer depends on the points alone.
 *
 * Based on: Devillers, Teillaud. Perturbations for Delaunay and weighted Delaunay 3D triangulations. CGTA 2011. */
#include "predicates/predicates.h"

int brio_insphere_tie(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                      const double *e) {
    const double *p[4] = {a, b, c, d}, *decisive = e;
    int decision = -1;
    for (int i = 0; i < 4; i++) {
        if (brio_lexicographic(p[i], decisive) < 0) continue;
        const double *q[4] = {a, b, c, d};
        q[i] = e;
        int sign = brio_orient3d_sign(f, q[0], q[1], q[2], q[3]);
        if (sign) decisive = p[i], decision = sign;
    }
    return decision;
}
