/* The step of the eigenvectors of symmetric matrices. */
#ifndef BRIO_BASE_ROTATE_H
#define BRIO_BASE_ROTATE_H

#include <assert.h>
#include <math.h>

/** Rotates the symmetric matrix m in the plane of axes i and j so that m[i][j] becomes 0, and the columns of v with it.
 *  Repeated over all pairs of axes, m becomes diagonal, and the columns of v the eigenvectors.
 *  Based on: [Jacobi 1846]. */
static inline void brio_rotate(double m[3][3], double v[3][3], int i, int j) {
    assert(i != j);
    if (m[i][j] == 0) return;
    double theta = (m[j][j] - m[i][i]) / (2 * m[i][j]);
    double t = copysign(1, theta) / (fabs(theta) + sqrt(1 + theta * theta)), c = 1 / sqrt(1 + t * t), s = t * c;
    for (int k = 0; k < 3; k++) {
        double a = m[k][i], b = m[k][j];
        m[k][i] = c * a - s * b;
        m[k][j] = s * a + c * b;
    }
    for (int k = 0; k < 3; k++) {
        double a = m[i][k], b = m[j][k], p = v[k][i], q = v[k][j];
        m[i][k] = c * a - s * b;
        m[j][k] = s * a + c * b;
        v[k][i] = c * p - s * q;
        v[k][j] = s * p + c * q;
    }
}

#endif
