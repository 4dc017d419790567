/* Quadric errors: the sum of squared distances from planes, weighted by area, as a polynomial in the point.
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997.
 * Differs from the paper: area weights the planes, and a small term draws each corner towards its original position. */
#ifndef BRIO_MESH_QUADRIC_H
#define BRIO_MESH_QUADRIC_H

#include <stdbool.h>

/** q(x) = x'Ax - 2 b'x + c, A = (xx, xy, xz, yy, yz, zz); `area` is the sum of the weights. */
typedef struct {
    double a[6], b[3], c, area;
} brio_quadric;

/** Adds the plane of a triangle. Also adds the corner p with a small weight, which fixes the minimum where the planes
 *  do not determine one. */
void brio_quadric_add_triangle(brio_quadric *q, const double *p, const double *r, const double *s);

static inline void brio_quadric_sum(const brio_quadric *p, const brio_quadric *q, brio_quadric *sum) {
    for (int i = 0; i < 6; i++) sum->a[i] = p->a[i] + q->a[i];
    for (int i = 0; i < 3; i++) sum->b[i] = p->b[i] + q->b[i];
    sum->c = p->c + q->c;
    sum->area = p->area + q->area;
}

/** Returns the value at a point, or 0 if rounding makes the value negative. */
static inline double brio_quadric_at(const brio_quadric *q, const double *x) {
    const double *a = q->a;
    double ax = a[0] * x[0] + a[1] * x[1] + a[2] * x[2], ay = a[1] * x[0] + a[3] * x[1] + a[4] * x[2];
    double az = a[2] * x[0] + a[4] * x[1] + a[5] * x[2];
    double value = x[0] * (ax - 2 * q->b[0]) + x[1] * (ay - 2 * q->b[1]) + x[2] * (az - 2 * q->b[2]) + q->c;
    return value > 0 ? value : 0;
}

/** Writes the point of least value. Returns false when the quadric does not determine the point to about half the
 *  digits of a double. */
static inline bool brio_quadric_minimum(const brio_quadric *q, double *x) {
    const double *a = q->a, *b = q->b;
    double m[6] = {a[3] * a[5] - a[4] * a[4], a[2] * a[4] - a[1] * a[5], a[1] * a[4] - a[2] * a[3],
                   a[0] * a[5] - a[2] * a[2], a[1] * a[2] - a[0] * a[4], a[0] * a[3] - a[1] * a[1]};
    double det = a[0] * m[0] + a[1] * m[1] + a[2] * m[2], trace = a[0] + a[3] + a[5];
    if (!(det > 1e-8 * trace * trace * trace)) return false;
    x[0] = (m[0] * b[0] + m[1] * b[1] + m[2] * b[2]) / det;
    x[1] = (m[1] * b[0] + m[3] * b[1] + m[4] * b[2]) / det;
    x[2] = (m[2] * b[0] + m[4] * b[1] + m[5] * b[2]) / det;
    return true;
}

#endif
