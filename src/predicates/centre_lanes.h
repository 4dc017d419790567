/* Computes one centre in each lane of vector registers. One source file for each instruction set includes this file
 * after the operations on its lanes.
 *
 * Sort the four points lexicographically into a, and b, c, d relative to a. The lift l of a relative point p is |p|^2
 * minus the difference of its weight and that of a. The centre is
 *     a + (l_b c x d + l_c d x b + l_d b x c) / (2 det [b, c, d]).
 * Numerators and determinant carry an error of a few units in the last place of their permanents. Where this error
 * makes the quotient less accurate than the goal, pairs of doubles evaluate the formula again. Each step solves LANES
 * tetrahedra of a batch. circumcentre.c solves the tetrahedra that are still uncertain, too large or too small.
 *
 * Every instruction set runs the same sequence of operations, and so computes the same bits. Only the error of a
 * product, which is exact, uses a fused operation. */
#include "predicates/circumcentre.h"
#include "predicates/lane_pairs.h"
#include <assert.h>

/* Derived: first-order error of each expression relative to its permanent, u = 2^-53. In doubles a path has at most 20
 * roundings, 20 u; in pairs the error is at most 80 u^2, below 2^-99 = 128 u^2. */
static const double DOUBLE_BOUND = 20 * 0x1p-53, PAIR_BOUND = 0x1p-99;

/* TINY exceeds every error by underflow. ROUNDED, as a factor, covers the rounding of a bound. */
static const double TINY = 0x1p-900, ROUNDED = 1 + 0x1p-50;

/* Four points in each lane, in lexicographic order. */
typedef struct {
    lanes at[4][3], weight[4];
} four_points;

/* Four points in each lane, with lengths divided by a unit. The unit is a power of two, chosen so that the differences
 * to the first point are at most 1. */
typedef struct {
    four_points p;
    lanes r[3][3], more[3]; /* differences to the first point: of positions, of weights */
    lanes first[3], unit;   /* the first point and the unit, in the caller's lengths */
    lane_mask ordinary;     /* the unit is in (2^-400, 2^400) */
} scaled_points;

/* --- points --- */

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
}

static inline void load_scaled(const brio_centre_batch *b, const uint8_t index[LANES], scaled_points *s,
                               const bool weighted) {
    four_points *p = &s->p;
    lanes most = all(0);
    load_points(b, index, p, weighted);
    for (int i = 1; i < 4; i++)
        for (int k = 0; k < 3; k++) most = maximum(most, magnitude(p->at[i][k] * all(0.5) - p->at[0][k] * all(0.5)));
    s->unit = all(4) * leading_power(most);
    s->ordinary = both(greater(s->unit, all(0x1p-400)), greater(all(0x1p400), s->unit));
    lanes scale = all(1) / s->unit;
    for (int k = 0; k < 3; k++) s->first[k] = p->at[0][k];
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) p->at[i][k] *= scale;
        if (weighted) p->weight[i] = p->weight[i] * scale * scale;
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) s->r[i][k] = p->at[i + 1][k] - p->at[0][k];
        if (weighted) s->more[i] = p->weight[i + 1] - p->weight[0];
    }
}

/* --- the formula --- */

/* Numerators and determinant; or their permanents, the same expressions with every term positive. */
typedef struct {
    lanes numerator[3], determinant;
} fraction;

static inline lanes square_of(const lanes r[3]) {
    return r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
}

static inline void evaluate(const lanes r[3][3], const lanes lift[3], fraction *f) {
    f->determinant = all(0);
    for (int k = 0; k < 3; k++) f->numerator[k] = all(0);
    for (int i = 0; i < 3; i++) {
        const lanes *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        lanes x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        f->numerator[0] += lift[i] * x, f->numerator[1] += lift[i] * y, f->numerator[2] += lift[i] * z;
        if (i == 0) f->determinant = r[0][0] * x + r[0][1] * y + r[0][2] * z;
    }
}

static inline void find_permanents(const scaled_points *s, fraction *out, const bool weighted) {
    const lanes(*r)[3] = (const lanes(*)[3])s->r;
    out->determinant = all(0);
    for (int k = 0; k < 3; k++) out->numerator[k] = all(0);
    for (int i = 0; i < 3; i++) {
        const lanes *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        lanes x = magnitude(u[1] * v[2]) + magnitude(u[2] * v[1]), y = magnitude(u[2] * v[0]) + magnitude(u[0] * v[2]),
              z = magnitude(u[0] * v[1]) + magnitude(u[1] * v[0]);
        lanes lift = square_of(r[i]);
        if (weighted) lift += magnitude(s->more[i]);
        out->numerator[0] += lift * x, out->numerator[1] += lift * y, out->numerator[2] += lift * z;
        if (i == 0) out->determinant = magnitude(r[0][0]) * x + magnitude(r[0][1]) * y + magnitude(r[0][2]) * z;
    }
}

