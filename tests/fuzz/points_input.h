/* Points out of an input's bytes: small integers in space, near ties among them, and hostile doubles. */
#ifndef BRIO_TESTS_POINTS_INPUT_H
#define BRIO_TESTS_POINTS_INPUT_H

#include "brute_check.h"
#include "fuzz.h"
#include "trial.h"

/** Up to `most` sites on a grid of 4 x 4 x 4 places; or near such places, so that much is nearly cospherical. With weights
 *  or without; weights tie often. */
static inline void fuzz_sites(fuzz_input *in, size_t most, site_set *s) {
    uint8_t mode = fuzz_byte(in);
    int64_t step = mode & 1 ? 16 : 1, heavy = mode & 4 ? 1000 : 1;
    memset(s, 0, sizeof *s);
    s->weighted = mode & 2;
    s->n = fuzz_below(in, most + 1);
    for (size_t i = 0; i < s->n; i++) {
        uint8_t place = fuzz_byte(in), off = mode & 1 ? fuzz_byte(in) : 0;
        for (int k = 0; k < 3; k++) s->p[i].x[k] = step * (place >> 2 * k & 3) + (off >> 2 * k & 3) % 3;
        if (s->weighted) s->p[i].w = heavy * (fuzz_byte(in) % 8);
    }
    s->hull_volume = hull_volume(s);
}

/** The sites as doubles, moved by whole numbers and scaled by a power of two: neither rounds. */
static inline void sites_as_doubles(fuzz_input *in, const site_set *s, double *points, double *weights) {
    static const double moves[] = {0, 0, -2, 1 << 20, -0x1p45};
    double move = moves[fuzz_below(in, 5)];
    int scale = fuzz_flag(in) ? (int)(fuzz_byte(in) - 128) * 3 : 0;
    for (size_t i = 0; i < s->n; i++) {
        for (size_t k = 0; k < 3; k++) points[3 * i + k] = ldexp((double)s->p[i].x[k] + move, scale);
        weights[i] = ldexp((double)s->p[i].w, 2 * scale);
    }
}

/** Options of every kind.   edges  room for 16 pairs. */
static inline trial_options fuzz_options(fuzz_input *in, size_t n, uint32_t *edges) {
    static const double ratios[] = {0, 0.5, 0.01, 0.9};
    trial_options o = {0};
    o.order = (int)fuzz_below(in, TRIAL_ORDERS);
    o.locate = (brio_location)fuzz_below(in, BRIO_LOCATION_END);
    uint8_t bits = fuzz_byte(in);
    o.round_ratio = ratios[bits & 3];
    o.block_size = bits >> 2 & 3;
    o.record_every = bits & 16 ? BRIO_RECORD_ROUNDS : bits & 32 ? 1 : 0;
    o.all_conflicts = bits >> 6 & 1;
    o.seed = fuzz_byte(in);
    if ((o.locate == BRIO_LOCATION_TRACE || o.locate == BRIO_LOCATION_NEIGHBOUR) && n) {
        o.num_edges = fuzz_below(in, 17), o.edges = edges;
        for (size_t i = 0; i < 2 * o.num_edges; i++) edges[i] = (uint32_t)fuzz_below(in, n);
    }
    return o;
}

#endif
