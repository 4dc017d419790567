/* Sizes of a triangle. */
#ifndef BRIO_RECONSTRUCT_TRIANGLE_H
#define BRIO_RECONSTRUCT_TRIANGLE_H

#include <math.h>

/** Returns the squared length of the cross product of ab and ac.   square  receives the squared lengths of ab, ac and
 *  bc. */
static inline double brio_cross_square(const double *a, const double *b, const double *c, double square[3]) {
    double u[3], v[3], cross = 0;
    square[0] = square[1] = square[2] = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k], v[k] = c[k] - a[k];
        square[0] += u[k] * u[k], square[1] += v[k] * v[k];
        square[2] += (c[k] - b[k]) * (c[k] - b[k]);
    }
    for (int k = 0; k < 3; k++) {
        double n = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        cross += n * n;
    }
    return cross;
}

/** Returns the squared radius of the circle through three points, INFINITY if they are collinear. */
static inline double brio_circle_square(const double *a, const double *b, const double *c) {
    double square[3], cross = brio_cross_square(a, b, c, square);
    return cross > 0 ? square[0] / cross * square[1] * square[2] / 4 : INFINITY;
}

/** Returns the area of a triangle. */
static inline double brio_triangle_area(const double *a, const double *b, const double *c) {
    double square[3];
    return 0.5 * sqrt(brio_cross_square(a, b, c, square));
}

#endif