/* Stores the error bounds of the centres `at`.   error  the error bounds of the offsets, in the unit.   found  bit n:
 * lane n holds a centre. */
static inline void store_errors(const scaled_points *s, const lanes at[3], lanes error, unsigned found,
                                const uint8_t index[LANES], double *out) {
    double bound[LANES];
    lanes far = all(0);
    for (int k = 0; k < 3; k++) far = maximum(far, magnitude(at[k]));
    store_lanes(bound, error * s->unit + all(0x1p-53) * far);
    for (int n = 0; n < LANES; n++)
        if (found >> n & 1) out[index[n]] = bound[n];
}

/* Stores the centres whose error is within the goal, and returns the bits of the other lanes. */
static inline unsigned divide(const scaled_points *s, const fraction *f, const fraction *permanent, double relative,
                              const uint8_t index[LANES], const brio_centre_goal *goal) {
    lanes bound = all(relative), tiny = all(TINY), round = all(ROUNDED), infinite = all(__builtin_inf());
    lanes slack = magnitude(f->determinant) - bound * permanent->determinant - tiny, inverse = all(1) / slack;
    lanes share = bound * permanent->determinant * inverse * round + all(0x1p-52), most = all(0), worst = all(0), at[3];
    lane_mask finite = equal(slack, slack);
    double out[3][LANES];
    for (int k = 0; k < 3; k++) {
        lanes offset = all(0.5) * (f->numerator[k] / f->determinant), size = magnitude(offset);
        lanes error = all(0.5) * (bound * permanent->numerator[k] + tiny) * inverse * round + size * share;
        worst = maximum(worst, error);
        most = maximum(most, size);
        at[k] = s->first[k] + offset * s->unit;
        finite = both(finite, greater(infinite, magnitude(at[k])));
    }
    lanes least = all(goal->relative) * most;
    lane_mask within = both(either(greater(least, worst), equal(least, worst)), greater(infinite, most));
    unsigned found = bits_of(both(both(s->ordinary, greater(slack, all(0))), within));
    store_lanes(out[0], choose(finite, at[0], all(__builtin_nan(""))));
    store_lanes(out[1], at[1]);
    store_lanes(out[2], at[2]);
    for (int n = 0; n < LANES; n++)
        for (size_t k = 0; k < 3 && found >> n & 1; k++) goal->centre[goal->stride * index[n] + k] = out[k][n];
    if (goal->error) store_errors(s, at, worst, found, index, goal->error);
    return ~found & ((1u << LANES) - 1);
}

static inline unsigned solve_doubles(const brio_centre_batch *b, const uint8_t index[LANES],
                                     const brio_centre_goal *goal, const bool weighted) {
    scaled_points s;
    fraction permanent, f;
    lanes lift[3];
    load_scaled(b, index, &s, weighted);
    find_permanents(&s, &permanent, weighted);
    for (int i = 0; i < 3; i++) {
        lift[i] = square_of(s.r[i]);
        if (weighted) lift[i] -= s.more[i];
    }
    evaluate((const lanes(*)[3])s.r, lift, &f);
    return divide(&s, &f, &permanent, DOUBLE_BOUND, index, goal);
}

static inline unsigned solve_pairs(const brio_centre_batch *b, const uint8_t index[LANES], const brio_centre_goal *goal,
                                   const bool weighted) {
    scaled_points s;
    fraction permanent;
    lane_pair r[3][3], numerator[3], determinant = {all(0), all(0)};
    load_scaled(b, index, &s, weighted);
    find_permanents(&s, &permanent, weighted);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) r[i][k] = pair_difference(s.p.at[i + 1][k], s.p.at[0][k]);
    for (int k = 0; k < 3; k++) numerator[k] = determinant;
    for (int i = 0; i < 3; i++) {
        const lane_pair *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        lane_pair lift = pair_add(pair_add(pair_multiply(r[i][0], r[i][0]), pair_multiply(r[i][1], r[i][1])),
                                  pair_multiply(r[i][2], r[i][2]));
        if (weighted) lift = pair_subtract(lift, pair_difference(s.p.weight[i + 1], s.p.weight[0]));
        for (int k = 0; k < 3; k++) {
            int m = (k + 1) % 3, n = (k + 2) % 3;
            lane_pair cross = pair_subtract(pair_multiply(u[m], v[n]), pair_multiply(u[n], v[m]));
            numerator[k] = pair_add(numerator[k], pair_multiply(lift, cross));
            if (i == 0) determinant = pair_add(determinant, pair_multiply(r[0][k], cross));
        }
    }
    fraction high = {{numerator[0].hi, numerator[1].hi, numerator[2].hi}, determinant.hi};
    return divide(&s, &high, &permanent, PAIR_BOUND, index, goal);
}

