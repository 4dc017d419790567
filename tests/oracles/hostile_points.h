/* Small sets of points, of any finite doubles, where exact arithmetic is needed: grids, grids moved by units in the last place,
 * cospherical points, planes and lines, magnitudes from the least to the greatest double, duplicates; and weights that hide
 * points, tie, or flatten the lifted points. */
#ifndef BRIO_TESTS_HOSTILE_POINTS_H
#define BRIO_TESTS_HOSTILE_POINTS_H

#include "oracle.h"

enum { MOST_POINTS = 12 };

typedef struct {
    size_t n, coordinates; /* 2 or 3 of a point */
    bool weighted;
    double x[3 * MOST_POINTS], w[MOST_POINTS];
} point_set;

static inline double finite_or_zero(double x) {
    return isfinite(x) ? x : 0;
}

static inline double any_double(dice *d) {
    uint64_t bits = roll(d);
    double x;
    memcpy(&x, &bits, sizeof x);
    return finite_or_zero(x);
}

static inline double small_integer(dice *d, uint32_t side) {
    return (double)below(d, side) - (double)(side / 2);
}

/* A coordinate moved by a few units in the last place, or by a power of two that may be the least double. */
static inline double nudged(dice *d, double x) {
    if (one_in(d, 2)) return x;
    if (one_in(d, 2) && (x != 0 || one_in(d, 60))) return nextafter(x, one_in(d, 2) ? 1e9 : -1e9);
    return x + ldexp(small_integer(d, 5), -(int)(20 + below(d, one_in(d, 60) ? 1055 : 40)));
}

/* --- kinds of coordinates --- */

static inline void grid_points(dice *d, point_set *s) {
    uint32_t side = 2 + below(d, 4);
    for (size_t i = 0; i < s->coordinates * s->n; i++) s->x[i] = small_integer(d, side);
}

static inline void near_grid_points(dice *d, point_set *s) {
    grid_points(d, s);
    for (size_t i = 0; i < s->coordinates * s->n; i++) s->x[i] = nudged(d, s->x[i]);
}

/* On the sphere of radius 3, or the circle of radius 25, all integers; sometimes nudged. */
static inline void round_points(dice *d, point_set *s) {
    static const double sphere[2][3] = {{3, 0, 0}, {1, 2, 2}}, circle[4][2] = {{25, 0}, {24, 7}, {20, 15}, {15, 20}};
    bool nudge = one_in(d, 3);
    for (size_t i = 0; i < s->n; i++) {
        const double *p = s->coordinates == 3 ? sphere[below(d, 5) != 0] : circle[below(d, 4)];
        uint32_t turn = below(d, 3);
        for (size_t k = 0; k < s->coordinates; k++) {
            double x = p[(k + turn) % s->coordinates];
            s->x[s->coordinates * i + k] = one_in(d, 2) ? x : -x;
        }
    }
    for (size_t i = 0; nudge && i < s->coordinates * s->n; i++)
        if (one_in(d, 8)) s->x[i] = nudged(d, s->x[i]);
}

/* On a line, a plane, or nearly so. */
static inline void flat_points(dice *d, point_set *s) {
    uint32_t side = 2 + below(d, 5), normal = below(d, 3);
    double a = small_integer(d, 5), b = one_in(d, 3) ? 0 : small_integer(d, 5), c = small_integer(d, 3);
    bool line = one_in(d, 4), nudge = one_in(d, 3);
    for (size_t i = 0; i < s->n; i++) {
        double *p = s->x + s->coordinates * i, u = small_integer(d, side), v = line ? 2 * u : small_integer(d, side);
        if (s->coordinates == 2) {
            p[0] = u, p[1] = a * u + c;
        } else {
            p[normal] = a * u + b * v + c, p[(normal + 1) % 3] = u, p[(normal + 2) % 3] = v;
        }
    }
    if (nudge && s->n) {
        size_t at = below(d, (uint32_t)(s->coordinates * s->n));
        s->x[at] = nudged(d, s->x[at]);
    }
}

static inline void uniform_doubles(dice *d, point_set *s) {
    for (size_t i = 0; i < s->coordinates * s->n; i++) s->x[i] = (double)(roll(d) >> 11) * 0x1p-53;
}

