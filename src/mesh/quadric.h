/* Quadric errors: the sum of squared distances from planes, weighted by area, as a polynomial of the point. */
#ifndef BRIO_MESH_QUADRIC_H
#define BRIO_MESH_QUADRIC_H

/** q(x) = x'Ax - 2 b'x + c, A = (xx, xy, xz, yy, yz, zz); `area` is the sum of the weights. */
typedef struct {
    double a[6], b[3], c, area;
} brio_quadric;

/** Adds the plane of a triangle and, far lighter, its corner p, which holds the minimum where planes leave it open. */
void brio_quadric_add_triangle(brio_quadric *q, const double *p, const double *r, const double *s);

void brio_quadric_add(brio_quadric *q, const brio_quadric *other);

/** The value at a point, at least 0. */
double brio_quadric_at(const brio_quadric *q, const double *x);

/** The point of least value; 0 when it is not determined to about half the digits of a double. */
int brio_quadric_minimum(const brio_quadric *q, double *x);

#endif
