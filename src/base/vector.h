/* Vectors of three doubles. Sums always run from x to z, so that the same points give the same bits. */
#ifndef BRIO_BASE_VECTOR_H
#define BRIO_BASE_VECTOR_H

#include <math.h>

static inline double brio_dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Returns the length, also of a vector whose square is beyond doubles or below them. */
static inline double brio_length(const double *a) {
    double square = brio_dot(a, a);
    return square > 0x1p-900 && square < 0x1p1000 ? sqrt(square) : hypot(a[0], hypot(a[1], a[2]));
}

/** Returns the squared distance, INFINITY if doubles overflow. */
static inline double brio_square_distance(const double *a, const double *b) {
    double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return brio_dot(d, d);
}

static inline void brio_cross(const double *a, const double *b, double *out) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
