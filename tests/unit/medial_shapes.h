/* Solids whose medial axis and whose distance function are known, with samples of their surfaces as dense as asked. */
#ifndef BRIO_TESTS_MEDIAL_SHAPES_H
#define BRIO_TESTS_MEDIAL_SHAPES_H

#include "base/rng.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MEDIAL_PI 3.141592653589793

/* Points that grow in number as they are made. */
typedef struct {
    brio_rng rng;
    double *points;
    size_t count, capacity;
} cloud;

static inline void cloud_add(cloud *c, double x, double y, double z) {
    if (c->count == c->capacity) {
        c->capacity = c->capacity ? 2 * c->capacity : 1024;
        c->points = realloc(c->points, 3 * c->capacity * sizeof *c->points);
    }
    double *p = c->points + 3 * c->count++;
    p[0] = x, p[1] = y, p[2] = z;
}

/* A random place in the middle half of cell i of n of [low, high]. */
static inline double cloud_cell(cloud *c, int i, int n, double low, double high) {
    return low + (high - low) * (i + 0.25 + 0.5 * brio_rng_double(&c->rng)) / n;
}

static inline int cloud_cells(double length, double h) {
    int n = (int)ceil(length / h);
    return n < 1 ? 1 : n;
}

/* A surface of revolution about z whose profile has radius r(t), height z(t) and the given length, t in [0, 1]. */
static inline void cloud_revolve(cloud *c, double h, double length, void (*profile)(double t, double *r, double *z)) {
    int rings = cloud_cells(length, h);
    for (int i = 0; i < rings; i++) {
        double r, z;
        profile((i + 0.5) / rings, &r, &z);
        int cells = cloud_cells(2 * MEDIAL_PI * r, h);
        for (int j = 0; j < cells; j++) {
            double a = cloud_cell(c, j, cells, 0, 2 * MEDIAL_PI);
            profile(cloud_cell(c, i, rings, 0, 1), &r, &z);
            cloud_add(c, r * cos(a), r * sin(a), z);
        }
    }
}

typedef struct {
    const char *name;
    void (*sample)(cloud *c, double h);         /* no point of the surface is farther than h from a sample */
    double (*off_axis)(const double *p);        /* no less than the distance of p from the inner medial axis */
    double (*signed_distance)(const double *p); /* from the surface, negative inside */
    void (*on_axis)(brio_rng *rng, double *p);  /* a random point of the inner medial axis; each part of it is met */
    int euler;                                  /* the Euler characteristic of the solid */
} medial_shape;

/* --- the unit sphere --- */

static inline void sphere_profile(double t, double *r, double *z) {
    *r = sin(MEDIAL_PI * t), *z = cos(MEDIAL_PI * t);
}
static inline void sphere_cloud(cloud *c, double h) {
    cloud_revolve(c, h, MEDIAL_PI, sphere_profile);
}
static inline double sphere_distance(const double *p) {
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1;
}
static inline double sphere_off_axis(const double *p) {
    return sphere_distance(p) + 1;
}

static inline void sphere_on_axis(brio_rng *rng, double *p) {
    (void)rng;
    p[0] = p[1] = p[2] = 0;
}

/* --- the torus of radii 1 and 0.4 --- */

static inline void torus_profile(double t, double *r, double *z) {
    *r = 1 + 0.4 * cos(2 * MEDIAL_PI * t), *z = 0.4 * sin(2 * MEDIAL_PI * t);
}
static inline void torus_cloud(cloud *c, double h) {
    cloud_revolve(c, h, 0.8 * MEDIAL_PI, torus_profile);
}
static inline double torus_off_axis(const double *p) {
    return hypot(hypot(p[0], p[1]) - 1, p[2]);
}
static inline double torus_distance(const double *p) {
    return torus_off_axis(p) - 0.4;
}

static inline void torus_on_axis(brio_rng *rng, double *p) {
    double a = 2 * MEDIAL_PI * brio_rng_double(rng);
    p[0] = cos(a), p[1] = sin(a), p[2] = 0;
}

/* --- the ellipsoid of semi-axes 1.5, 1, 0.6: its axis is an elliptic disk [x / a, y / b], a = (1.5^2 - 0.6^2) / 1.5 --- */

static inline void ellipsoid_cloud(cloud *c, double h) {
    size_t first = c->count;
    sphere_cloud(c, h / 1.5);
    for (size_t i = first; i < c->count; i++) c->points[3 * i] *= 1.5, c->points[3 * i + 2] *= 0.6;
}
static inline double ellipsoid_off_axis(const double *p) {
    double a = (2.25 - 0.36) / 1.5, b = 1 - 0.36, k = fmax(hypot(p[0] / a, p[1] / b), 1);
    return hypot(hypot(p[0], p[1]) * (1 - 1 / k), p[2]);
}

static inline void ellipsoid_on_axis(brio_rng *rng, double *p) {
    double a = 2 * MEDIAL_PI * brio_rng_double(rng), r = sqrt(brio_rng_double(rng));
    p[0] = r * cos(a) * (2.25 - 0.36) / 1.5, p[1] = r * sin(a) * (1 - 0.36), p[2] = 0;
}

/* --- the box of half sides 1, 0.7, 0.5 --- */

