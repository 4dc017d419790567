/* Smooth surfaces whose local feature size is known, with certified r-samples of them: sphere, torus, and a plate with
 * three holes. On each the local feature size is the same everywhere. */
#ifndef BRIO_TESTS_KNOWN_SURFACES_H
#define BRIO_TESTS_KNOWN_SURFACES_H

#include "base/rng.h"
#include <math.h>
#include <stdlib.h>

typedef struct {
    double (*value)(const double *p);                          /* signed distance, negative inside */
    void (*normal)(const double *p, double *normal);           /* at a point of the surface, unit */
    double *(*sample)(double r, uint64_t seed, size_t *count); /* an r-sample, to be freed */
    double feature_size;                                       /* the local feature size, everywhere */
    double r;                                                  /* as large as the guarantees allow */
    int genus;
} known_surface;

/* A patch of the surface that is `width` by `height` at most holds one sample in the middle half of its parameters. So
 * no point of the patch is farther from it than 3/4 of the patch's diagonal. */
static inline double cell_side(double r, double feature_size) {
    return r * feature_size / 0.75 / sqrt(2);
}

static inline double in_middle(brio_rng *rng) {
    return 0.25 + 0.5 * brio_rng_double(rng);
}

/* --- the unit sphere --- */

static inline double sphere_value(const double *p) {
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1;
}

static inline void sphere_normal(const double *p, double *normal) {
    for (int k = 0; k < 3; k++) normal[k] = p[k];
}

static inline double *sphere_sample(double r, uint64_t seed, size_t *count) {
    brio_rng rng = brio_rng_new(seed);
    double side = cell_side(r, 1);
    int rings = (int)ceil(3.141592653589793 / side);
    double *points = malloc(sizeof *points * 3 * 8 * (size_t)(rings * rings)), *p = points;
    for (int i = 0; i < rings; i++) {
        double low = 3.141592653589793 * i / rings, high = 3.141592653589793 * (i + 1) / rings;
        double widest = low < 1.5707963 && high > 1.5707963 ? 1 : fmax(sin(low), sin(high));
        int cells = (int)ceil(6.283185307179586 * widest / side);
        for (int j = 0; j < cells; j++, p += 3) {
            double polar = low + (high - low) * in_middle(&rng);
            double a = 6.283185307179586 * (j + in_middle(&rng)) / cells;
            p[0] = sin(polar) * cos(a), p[1] = sin(polar) * sin(a), p[2] = cos(polar);
        }
    }
    *count = (size_t)(p - points) / 3;
    return points;
}

static const known_surface known_sphere = {sphere_value, sphere_normal, sphere_sample, 1, 0.08, 0};

/* --- the torus of radii 1 and 0.5; its medial axis is the circle within and the axis of revolution --- */

static inline double torus_value(const double *p) {
    double ring = sqrt(p[0] * p[0] + p[1] * p[1]) - 1;
    return sqrt(ring * ring + p[2] * p[2]) - 0.5;
}

static inline void torus_normal(const double *p, double *normal) {
    double axis = sqrt(p[0] * p[0] + p[1] * p[1]), ring = (axis - 1) / axis;
    normal[0] = p[0] * ring / 0.5, normal[1] = p[1] * ring / 0.5, normal[2] = p[2] / 0.5;
}

static inline double *torus_sample(double r, uint64_t seed, size_t *count) {
    brio_rng rng = brio_rng_new(seed);
    double side = cell_side(r, 0.5);
    int rings = (int)ceil(6.283185307179586 * 0.5 / side);
    int most = (int)ceil(6.283185307179586 * 1.5 / side);
    double *points = malloc(sizeof *points * 3 * (size_t)(rings * most)), *p = points;
    for (int i = 0; i < rings; i++) {
        double low = 6.283185307179586 * i / rings, high = 6.283185307179586 * (i + 1) / rings;
        double widest = i == 0 || i == rings - 1 ? 1.5 : 1 + 0.5 * fmax(cos(low), cos(high));
        int cells = (int)ceil(6.283185307179586 * widest / side);
        for (int j = 0; j < cells; j++, p += 3) {
            double v = low + (high - low) * in_middle(&rng), a = 6.283185307179586 * (j + in_middle(&rng)) / cells;
            p[0] = (1 + 0.5 * cos(v)) * cos(a), p[1] = (1 + 0.5 * cos(v)) * sin(a), p[2] = 0.5 * sin(v);
        }
    }
    *count = (size_t)(p - points) / 3;
    return points;
}

static const known_surface known_torus = {torus_value, torus_normal, torus_sample, 0.5, 0.08, 1};

/* --- all points at distance 1/2 from a flat disk with three round holes of radius 1: genus 3 ---
 *
 * Two flat sheets over the disk, joined by half tubes along its rims. Inside, the points with several nearest points of
 * the surface are the disk itself; outside, they are the axes of the holes, since a point off the disk has one nearest
 * point on it but on those axes. The disk is 1/2 away from all of the surface and the axes no less, so the local feature
 * size is 1/2 everywhere. (The normal is Lipschitz, the curvature jumps where a sheet meets a tube.) */

