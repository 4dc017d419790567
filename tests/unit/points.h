/* Point sets for tests, and a context in one line. */
#ifndef BRIO_TESTS_POINTS_H
#define BRIO_TESTS_POINTS_H

#include "base/rng.h"
#include "brio/brio.h"
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static inline brio_context *new_context(void) {
    brio_context *ctx;
    return brio_context_new(NULL, &ctx) == BRIO_OK ? ctx : NULL;
}

/* n integer points in [0, side)^3, possibly coincident. */
static inline void integer_points(uint64_t seed, size_t n, uint32_t side, double *points) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < 3 * n; i++) points[i] = brio_rng_below(&rng, side);
}

static inline void integer_weights(uint64_t seed, size_t n, uint32_t most, double *weights) {
    brio_rng rng = brio_rng_new(seed + 77);
    for (size_t i = 0; i < n; i++) weights[i] = brio_rng_below(&rng, most);
}

static inline void uniform_points(uint64_t seed, size_t n, double *points) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < 3 * n; i++) points[i] = brio_rng_double(&rng);
}

/* Points about a few centres, at scales from 1 down to 1e-6. */
static inline void clustered_points(uint64_t seed, size_t n, double *points) {
    brio_rng rng = brio_rng_new(seed);
    double centre[3] = {0, 0, 0};
    for (size_t i = 0; i < n; i++) {
        if (brio_rng_below(&rng, 4) == 0)
            for (int k = 0; k < 3; k++) centre[k] = brio_rng_double(&rng);
        double scale = pow(10, -6 * brio_rng_double(&rng));
        for (size_t k = 0; k < 3; k++) points[3 * i + k] = centre[k] + scale * (brio_rng_double(&rng) - 0.5);
    }
}

static inline void sphere_points(uint64_t seed, size_t n, double *points) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < n; i++) {
        double z = 2 * brio_rng_double(&rng) - 1, a = 6.283185307179586 * brio_rng_double(&rng), r = sqrt(1 - z * z);
        points[3 * i] = r * cos(a), points[3 * i + 1] = r * sin(a), points[3 * i + 2] = z;
    }
}

/* A depth map of side^2 pixels of some bumps, its rays in single precision and its depths in steps, as depth cameras have
 * them: many points are coplanar, and many rows collinear. */
static inline void depth_points(uint64_t seed, size_t side, double *points) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < side * side; i++) {
        double u = (double)(i % side) / (double)side - 0.5, v = (double)(i / side) / (double)side - 0.5;
        double depth = 2 + 0.3 * sin(9 * u) * cos(7 * v) + 0.01 * brio_rng_double(&rng);
        float steps = (float)(floor(depth * 128) / 128);
        points[3 * i] = (float)u * steps, points[3 * i + 1] = (float)v * steps, points[3 * i + 2] = steps;
    }
}

static inline void torus_points(uint64_t seed, size_t n, double *points) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < n;) {
        double u = 6.283185307179586 * brio_rng_double(&rng), v = 6.283185307179586 * brio_rng_double(&rng);
        if (brio_rng_double(&rng) * 1.4 > 1 + 0.4 * cos(v)) continue;
        points[3 * i] = (1 + 0.4 * cos(v)) * cos(u), points[3 * i + 1] = (1 + 0.4 * cos(v)) * sin(u);
        points[3 * i + 2] = 0.4 * sin(v);
        i++;
    }
}

/* A random permutation applied to rows; to[i] = new place of row i. */
static inline void shuffle_points(uint64_t seed, size_t n, const double *from, double *to_points, size_t *to) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < n; i++) to[i] = i;
    for (size_t i = n; i > 1; i--) {
        size_t j = brio_rng_below(&rng, (uint32_t)i), swap = to[i - 1];
        to[i - 1] = to[j], to[j] = swap;
    }
    for (size_t i = 0; i < n; i++) memcpy(to_points + 3 * to[i], from + 3 * i, 3 * sizeof *from);
}

#endif
