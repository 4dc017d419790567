/* Points of surfaces that tiles or ranks triangulate, and the folder of these. */
#ifndef BRIO_TESTS_SURFACE_POINTS_H
#define BRIO_TESTS_SURFACE_POINTS_H

#include "points.h"
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST = 6000 };

static double points[3 * MOST];
static char folder[64];

static inline size_t files_left(void) {
    DIR *d = opendir(folder);
    size_t n = 0;
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) n += e->d_name[0] != '.';
    if (d) closedir(d);
    return n;
}

/* Fills points of a kind: uniform, clusters, a sphere, few places (duplicates), a grid, a scan, a noisy shell, a plane
 * with some above, a plane. Returns their number, at most n. */
static inline size_t make_points(uint64_t seed, size_t n, int kind) {
    brio_rng rng = brio_rng_new(seed);
    size_t side = (size_t)cbrt((double)n);
    switch (kind) {
    case 0:
        uniform_points(seed, n, points);
        return n;
    case 1:
        clustered_points(seed, n, points);
        return n;
    case 2:
        sphere_points(seed, n, points);
        return n;
    case 3:
        integer_points(seed, n, 12, points);
        return n;
    case 4:
        n = side * side * side;
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0, at = i; k < 3; k++, at /= side) points[3 * i + k] = (double)(at % side);
        return n;
    case 5:
        side = (size_t)sqrt((double)n);
        depth_points(seed, side, points);
        return side * side;
    case 6:
        sphere_points(seed, n, points);
        for (size_t i = 0; i < 3 * n; i++) points[i] *= 1 + 0.02 * brio_rng_double(&rng);
        return n;
    case 7:
        integer_points(seed, n, 40, points);
        for (size_t i = 0; i < n; i++)
            if (i % 31) points[3 * i + 2] = 3;
        return n;
    default:
        uniform_points(seed, n, points);
        for (size_t i = 0; i < n; i++) points[3 * i + 2] = 1;
        return n;
    }
}

#endif