enum { PLATE_HOLES = 3 };
static const double PLATE_RIM = 2.4, PLATE_HALF = 0.5;
static const double PLATE_HOLE[PLATE_HOLES][2] = {{1.3, 0}, {-0.65, 1.1258330249197702}, {-0.65, -1.1258330249197702}};

/* The distance of (x, y) from the disk; *away is the direction away from it. */
static inline double plate_off_disk(const double *p, double away[2]) {
    double far = sqrt(p[0] * p[0] + p[1] * p[1]);
    away[0] = away[1] = 0;
    if (far > PLATE_RIM) {
        away[0] = p[0] / far, away[1] = p[1] / far;
        return far - PLATE_RIM;
    }
    for (int h = 0; h < PLATE_HOLES; h++) {
        double x = p[0] - PLATE_HOLE[h][0], y = p[1] - PLATE_HOLE[h][1], near = sqrt(x * x + y * y);
        if (near >= 1) continue;
        if (near > 0) away[0] = -x / near, away[1] = -y / near;
        return 1 - near;
    }
    return 0;
}

static inline double plate_value(const double *p) {
    double away[2], off = plate_off_disk(p, away);
    return sqrt(off * off + p[2] * p[2]) - PLATE_HALF;
}

static inline void plate_normal(const double *p, double *normal) {
    double away[2], off = plate_off_disk(p, away), length = sqrt(off * off + p[2] * p[2]);
    normal[0] = off * away[0] / length, normal[1] = off * away[1] / length, normal[2] = p[2] / length;
}

/* The half tube along the circle of the given radius: turned outwards (way 1) or into a hole (way -1). */
static inline double *plate_tube(brio_rng *rng, double side, double radius, const double *centre, int way, double *p) {
    int rings = (int)ceil(3.141592653589793 * PLATE_HALF / side);
    for (int i = 0; i < rings; i++) {
        double low = 3.141592653589793 * (i - 0.5 * rings) / rings, high = low + 3.141592653589793 / rings;
        double bend = low < 0 && high > 0 ? 1 : fmax(cos(low), cos(high));
        double widest = way > 0 ? radius + PLATE_HALF * bend : radius;
        int cells = (int)ceil(6.283185307179586 * widest / side);
        for (int j = 0; j < cells; j++, p += 3) {
            double v = low + (high - low) * in_middle(rng), a = 6.283185307179586 * (j + in_middle(rng)) / cells;
            double out = radius + way * PLATE_HALF * cos(v);
            p[0] = centre[0] + out * cos(a), p[1] = centre[1] + out * sin(a), p[2] = PLATE_HALF * sin(v);
        }
    }
    return p;
}

/* A square of the grid that meets the disk holds a sample: in its middle half, or, where that is off the disk, the point
 * of the disk nearest to the square's centre, which is nearer to the centre than any point of the disk in the square. So
 * no such point is farther than a diagonal from its sample. */
static inline double *plate_sheet(brio_rng *rng, double side, double z, double *p) {
    int half = (int)ceil(PLATE_RIM / side);
    for (int i = -half; i < half; i++)
        for (int j = -half; j < half; j++) {
            double centre[2] = {side * (i + 0.5), side * (j + 0.5)}, away[2];
            double off = plate_off_disk(centre, away);
            if (off > side * 0.7071067811865476) continue;
            p[0] = side * (i + in_middle(rng)), p[1] = side * (j + in_middle(rng)), p[2] = z;
            double ignored[2];
            if (plate_off_disk(p, ignored) > 0) p[0] = centre[0] - off * away[0], p[1] = centre[1] - off * away[1];
            p += 3;
        }
    return p;
}

static inline double *plate_sample(double r, uint64_t seed, size_t *count) {
    brio_rng rng = brio_rng_new(seed);
    double side = cell_side(r, PLATE_HALF), grid = r * PLATE_HALF * 0.7071067811865476;
    size_t sheet = (size_t)(2 * PLATE_RIM / grid + 3), across = (size_t)(1.6 / side + 2);
    size_t along = (size_t)(6.3 * (PLATE_RIM + PLATE_HALF + PLATE_HOLES) / side + 4);
    double *points = malloc(sizeof *points * 3 * (2 * sheet * sheet + across * along));
    double *p = plate_sheet(&rng, grid, -PLATE_HALF, points), middle[2] = {0, 0};
    p = plate_sheet(&rng, grid, PLATE_HALF, p);
    p = plate_tube(&rng, side, PLATE_RIM, middle, 1, p);
    for (int h = 0; h < PLATE_HOLES; h++) p = plate_tube(&rng, side, 1, PLATE_HOLE[h], -1, p);
    *count = (size_t)(p - points) / 3;
    return points;
}

static const known_surface known_plate = {plate_value, plate_normal, plate_sample, 0.5, 0.08, 3};

#endif
