/* Computes the shares of one tetrahedron in each lane of vector registers. One source file for each instruction set
 * includes this file after the operations on its lanes.
 *
 * Every instruction set runs the same sequence of operations, and so computes the same bits.
 *
 * Errors, with u = 2^-53, M the greatest squared edge, W = 1 + the greatest |w_i - w_j| / |ij|^2 (1 without weights), R
 * the distance of the centre from vertex 0, and R' = sqrt(2 R^2 + 2 M). Differences, squares and products have relative
 * errors of a few u. So
 * - the centre is off by at most d = 70 u Q W R', where Q = |01| |02| |03| / det: determinant and numerators carry 10
 *   and 20 u of their permanents, which Hadamard's inequality bounds;
 * - an area vector n = a x b is off by v = 4 u |a| |b|, a height over a facet by d + R' v / |n|, and 1 / |n|^2 by
 *   2 v / |n| of it; ki . kj by 4 u |ki| |kj|;
 * - so the terms of a facet are off by at most (4 u R' C + G (d + 3 R' v / |n|)) / (24 |n|). Here G is the sum of
 *   |ij|^2 |ki . kj| over its edges, and C that of |ij|^2 |ki| |kj|: the product of the edges times their sum. With
 *   weights G is the sum of 4 W |ij|^2 D, and 8 W^2 times the squared sum of squares bounds C.
 * This holds where v is at most RAW / 3 of each |n|; a facet whose corners are on a line up to rounding says nothing.
 * Squares of sums are at most as many times the sum of squares. The bound is twice that of the four facets, which
 * covers the rounding of the sum and of the bound. */
#include "cells/shares.h"
#include <assert.h>
#include <math.h>

/* FINE: centres whose error is more than this part of R' need more than doubles. RAW: the part of each |n| that 3 v may
 * be. Both chosen. LEAST, MOST: squared edges between these keep all products within the range of doubles, those of the
 * bound included: there |n|^2 is at least 2^-408, the squared sum 4 |n|^4, and d + 3 R' v / |n| at least 2^-129. */
static const double FINE = 0x1p-40, RAW = 0x1p-6, LEAST = 0x1p-160, MOST = 0x1p160, UNIT = 0x1p-53;

