/* Quadric errors: the sum of squared distances from planes, weighted by area, as a polynomial in the point. */
#ifndef BRIO_MESH_QUADRIC_H
#define BRIO_MESH_QUADRIC_H

/** q(x) = x'Ax - 2 b'x + c, A = (xx, xy, xz, yy, yz, zz); `area` is the sum of the weights. */
typedef struct {
    double a[6], b[3], c, area;
} brio_quadric;

/** Adds the plane of a triangle. Also adds the corner p with a small weight, which fixes the minimum where the planes
 *  do not determine one. */
void brio_quadric_add_triangle(brio_quadric *q, const double *p, const double *r, const double *s);

void brio_quadric_add(brio_quadric *q, const brio_quadric *other);

/** Returns the value at a point, or 0 if rounding makes the value negative. */
double brio_quadric_at(const brio_quadric *q, const double *x);

/** Writes the point of least value. Returns 0 when the quadric does not determine the point to about half the digits
 *  of a double. */
int brio_quadric_minimum(const brio_quadric *q, double *x);

#endif