/* Small integers times powers of two of a few, or any, exponents. Their exact numbers are long: few points. */
static inline void mixed_magnitudes(dice *d, point_set *s) {
    int exponent[3] = {(int)below(d, 2090) - 1074, one_in(d, 2) ? -1074 : (int)below(d, 60) - 30, 1019};
    bool bits = one_in(d, 4);
    if (s->n > 7) s->n = 7;
    for (size_t i = 0; i < s->coordinates * s->n; i++)
        s->x[i] = bits ? any_double(d) : ldexp(small_integer(d, 6), exponent[below(d, 3)]);
}

/* --- what is done to all of them --- */

/* Moved far away, where grids of units in the last place come about. */
static inline void move_away(dice *d, point_set *s) {
    double by = ldexp(1, 30 + (int)below(d, 24));
    for (size_t i = 0; i < s->coordinates * s->n; i++) s->x[i] += by;
}

/* Scaled to the ends of what doubles can hold, all axes or one; returns the exponent for the weights. */
static inline int scale_points(dice *d, point_set *s) {
    static const int ends[] = {-1074, -1060, -540, -500, 300, 500, 1010};
    int e = ends[below(d, sizeof ends / sizeof *ends)];
    size_t axis = one_in(d, 12) ? below(d, (uint32_t)s->coordinates) : SIZE_MAX;
    if (axis != SIZE_MAX && s->n > 7) s->n = 7;
    for (size_t i = 0; i < s->coordinates * s->n; i++)
        if (axis == SIZE_MAX || i % s->coordinates == axis) s->x[i] = finite_or_zero(ldexp(s->x[i], e));
    return axis == SIZE_MAX ? 2 * e : 0;
}

static inline void copy_some(dice *d, point_set *s) {
    for (size_t i = 1; i < s->n; i++)
        if (one_in(d, 12))
            memmove(s->x + s->coordinates * i, s->x + s->coordinates * below(d, (uint32_t)i),
                    s->coordinates * sizeof *s->x);
    for (size_t i = 0; i < s->coordinates * s->n; i++)
        if (s->x[i] == 0 && one_in(d, 4)) s->x[i] = -0.0;
}

static inline void give_weights(dice *d, point_set *s, int exponent) {
    uint32_t kind = one_in(d, 30) ? 5 : below(d, 5), most = 1 + below(d, 8);
    for (size_t i = 0; i < s->n; i++) {
        const double *p = s->x + s->coordinates * i;
        double norm = p[0] * p[0] + p[1] * p[1] + (s->coordinates == 3 ? p[2] * p[2] : 0);
        double w = one_in(d, 3) ? 0 : (double)below(d, most) - (kind == 1 ? 3 : 0);
        if (kind == 2) w = 50 * w;
        if (kind == 3) w = nudged(d, w);
        w = finite_or_zero(ldexp(w, exponent));
        if (kind == 4) w = finite_or_zero(norm + (one_in(d, 8) ? w : 0)); /* lifted points are coplanar, or nearly so */
        if (kind == 5 && one_in(d, 4)) w = any_double(d);
        s->w[i] = w;
    }
    if (kind == 5 && s->n > 7) s->n = 7;
}

/** A set of at most MOST_POINTS points.   s  coordinates and weighted are set. */
static inline void hostile_points(dice *d, point_set *s) {
    static void (*const kinds[])(dice *, point_set *) = {grid_points,  near_grid_points, near_grid_points, round_points,
                                                         round_points, flat_points,      uniform_doubles};
    int exponent = 0;
    memset(s->x, 0, sizeof s->x);
    s->n = one_in(d, 8) ? below(d, MOST_POINTS + 1) : 5 + below(d, MOST_POINTS - 4);
    if (one_in(d, 40)) { /* long numbers take most of the time */
        mixed_magnitudes(d, s);
    } else {
        kinds[below(d, sizeof kinds / sizeof *kinds)](d, s);
        if (one_in(d, 8)) move_away(d, s);
        if (one_in(d, 5)) exponent = scale_points(d, s);
    }
    copy_some(d, s);
    if (s->weighted) give_weights(d, s, exponent);
}

#endif