/* Edges are numbered 01 02 03 12 13 23, facets by the vertex opposite to them. */
static const uint8_t ENDS[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
static const uint8_t EDGE_OF[4][4] = {{6, 0, 1, 2}, {0, 6, 3, 4}, {1, 3, 6, 5}, {2, 4, 5, 6}};
static const uint8_t CORNERS[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

typedef struct {
    lanes first[3], w[4];   /* vertex 0, and the weights */
    lanes way[6][3], at[6]; /* of each edge: the vector, and its square */
    lanes normal[4][3];     /* of each facet: twice its area vector; those of 1 and 3 point to the opposite vertex */
    lanes inverse[4];       /* 1 / |normal|^2 */
    lanes most, least;      /* M, and the least squared edge */
    lanes wide;             /* W */
} solid;

static inline lanes dot(const lanes a[3], const lanes b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross(const lanes a[3], const lanes b[3], lanes out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void load(const brio_share_batch *b, const uint8_t index[LANES], solid *s, const bool weighted) {
    lanes p[4][4];
    for (int i = 0; i < 4; i++) {
        const double *row[LANES];
        double weight[LANES];
        for (int n = 0; n < LANES; n++) row[n] = b->points + 3 * (size_t)b->vertex[index[n]][i];
        load_rows(row, false, p[i]);
        for (int n = 0; weighted && n < LANES; n++) weight[n] = b->weights[b->vertex[index[n]][i]];
        if (weighted) s->w[i] = load_lanes(weight);
    }
    s->most = all(0), s->least = all(__builtin_inf()), s->wide = all(1);
    for (int k = 0; k < 3; k++) s->first[k] = p[0][k];
    for (int e = 0; e < 6; e++) {
        int i = ENDS[e][0], j = ENDS[e][1];
        for (int k = 0; k < 3; k++) s->way[e][k] = p[j][k] - p[i][k];
        s->at[e] = dot(s->way[e], s->way[e]);
        s->most = maximum(s->at[e], s->most);
        s->least = choose(greater(s->least, s->at[e]), s->at[e], s->least);
        if (weighted) s->wide = maximum(all(1) + magnitude(s->w[i] - s->w[j]) / s->at[e], s->wide);
    }
    for (int f = 0; f < 4; f++) {
        int i = CORNERS[f][0];
        cross(s->way[EDGE_OF[i][CORNERS[f][1]]], s->way[EDGE_OF[i][CORNERS[f][2]]], s->normal[f]);
        s->inverse[f] = all(1) / dot(s->normal[f], s->normal[f]);
    }
}

/* Returns whether doubles hold the products of the edges. */
static inline lane_mask is_ordinary(const solid *s) {
    return both(greater(s->least, all(LEAST)), greater(all(MOST), s->most));
}

/* Returns the product of the ways from vertex i to j and k. */
static inline lanes angle(const solid *s, int i, int j, int k) {
    lanes product = dot(s->way[EDGE_OF[i][j]], s->way[EDGE_OF[i][k]]);
    return (i < j) == (i < k) ? product : -product;
}

/* Writes the shares and what bounds their errors.
 *  o    the centre, relative to vertex 0.   off  its squared error.   far  R'^2. */
static inline lanes add_orthoschemes(const solid *s, const lanes o[3], lanes off, lanes far, lanes share[4],
                                     const bool weighted) {
    lanes errors = all(0), tiny = all(UNIT * UNIT) * far;
    lane_mask known = is_ordinary(s);
    for (int i = 0; i < 4; i++) share[i] = all(0);
    for (int f = 0; f < 4; f++) {
        const uint8_t *v = CORNERS[f];
        lanes from[3], height, sum = all(0);
        for (int k = 0; k < 3; k++) {
            from[k] = o[k];
            if (f == 0) from[k] -= s->way[0][k];
        }
        height = dot(from, s->normal[f]);
        if (!(f & 1)) height = -height;
        lanes each = height * s->inverse[f] * all(weighted ? 1.0 / 6 : 1.0 / 24);
        for (int c = 0; c < 3; c++) {
            int i = v[c], j = v[(c + 1) % 3], k = v[(c + 2) % 3];
            lanes square = s->at[EDGE_OF[i][j]];
            if (!weighted) {
                lanes product = square * angle(s, k, i, j), term = product * each;
                share[i] += term, share[j] += term;
                sum += magnitude(product);
                continue;
            }
            lanes half = all(0.5) * (s->w[i] - s->w[j]) / square, part = all(0.5) + half;
            lanes across = all(0.5) * (s->at[EDGE_OF[i][k]] + (s->w[i] - s->w[k])) - part * angle(s, i, j, k);
            lanes product = square * across, term = product * each;
            share[i] += part * term, share[j] += (all(0.5) - half) * term;
            sum += all(4) * s->wide * magnitude(product);
        }
        lanes a = s->at[EDGE_OF[v[0]][v[1]]], b = s->at[EDGE_OF[v[0]][v[2]]], c = s->at[EDGE_OF[v[1]][v[2]]];
        lanes squares = a + b + c, rounded = all(3) * a * b * c * squares;
        if (weighted) rounded = all(64) * s->wide * s->wide * s->wide * s->wide * squares * squares * squares * squares;
        lanes raw = all(144 * UNIT * UNIT) * a * b * s->inverse[f];
        known = both(known, greater(all(RAW * RAW), raw));
        errors += s->inverse[f] * (all(16) * tiny * rounded + sum * sum * (off + raw * far));
    }
    return choose(known, root(all(12.0 * 4 / 576) * errors), all(__builtin_inf()));
}

/* Stores what was found in the lanes of `found`. */
static inline void store(const brio_share_batch *b, const uint8_t index[LANES], unsigned found, const lanes share[4],
                         lanes bound) {
    double out[4][LANES], most[LANES];
    for (int i = 0; i < 4; i++) store_lanes(out[i], share[i]);
    store_lanes(most, bound);
    for (int n = 0; n < LANES; n++) {
        if (!(found >> n & 1)) continue;
        for (int i = 0; i < 4; i++) b->share[index[n]][i] = out[i][n];
        b->bound[index[n]] = most[n];
    }
}

static inline unsigned solve(const brio_share_batch *b, const uint8_t index[LANES], const bool weighted) {
    solid s;
    lanes o[3], at[3], share[4], lift[3], big = all(0);
    load(b, index, &s, weighted);
    for (int e = 0; e < 3; e++) {
        lift[e] = s.at[e];
        if (weighted) lift[e] += s.w[0] - s.w[e + 1];
    }
    lanes det = dot(s.normal[3], s.way[2]), half = all(0.5) / det;
    for (int k = 0; k < 3; k++) {
        o[k] = (lift[0] * s.normal[1][k] - lift[1] * s.normal[2][k] + lift[2] * s.normal[3][k]) * half;
        at[k] = s.first[k] + o[k];
        big = maximum(magnitude(at[k]), big);
    }
    lanes far = all(2) * (dot(o, o) + s.most), flat = s.at[0] * s.at[1] * s.at[2] / (det * det) * s.wide * s.wide;
    lanes part = all(4900 * UNIT * UNIT) * flat;
    lane_mask fine = both(both(greater(all(FINE * FINE), part), greater(det, all(0))), is_ordinary(&s));
    unsigned found = bits_of(both(fine, greater(all(__builtin_inf()), big)));
    lanes bound = add_orthoschemes(&s, o, part * far, far, share, weighted);
    store(b, index, found, share, bound);
    double out[4][LANES];
    for (int k = 0; k < 3; k++) store_lanes(out[k], at[k]);
    store_lanes(out[3], root(part * far) + all(0x1p-52) * big);
    for (int n = 0; n < LANES; n++) {
        if (!(found >> n & 1)) continue;
        for (int k = 0; k < 3; k++) b->centre[index[n]][k] = out[k][n];
        b->error[index[n]] = out[3][n];
    }
    return ~found & ((1u << LANES) - 1);
}

static inline unsigned solve_of_centres(const brio_share_batch *b, const uint8_t index[LANES], const bool weighted) {
    solid s;
    lanes o[3], share[4], off, big = all(0);
    double in[4][LANES];
    load(b, index, &s, weighted);
    for (int n = 0; n < LANES; n++) {
        for (int k = 0; k < 3; k++) in[k][n] = b->centre[index[n]][k];
        in[3][n] = b->error[index[n]];
    }
    for (int k = 0; k < 3; k++) {
        o[k] = load_lanes(in[k]) - s.first[k];
        big = maximum(magnitude(o[k]), big);
    }
    off = load_lanes(in[3]) + all(0x1p-52) * big;
    off = off * off;
    lanes bound = add_orthoschemes(&s, o, off, all(2) * (dot(o, o) + s.most), share, weighted);
    store(b, index, UINT32_MAX, share, bound);
    return 0;
}

typedef unsigned (*solve_lanes)(const brio_share_batch *b, const uint8_t index[LANES], const bool weighted);

/* Solves the tetrahedra of the batch whose bits are set in `some`, LANES at a time. Returns the bits of the tetrahedra
 * that `step` leaves. */
static inline __attribute__((always_inline)) uint64_t solve_some(const brio_share_batch *b, uint64_t some,
                                                                 solve_lanes step, const bool weighted) {
    assert(b->count >= 64 || some >> b->count == 0);
    uint64_t left = 0;
    while (some) {
        uint8_t index[LANES];
        int count = 0;
        for (; count < LANES && some; some &= some - 1) index[count++] = (uint8_t)__builtin_ctzll(some);
        for (int n = count; n < LANES; n++) index[n] = index[0];
        for (unsigned open = step(b, index, weighted); open; open &= open - 1)
            left |= UINT64_C(1) << index[__builtin_ctz(open)];
    }
    return left;
}

static uint64_t find(const brio_share_batch *b, uint64_t some) {
    return b->weights ? solve_some(b, some, solve, true) : solve_some(b, some, solve, false);
}

static void find_of_centres(const brio_share_batch *b, uint64_t some) {
    if (b->weights)
        solve_some(b, some, solve_of_centres, true);
    else
        solve_some(b, some, solve_of_centres, false);
}

const brio_share_engine SHARES = {find, find_of_centres};
