/* Points of the plane out of an input's bytes: small integers, near ties among them. */
#ifndef BRIO_TESTS_PLANE_INPUT_H
#define BRIO_TESTS_PLANE_INPUT_H

#include "fuzz.h"
#include "plane_brute.h"

/** Up to `most` sites on a grid of 4 x 4 places, or near such places, or on a line; with weights or without. */
static inline void fuzz_plane_sites(fuzz_input *in, uint8_t mode, size_t most, plane_set *s) {
    int64_t step = mode & 1 ? 16 : 1;
    s->weighted = mode & 2;
    s->n = fuzz_below(in, most + 1);
    for (size_t i = 0; i < s->n; i++) {
        uint8_t place = fuzz_byte(in);
        s->p[i].x = step * (place & 3) + (mode & 1 ? (place >> 4 & 3) % 3 : 0);
        s->p[i].y = mode & 4 ? 2 * s->p[i].x + 1 : step * (place >> 2 & 3) + (mode & 1 ? (place >> 6) % 3 : 0);
        s->p[i].w = s->weighted ? fuzz_byte(in) % 8 * (mode & 8 ? 100 : 1) : 0;
    }
}

/** The same as doubles: they do not round. */
static inline void plane_sites_as_doubles(const plane_set *s, double *points, double *weights) {
    for (size_t i = 0; i < s->n; i++) {
        points[2 * i] = (double)s->p[i].x, points[2 * i + 1] = (double)s->p[i].y;
        weights[i] = (double)s->p[i].w;
    }
}

#endif
