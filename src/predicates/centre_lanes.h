/* Centres side by side in the lanes of vector registers; included by one source file an instruction set, after the
 * operations on its lanes.
 *
 * The operations are those of circumcentre.c one by one, so that the bits are the same: first in doubles, then what
 * these leave uncertain in double-doubles, LANES of a batch together each time. What is still uncertain, or too large
 * or small for this, is left to circumcentre.c. */
#include "predicates/centre_bounds.h"
#include "predicates/circumcentre.h"

/* Four points a lane, the lexicographically first one in front. Lengths are in a unit, a power of two, in which the
 * differences to the first point are at most 1. */
typedef struct {
    lanes at[4][3], weight[4];
    lanes r[3][3], more[3]; /* differences to the first point */
    lanes first[3], unit;   /* in the caller's lengths */
    lane_mask ordinary;     /* the unit is neither too large nor too small */
} four_points;

/* Swaps the points i and j in the lanes where i is lexicographically greater. */
static inline void order_two(four_points *p, int i, int j, const bool weighted) {
    lanes *a = p->at[i], *b = p->at[j];
    lane_mask later = either(greater(a[1], b[1]), both(equal(a[1], b[1]), greater(a[2], b[2])));
    lane_mask swap = either(greater(a[0], b[0]), both(equal(a[0], b[0]), later));
    for (int k = 0; k < 3; k++) {
        lanes low = choose(swap, b[k], a[k]);
        b[k] = choose(swap, a[k], b[k]);
        a[k] = low;
    }
    if (!weighted) return;
    lanes low = choose(swap, p->weight[j], p->weight[i]);
    p->weight[j] = choose(swap, p->weight[i], p->weight[j]);
    p->weight[i] = low;
}

static inline void scale_points(four_points *p, const bool weighted) {
    lanes most = all(0);
    for (int i = 1; i < 4; i++)
        for (int k = 0; k < 3; k++) most = maximum(most, magnitude(p->at[i][k] * all(0.5) - p->at[0][k] * all(0.5)));
    p->unit = all(4) * leading_power(most);
    p->ordinary = both(greater(p->unit, all(0x1p-400)), greater(all(0x1p400), p->unit));
    lanes scale = all(1) / p->unit;
    for (int k = 0; k < 3; k++) p->first[k] = p->at[0][k];
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) p->at[i][k] *= scale;
        if (weighted) p->weight[i] = p->weight[i] * scale * scale;
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) p->r[i][k] = p->at[i + 1][k] - p->at[0][k];
        if (weighted) p->more[i] = p->weight[i + 1] - p->weight[0];
    }
}

static inline void load_points(const brio_centre_batch *b, const uint8_t index[LANES], four_points *p,
                               const bool weighted) {
    for (int i = 0; i < 4; i++) {
        const double *row[LANES];
        double weight[LANES];
        lanes columns[4];
        for (int n = 0; n < LANES; n++) row[n] = b->points + 3 * (size_t)b->vertex[index[n]][i];
        load_rows(row, false, columns);
        for (int k = 0; k < 3; k++) p->at[i][k] = columns[k];
        for (int n = 0; weighted && n < LANES; n++) weight[n] = b->weights[b->vertex[index[n]][i]];
        if (weighted) p->weight[i] = load_lanes(weight);
    }
    order_two(p, 0, 1, weighted), order_two(p, 2, 3, weighted);
    order_two(p, 0, 2, weighted), order_two(p, 1, 3, weighted);
    order_two(p, 1, 2, weighted);
    scale_points(p, weighted);
}

/* Magnitudes of the numerators and the determinant with every term positive. */
typedef struct {
    lanes numerator[3], determinant;
} lane_permanents;

static inline void find_permanents(const four_points *p, lane_permanents *out, const bool weighted) {
    const lanes(*r)[3] = (const lanes(*)[3])p->r;
    out->determinant = all(0);
    for (int k = 0; k < 3; k++) out->numerator[k] = all(0);
    for (int i = 0; i < 3; i++) {
        const lanes *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        lanes x = magnitude(u[1] * v[2]) + magnitude(u[2] * v[1]), y = magnitude(u[2] * v[0]) + magnitude(u[0] * v[2]),
              z = magnitude(u[0] * v[1]) + magnitude(u[1] * v[0]);
        lanes lift = r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2];
        if (weighted) lift += magnitude(p->more[i]);
        out->numerator[0] += lift * x, out->numerator[1] += lift * y, out->numerator[2] += lift * z;
        if (i == 0) out->determinant = magnitude(r[0][0]) * x + magnitude(r[0][1]) * y + magnitude(r[0][2]) * z;
    }
}

/* Stores the centres whose error is within the goal; bits of the others. */
static inline unsigned divide(const four_points *p, const lanes numerator[3], lanes determinant,
                              const lane_permanents *permanent, double relative, const uint8_t index[LANES],
                              double *centre) {
    lanes bound = all(relative), tiny = all(0x1p-900), round = all(1 + 0x1p-50);
    lanes slack = magnitude(determinant) - bound * permanent->determinant - tiny, inverse = all(1) / slack;
    lanes share = bound * permanent->determinant * inverse * round + all(0x1p-52), most = all(0), error[3];
    lane_mask sure = both(p->ordinary, greater(slack, all(0)));
    double out[3][LANES];
    for (int k = 0; k < 3; k++) {
        lanes offset = all(0.5) * (numerator[k] / determinant), size = magnitude(offset);
        error[k] = all(0.5) * (bound * permanent->numerator[k] + tiny) * inverse * round + size * share;
        most = maximum(most, size);
        lanes x = p->first[k] + offset * p->unit;
        sure = both(sure, greater(all(__builtin_inf()), magnitude(x)));
        store_lanes(out[k], x);
    }
    lanes goal = all(BRIO_FINE_GOAL) * most;
    for (int k = 0; k < 3; k++) sure = both(sure, either(greater(goal, error[k]), equal(goal, error[k])));
    unsigned found = bits_of(sure);
    for (int n = 0; n < LANES; n++)
        for (int k = 0; k < 3 && found >> n & 1; k++) centre[3 * index[n] + k] = out[k][n];
    return ~found & ((1u << LANES) - 1);
}