static inline void box_cloud(cloud *c, double h) {
    static const double half[3] = {1, 0.7, 0.5};
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3, m = cloud_cells(2 * half[u], h), n = cloud_cells(2 * half[v], h);
        for (int cell = 0; cell < 2 * m * n; cell++) {
            double p[3];
            p[axis] = cell % 2 ? half[axis] : -half[axis];
            p[u] = cloud_cell(c, cell / 2 % m, m, -half[u], half[u]);
            p[v] = cloud_cell(c, cell / 2 / m, n, -half[v], half[v]);
            cloud_add(c, p[0], p[1], p[2]);
        }
    }
}
/* To the box, then away from the nearest side until another one, or the one across, is as near. */
static inline double box_off_axis(const double *p) {
    static const double half[3] = {1, 0.7, 0.5};
    double least = INFINITY, next = INFINITY, across = 0, outside = 0;
    for (int k = 0; k < 3; k++) {
        double x = fmin(fabs(p[k]), half[k]), depth = half[k] - x;
        outside += (fabs(p[k]) - x) * (fabs(p[k]) - x);
        next = fmin(next, fmax(least, depth));
        if (depth < least) least = depth, across = x;
    }
    return sqrt(outside) + fmin(next - least, across);
}

/* A random point of the box, moved away from the nearest side as box_off_axis has it. */
static inline void box_on_axis(brio_rng *rng, double *p) {
    static const double half[3] = {1, 0.7, 0.5};
    double least = INFINITY, next = INFINITY;
    int nearest = 0;
    for (int k = 0; k < 3; k++) {
        p[k] = half[k] * (2 * brio_rng_double(rng) - 1);
        double depth = half[k] - fabs(p[k]);
        next = fmin(next, fmax(least, depth));
        if (depth < least) least = depth, nearest = k;
    }
    p[nearest] = copysign(half[nearest] - fmin(next, half[nearest]), p[nearest]);
}

/* --- the cylinder of radius 1 and half height 1.5, with its caps --- */

static inline void side_profile(double t, double *r, double *z) {
    *r = 1, *z = 3 * t - 1.5;
}
static inline void lower_profile(double t, double *r, double *z) {
    *r = t, *z = -1.5;
}
static inline void upper_profile(double t, double *r, double *z) {
    *r = t, *z = 1.5;
}
static inline void cylinder_cloud(cloud *c, double h) {
    cloud_revolve(c, h, 3, side_profile);
    cloud_revolve(c, h, 1, lower_profile);
    cloud_revolve(c, h, 1, upper_profile);
}
/* To the cylinder, then away from the side until the axis or a cap is as near, or from the cap until the side is. */
static inline double cylinder_off_axis(const double *p) {
    double radius = hypot(p[0], p[1]), r = fmin(radius, 1), z = fmin(fabs(p[2]), 1.5);
    double side = 1 - r, cap = 1.5 - z, outside = hypot(radius - r, fabs(p[2]) - z);
    return outside + (side < cap ? fmin(r, cap - side) : side - cap);
}

/* The axis of revolution between the cones, and the cones, which end where the caps do. */
static inline void cylinder_on_axis(brio_rng *rng, double *p) {
    double a = 2 * MEDIAL_PI * brio_rng_double(rng), z = 3 * brio_rng_double(rng) - 1.5, r = fmax(fabs(z) - 0.5, 0);
    p[0] = r * cos(a), p[1] = r * sin(a), p[2] = z;
}

/* --- the capsule of radius 0.5 about the segment from -1 to 1 of the z axis --- */

static inline void capsule_profile(double t, double *r, double *z) {
    double s = t * (2 + 0.5 * MEDIAL_PI), a = s / 0.5,
           b = (s - 2) / 0.5; /* along the lower cap, the side, the upper cap */
    if (a < MEDIAL_PI / 2)
        *r = 0.5 * sin(a), *z = -1 - 0.5 * cos(a);
    else if (b > MEDIAL_PI / 2)
        *r = 0.5 * sin(b), *z = 1 - 0.5 * cos(b);
    else
        *r = 0.5, *z = s - 0.25 * MEDIAL_PI - 1;
}
static inline void capsule_cloud(cloud *c, double h) {
    cloud_revolve(c, h, 2 + 0.5 * MEDIAL_PI, capsule_profile);
}
static inline double capsule_off_axis(const double *p) {
    return hypot(hypot(p[0], p[1]), fmax(fabs(p[2]) - 1, 0));
}
static inline double capsule_distance(const double *p) {
    return capsule_off_axis(p) - 0.5;
}
static inline void capsule_on_axis(brio_rng *rng, double *p) {
    p[0] = p[1] = 0, p[2] = 2 * brio_rng_double(rng) - 1;
}

static const medial_shape medial_sphere = {"sphere", sphere_cloud, sphere_off_axis, sphere_distance, sphere_on_axis, 1};
static const medial_shape medial_torus = {"torus", torus_cloud, torus_off_axis, torus_distance, torus_on_axis, 0};
static const medial_shape medial_ellipsoid = {"ellipsoid", ellipsoid_cloud,   ellipsoid_off_axis,
                                              NULL,        ellipsoid_on_axis, 1};
static const medial_shape medial_box = {"box", box_cloud, box_off_axis, NULL, box_on_axis, 1};
static const medial_shape medial_cylinder = {"cylinder", cylinder_cloud, cylinder_off_axis, NULL, cylinder_on_axis, 1};

static const medial_shape medial_capsule = {"capsule",        capsule_cloud,   capsule_off_axis,
                                            capsule_distance, capsule_on_axis, 1};

static inline cloud medial_sample(const medial_shape *shape, double h, uint64_t seed) {
    cloud c = {.rng = brio_rng_new(seed)};
    shape->sample(&c, h);
    return c;
}

#endif
