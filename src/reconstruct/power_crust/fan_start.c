/* The corner from which a face of the crust is cut into a fan of triangles.
 *
 * A face is a convex polygon in the plane midway between the powers of two balls, up to the rounding of its corners.
 * Where three corners are nearly on a line, rounding may turn their triangle over, and the triangle then crosses the
 * neighbours of the face. The fan from the middle one of the three corners has no such triangle. So the first corner is
 * kept if the normals of all triangles of its fan are within 60 degrees of the plane's normal; otherwise the corner is
 * chosen whose worst triangle is best. */
#include "reconstruct/power_crust/fan_start.h"
#include "base/vector.h"
#include <math.h>

/* Of the angle between the normals of a triangle and of its plane; chosen. */
static const double LEAST_COSINE = 0.5;
/* Corners that are tried at most, so that the cost stays linear in the corners; chosen. */
enum { MOST_STARTS = 64 };

/* Returns twice the area of the triangle times the cosine of its angle with the plane less LEAST_COSINE, times the
 * length of the plane's normal. */
static double agreement(const double *a, const double *b, const double *c, const double normal[3], double length) {
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    brio_cross(u, v, n);
    return brio_dot(n, normal) - LEAST_COSINE * sqrt(brio_dot(n, n)) * length;
}

/* Returns the least agreement of the triangles of the fan from corner `start`, at most 0. */
static double worst_agreement(const double *vertices, const uint32_t *corner, size_t size, size_t start,
                              const double normal[3], double length) {
    const double *first = vertices + 3 * (size_t)corner[start];
    double worst = 0;
    for (size_t i = 1; i + 1 < size; i++) {
        const double *b = vertices + 3 * (size_t)corner[(start + i) % size];
        const double *c = vertices + 3 * (size_t)corner[(start + i + 1) % size];
        worst = fmin(worst, agreement(first, b, c, normal, length));
    }
    return worst;
}

static void reverse(uint32_t *corner, size_t size) {
    for (size_t i = 0; i < size / 2; i++) {
        uint32_t swap = corner[i];
        corner[i] = corner[size - 1 - i], corner[size - 1 - i] = swap;
    }
}

void brio_turn_to_fan_start(const double *vertices, uint32_t *corner, size_t size, const double normal[3]) {
    double length = sqrt(brio_dot(normal, normal)), best = -INFINITY;
    size_t start = 0;
    for (size_t i = 0; i < size && i < MOST_STARTS && best < 0; i++) {
        double worst = worst_agreement(vertices, corner, size, i, normal, length);
        if (worst > best) best = worst, start = i;
    }
    if (start == 0) return;
    reverse(corner, start);
    reverse(corner + start, size - start);
    reverse(corner, size);
}
