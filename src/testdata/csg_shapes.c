/* Signed distances of simple shapes.
 *
 * Based on: Hart. Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces. The Visual
 * Computer 1996. Schoen. Infinite periodic minimal surfaces without self-intersections. NASA TN D-5541, 1970 (the
 * gyroid). */
#include "testdata/csg_shapes.h"
#include "base/vector.h"
#include <math.h>

static double length2(double x, double y) {
    return sqrt(x * x + y * y);
}

/* Returns the distance from a body that is the product of two others, from the distances of those. */
static double product_distance(double a, double b) {
    return fmin(fmax(a, b), 0) + length2(fmax(a, 0), fmax(b, 0));
}

/* With k = |p / r|, the function (k - 1) k / |p / r^2| has value 0 and slope 1 on the surface. */
double brio_ellipsoid_distance(const double *p, const double *r) {
    double k = 0, slope = 0, least = fmin(r[0], fmin(r[1], r[2]));
    for (int i = 0; i < 3; i++) {
        double x = p[i] / r[i];
        k += x * x;
        slope += x * x / (r[i] * r[i]);
    }
    k = sqrt(k);
    return slope > 0 ? fmax(k * (k - 1) / sqrt(slope), -least) : -least;
}

/* Along the axis the nearest ball of the family is shifted by the sine of the cone's angle. */
double brio_capsule_distance(const double *p, double height, double low, double high) {
    double b = (low - high) / height, a = sqrt(fmax(1 - b * b, 0)), q = length2(p[0], p[1]), k = p[2] * a - q * b;
    if (k < 0) return length2(q, p[2]) - low;
    if (k > a * height) return length2(q, p[2] - height) - high;
    return q * a + p[2] * b - low;
}

double brio_torus_distance(const double *p, double major, double minor) {
    return length2(length2(p[0], p[1]) - major, p[2]) - minor;
}

double brio_box_distance(const double *p, const double *half) {
    double outside = 0, most = -INFINITY;
    for (int k = 0; k < 3; k++) {
        double d = fabs(p[k]) - half[k];
        most = fmax(most, d);
        if (d > 0) outside += d * d;
    }
    return fmin(most, 0) + sqrt(outside);
}

double brio_cylinder_distance(const double *p, double radius, double half_height) {
    return product_distance(length2(p[0], p[1]) - radius, fabs(p[2]) - half_height);
}

/* The sign changes with each edge that crosses the ray from the point towards +x. */
double brio_polygon_distance(double x, double y, const double (*points)[4], uint32_t count) {
    double square = INFINITY, sign = 1;
    for (uint32_t i = 0, j = count - 1; i < count; j = i++) {
        const double *a = points[i], *b = points[j];
        double ex = b[0] - a[0], ey = b[1] - a[1], wx = x - a[0], wy = y - a[1];
        double t = fmin(fmax((wx * ex + wy * ey) / (ex * ex + ey * ey), 0), 1);
        double dx = wx - t * ex, dy = wy - t * ey;
        square = fmin(square, dx * dx + dy * dy);
        if ((y >= a[1]) == (y < b[1]) && (y >= a[1]) == (ex * wy > ey * wx)) sign = -sign;
    }
    return sign * sqrt(square);
}

double brio_prism_distance(const double *p, double half, const double (*points)[4], uint32_t count) {
    return product_distance(brio_polygon_distance(p[0], p[1], points, count), fabs(p[2]) - half);
}

double brio_strand_distance(const double *p, const double (*points)[4], uint32_t count) {
    double least = INFINITY;
    for (uint32_t i = 0; i + 1 < count; i++) {
        const double *a = points[i], *b = points[i + 1];
        double e[3], w[3];
        for (int k = 0; k < 3; k++) e[k] = b[k] - a[k], w[k] = p[k] - a[k];
        double t = fmin(fmax(brio_dot(w, e) / brio_dot(e, e), 0), 1);
        for (int k = 0; k < 3; k++) w[k] -= t * e[k];
        least = fmin(least, sqrt(brio_dot(w, w)) - a[3] - t * (b[3] - a[3]));
    }
    return least;
}

/* Divides the distance from the profile along the radius by the secant of the profile's slope. */
double brio_vessel_distance(const double *p, const double *v) {
    double t = (p[2] - v[9]) / v[10], radius = 1, slope = 0;
    for (int i = 0; i < 3; i++) {
        double frequency = 3.14159265358979324 * (i + 1), angle = frequency * t + v[6 + i];
        radius += v[3 + i] * sin(angle);
        slope += v[3 + i] * frequency * cos(angle);
    }
    double side = (length2(p[0], p[1]) - v[2] * radius) / length2(1, v[2] * slope / v[10]);
    return fmax(side, fmax(v[0] - p[2], p[2] - v[1]));
}

double brio_thread_distance(const double *p, const double *v) {
    double turn = p[2] / v[2] - atan2(p[1], p[0]) / 6.28318530717958648, depth = 2 * fabs(turn - rint(turn)) * v[1];
    double side = (length2(p[0], p[1]) - v[0] + depth) / length2(1, 2 * v[1] / v[2]);
    return fmax(side, fabs(p[2]) - v[3]);
}

double brio_gyroid_distance(const double *p, double frequency) {
    double x = frequency * p[0], y = frequency * p[1], z = frequency * p[2];
    return (sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)) / (1.5 * frequency);
}