static inline unsigned solve_doubles(const brio_centre_batch *b, const uint8_t index[LANES], const bool weighted) {
    four_points p;
    lane_permanents permanent;
    lanes numerator[3] = {all(0), all(0), all(0)}, determinant = all(0);
    load_points(b, index, &p, weighted);
    find_permanents(&p, &permanent, weighted);
    for (int i = 0; i < 3; i++) {
        const lanes(*r)[3] = (const lanes(*)[3])p.r;
        const lanes *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        lanes lift = r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2];
        if (weighted) lift -= p.more[i];
        lanes x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        numerator[0] += lift * x, numerator[1] += lift * y, numerator[2] += lift * z;
        if (i == 0) determinant = r[0][0] * x + r[0][1] * y + r[0][2] * z;
    }
    return divide(&p, numerator, determinant, &permanent, BRIO_DOUBLE_BOUND, index, b->centre);
}

/* --- double-doubles in lanes: double_double.h --- */

typedef struct {
    lanes hi, lo;
} wide;

static inline wide wide_difference(lanes a, lanes b) {
    lanes s = a - b, t = s - a;
    return (wide){s, (a - (s - t)) + (-b - t)};
}
static inline wide wide_fast_sum(lanes a, lanes b) {
    lanes s = a + b;
    return (wide){s, b - (s - a)};
}
static inline wide wide_multiply(wide x, wide y) {
    lanes p = x.hi * y.hi;
    return wide_fast_sum(p, multiply_subtract(x.hi, y.hi, p) + (x.hi * y.lo + x.lo * y.hi));
}
static inline wide wide_add(wide x, wide y) {
    lanes s = x.hi + y.hi, t = s - x.hi;
    return wide_fast_sum(s, ((x.hi - (s - t)) + (y.hi - t)) + (x.lo + y.lo));
}
static inline wide wide_subtract(wide x, wide y) {
    return wide_add(x, (wide){-y.hi, -y.lo});
}
/* x y - z w. */
static inline wide wide_minor(wide x, wide y, wide z, wide w) {
    return wide_subtract(wide_multiply(x, y), wide_multiply(z, w));
}

static inline unsigned solve_wide(const brio_centre_batch *b, const uint8_t index[LANES], const bool weighted) {
    four_points p;
    lane_permanents permanent;
    wide r[3][3], numerator[3], determinant = {all(0), all(0)};
    load_points(b, index, &p, weighted);
    find_permanents(&p, &permanent, weighted);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r[i][k] = wide_difference(p.at[i + 1][k], p.at[0][k]);
    for (int k = 0; k < 3; k++) numerator[k] = determinant;
    for (int i = 0; i < 3; i++) {
        const wide *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        wide lift = wide_add(wide_add(wide_multiply(r[i][0], r[i][0]), wide_multiply(r[i][1], r[i][1])),
                             wide_multiply(r[i][2], r[i][2]));
        if (weighted) lift = wide_subtract(lift, wide_difference(p.weight[i + 1], p.weight[0]));
        for (int k = 0; k < 3; k++) {
            int m = (k + 1) % 3, n = (k + 2) % 3;
            wide cross = wide_minor(u[m], v[n], u[n], v[m]);
            numerator[k] = wide_add(numerator[k], wide_multiply(lift, cross));
            if (i == 0) determinant = wide_add(determinant, wide_multiply(r[0][k], cross));
        }
    }
    lanes high[3] = {numerator[0].hi, numerator[1].hi, numerator[2].hi};
    return divide(&p, high, determinant.hi, &permanent, BRIO_DD_BOUND, index, b->centre);
}

/* --- a batch --- */

typedef unsigned (*solve_lanes)(const brio_centre_batch *b, const uint8_t index[LANES], const bool weighted);

/* Solves those of the batch whose bits are set, LANES at a time; bits of those without an answer. */
static inline __attribute__((always_inline)) uint64_t solve_some(const brio_centre_batch *b, uint64_t some,
                                                                 solve_lanes solve, const bool weighted) {
    uint64_t left = 0;
    while (some) {
        uint8_t index[LANES];
        int count = 0;
        for (; count < LANES && some; some &= some - 1) index[count++] = (uint8_t)__builtin_ctzll(some);
        for (int n = count; n < LANES; n++) index[n] = index[0];
        for (unsigned open = solve(b, index, weighted); open; open &= open - 1)
            left |= UINT64_C(1) << index[__builtin_ctz(open)];
    }
    return left;
}

static inline __attribute__((always_inline)) uint64_t find(const brio_centre_batch *b, const bool weighted) {
    uint64_t every = b->count < 64 ? (UINT64_C(1) << b->count) - 1 : UINT64_MAX;
    uint64_t left = solve_some(b, every, solve_doubles, weighted);
    return solve_some(b, left, solve_wide, weighted);
}

uint64_t FIND_CENTRES(const brio_centre_batch *b) {
    return b->weights ? find(b, true) : find(b, false);
}