/* Solves in doubles, unscaled and without weights. Bounds the permanents by the largest difference in each coordinate.
 * Stores the centres within the goal and their squared distances from the points; returns the bits of the other
 * lanes. */
static inline unsigned solve_roughly(const brio_centre_batch *b, const uint8_t index[LANES],
                                     const brio_centre_goal *goal, const bool weighted) {
    four_points p;
    fraction f;
    lanes r[3][3], lift[3], size[3] = {all(0), all(0), all(0)}, offset[3], worst = all(0), far = all(0);
    load_points(b, index, &p, weighted);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            r[i][k] = p.at[i + 1][k] - p.at[0][k];
            size[k] = maximum(magnitude(r[i][k]), size[k]);
        }
        lift[i] = square_of(r[i]);
    }
    evaluate((const lanes(*)[3])r, lift, &f);
    lanes permanent = all(6) * size[0] * size[1] * size[2], bound = all(DOUBLE_BOUND), lifts = lift[0] + lift[1];
    lanes slack = magnitude(f.determinant) - (bound * permanent + all(TINY)), inverse = all(1) / slack;
    lanes share = bound * permanent * inverse * all(ROUNDED) + all(0x1p-52);
    lifts += lift[2];
    for (int k = 0; k < 3; k++) {
        lanes most = all(2) * lifts * size[(k + 1) % 3] * size[(k + 2) % 3];
        offset[k] = all(0.5) * (f.numerator[k] / f.determinant);
        lanes length = magnitude(offset[k]);
        lanes error = all(0.5) * (bound * most + all(TINY)) * inverse * all(ROUNDED) + length * share;
        worst = maximum(error, worst);
        far = maximum(length, far);
    }
    lanes least = all(goal->relative) * far;
    lane_mask within = both(either(greater(least, worst), equal(least, worst)), greater(all(0x1p900), far));
    unsigned found = bits_of(both(greater(slack, all(0)), within));
    double out[4][LANES];
    for (int k = 0; k < 3; k++) store_lanes(out[k], p.at[0][k] + offset[k]);
    store_lanes(out[3], square_of(offset));
    for (int n = 0; n < LANES; n++)
        for (size_t k = 0; k < 4 && found >> n & 1; k++) goal->centre[goal->stride * index[n] + k] = out[k][n];
    return ~found & ((1u << LANES) - 1);
}

/* --- a batch --- */

typedef unsigned (*solve_lanes)(const brio_centre_batch *b, const uint8_t index[LANES], const brio_centre_goal *goal,
                                const bool weighted);

/* Solves the tetrahedra of the batch whose bits are set in `some`, LANES at a time. Returns the bits of the tetrahedra
 * that `solve` leaves. */
static inline __attribute__((always_inline)) uint64_t solve_some(const brio_centre_batch *b, uint64_t some,
                                                                 const brio_centre_goal *goal, solve_lanes solve,
                                                                 const bool weighted) {
    assert(b->count >= 64 || some >> b->count == 0);
    uint64_t left = 0;
    while (some) {
        uint8_t index[LANES];
        int count = 0;
        for (; count < LANES && some; some &= some - 1) index[count++] = (uint8_t)__builtin_ctzll(some);
        for (int n = count; n < LANES; n++) index[n] = index[0];
        for (unsigned open = solve(b, index, goal, weighted); open; open &= open - 1)
            left |= UINT64_C(1) << index[__builtin_ctz(open)];
    }
    return left;
}

static uint64_t find(const brio_centre_batch *b, uint64_t some, const brio_centre_goal *goal) {
    if (b->weights) return solve_some(b, solve_some(b, some, goal, solve_doubles, true), goal, solve_pairs, true);
    return solve_some(b, solve_some(b, some, goal, solve_doubles, false), goal, solve_pairs, false);
}

static uint64_t find_roughly(const brio_centre_batch *b, uint64_t some, const brio_centre_goal *goal) {
    return solve_some(b, some, goal, solve_roughly, false);
}

const brio_centre_engine CENTRES = {find, find_roughly};
