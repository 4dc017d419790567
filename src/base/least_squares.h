/* Linear equations in three unknowns that may leave directions free. */
#ifndef BRIO_BASE_LEAST_SQUARES_H
#define BRIO_BASE_LEAST_SQUARES_H

#include "base/rotate.h"

/** Adds the equation n.x = d to the normal equations A x = b.   a  A as (xx, xy, xz, yy, yz, zz). */
static inline void brio_add_equation(const double *n, double d, double a[6], double b[3]) {
    for (int k = 0, at = 0; k < 3; k++) {
        b[k] += d * n[k];
        for (int j = k; j < 3; j++) a[at++] += n[k] * n[j];
    }
}

/** Solves A x = b in the directions of A's large eigenvalues; x is 0 in the others.   least  share of the largest
 *  eigenvalue below which an eigenvalue is small. */
static inline void brio_solve_determined(const double a[6], const double b[3], double least, double x[3]) {
    enum { SWEEPS = 5 /* to all digits */ };
    double m[3][3] = {{a[0], a[1], a[2]}, {a[1], a[3], a[4]}, {a[2], a[4], a[5]}};
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, most = 0;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        brio_rotate(m, v, 0, 1);
        brio_rotate(m, v, 0, 2);
        brio_rotate(m, v, 1, 2);
    }
    for (int i = 0; i < 3; i++) most = fmax(most, m[i][i]);
    x[0] = x[1] = x[2] = 0;
    for (int i = 0; i < 3; i++) {
        if (!(m[i][i] > least * most)) continue;
        double along = (v[0][i] * b[0] + v[1][i] * b[1] + v[2][i] * b[2]) / m[i][i];
        for (int k = 0; k < 3; k++) x[k] += along * v[k][i];
    }
}

#endif
