/* Smooth surfaces whose local feature size is known, with certified r-samples of them. */
#ifndef BRIO_TESTS_KNOWN_SURFACES_H
#define BRIO_TESTS_KNOWN_SURFACES_H

#include "base/rng.h"
#include <math.h>
#include <stdlib.h>

typedef struct {
    double (*value)(const double *p);                /* signed distance near the surface, negative inside */
    void (*normal)(const double *p, double *normal); /* at a point of the surface, unit */
    double *(*sample)(uint64_t seed, size_t *count); /* an r-sample, to be freed */
    double feature_size;                             /* least over the surface, which proofs may use everywhere */
    double r;
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

static inline double *sphere_sample(uint64_t seed, size_t *count) {
    brio_rng rng = brio_rng_new(seed);
    double side = cell_side(0.08, 1);
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

static inline double *torus_sample(uint64_t seed, size_t *count) {
    brio_rng rng = brio_rng_new(seed);
    double side = cell_side(0.08, 0.5);
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

#endif
