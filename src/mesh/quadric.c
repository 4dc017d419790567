/* The quadric of a triangle. See quadric.h.
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997.
 * Differs from the paper: area weights the planes, and a small term draws each corner towards its original position. */
#include "mesh/quadric.h"
#include <math.h>

static const double PULL = 1e-3; /* weight of the original position, as a share of the weight of the planes; chosen */

/* Adds weight (n.x - d)^2; n need not have unit length. */
static void add_plane(brio_quadric *q, const double *n, double d, double weight) {
    int at = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) q->a[at++] += weight * n[i] * n[j];
        q->b[i] += weight * d * n[i];
    }
    q->c += weight * d * d;
}

static void add_point(brio_quadric *q, const double *p, double weight) {
    q->a[0] += weight, q->a[3] += weight, q->a[5] += weight;
    for (int i = 0; i < 3; i++) {
        q->b[i] += weight * p[i];
        q->c += weight * p[i] * p[i];
    }
}

void brio_quadric_add_triangle(brio_quadric *q, const double *p, const double *r, const double *s) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = r[k] - p[k], v[k] = s[k] - p[k];
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) return;
    for (int k = 0; k < 3; k++) n[k] /= length;
    add_plane(q, n, n[0] * p[0] + n[1] * p[1] + n[2] * p[2], length);
    add_point(q, p, PULL * length);
    q->area += length;
}
