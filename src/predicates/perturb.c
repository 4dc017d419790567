/* Breaks ties of insphere and of the power test by a symbolic perturbation of the lifted coordinate.
 *
 * The lift |p|^2 - w of each point grows by an infinitesimal. The infinitesimal of a point is infinitely larger than
 * those of all lexicographically smaller points. The lexicographically largest point whose cofactor is not zero
 * decides:
 *   - The cofactor of the query e is the tetrahedron, which is positive. Lifting e puts e outside.
 *   - The cofactor of a vertex is the tetrahedron with that vertex replaced by e.
 * Coordinates are never perturbed. So no flat tetrahedron appears, and the answer depends only on the points.
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
