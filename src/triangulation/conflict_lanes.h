/* Conflict tests side by side in the lanes of vector registers; included by one source file an instruction set, after
 * the operations on its lanes.
 *
 * LANES tetrahedra go through the in-sphere determinant together. An infinite vertex enters as the point at infinity of
 * the lifting: row (0, 0, 0) with lift 1, which turns the determinant into the orientation of the hull facet and the
 * query, so finite and infinite tetrahedra need no branch; its record is told by an infinite weight. Lanes whose sign
 * is not certain take the further stages: a bound from the largest difference along each axis, then pairs of doubles in
 * the same lanes, and only what these leave is tested one by one.
 *
 * The bounds are those of filter.c and of the pairs below: a permanent is at most 24 times (6 times for an orientation)
 * the product of the largest differences and the largest lift. Fused operations round less often than these bounds
 * allow for. */
#include "predicates/lane_pairs.h"
#include "triangulation/engine.h"

enum { ALL_LANES = (1 << LANES) - 1 };

/* The four rows of the determinant relative to the query; infinite lanes have row d = 0 and lift 1. */
typedef struct {
    lanes x[4], y[4], z[4], lift[4];
    lane_mask infinite;
} rows;

/* Coordinates of all vertices, for the stages that need them again. */
typedef struct {
    lanes v[4][4]; /* of slot s: x, y, z, weight */
    lanes e[4];
} corners;

static inline void load_corners(const brio_tetrahedra *t, const uint32_t facets[LANES], const double *p, corners *c) {
    for (int s = 0; s < 4; s++) {
        const double *row[LANES];
        for (int i = 0; i < LANES; i++) row[i] = t->record[t->tet[brio_tet_of(facets[i])].vertex[s]];
        load_rows(row, true, c->v[s]);
    }
    for (int k = 0; k < 4; k++) c->e[k] = all(p[k]);
}

static inline lanes square_length(lanes x, lanes y, lanes z) {
    return multiply_add(x, x, multiply_add(y, y, z * z));
}

static inline void rows_set(const corners *c, rows *r, const bool weighted) {
    lane_mask infinite = equal(c->v[3][3], all(INFINITY));
    for (int s = 0; s < 4; s++) {
        r->x[s] = c->v[s][0] - c->e[0], r->y[s] = c->v[s][1] - c->e[1], r->z[s] = c->v[s][2] - c->e[2];
        r->lift[s] = square_length(r->x[s], r->y[s], r->z[s]);
        if (weighted) r->lift[s] -= c->v[s][3] - c->e[3];
    }
    r->infinite = infinite;
    r->x[3] = choose(infinite, all(0), r->x[3]);
    r->y[3] = choose(infinite, all(0), r->y[3]);
    r->z[3] = choose(infinite, all(0), r->z[3]);
    r->lift[3] = choose(infinite, all(1), r->lift[3]);
}

/* Returns x w - z y. */
static inline lanes minor2(lanes x, lanes y, lanes z, lanes w) {
    return multiply_subtract(x, w, z * y);
}

/* Writes the minors of all rows except one: the orientations of the tetrahedron with one vertex replaced by the query,
 * with minor[1] and minor[3] negated. */
static inline void minors(const rows *r, lanes minor[4]) {
    const lanes *x = r->x, *y = r->y, *z = r->z;
    lanes ab = minor2(x[0], y[0], x[1], y[1]), bc = minor2(x[1], y[1], x[2], y[2]), cd = minor2(x[2], y[2], x[3], y[3]);
    lanes da = minor2(x[3], y[3], x[0], y[0]), ac = minor2(x[0], y[0], x[2], y[2]), bd = minor2(x[1], y[1], x[3], y[3]);
    minor[0] = multiply_add(z[1], cd, multiply_subtract(z[3], bc, z[2] * bd));
    minor[1] = multiply_add(z[2], da, multiply_add(z[3], ac, z[0] * cd));
    minor[2] = multiply_add(z[3], ab, multiply_add(z[0], bd, z[1] * da));
    minor[3] = multiply_add(z[0], bc, multiply_subtract(z[2], ab, z[1] * ac));
}

static inline lanes determinant(const rows *r) {
    lanes minor[4];
    minors(r, minor);
    lanes even = multiply_add(r->lift[2], minor[2], r->lift[0] * minor[0]);
    lanes odd = multiply_add(r->lift[3], minor[3], r->lift[1] * minor[1]);
    return even - odd;
}

/* Returns the lanes where p is lexicographically larger than q. */
static inline lane_mask larger(const lanes p[3], const lanes q[3]) {
    lane_mask z = greater(p[2], q[2]);
    lane_mask y = either(greater(p[1], q[1]), both(equal(p[1], q[1]), z));
    return either(greater(p[0], q[0]), both(equal(p[0], q[0]), y));
}

/* Decides by the symbolic perturbation (perturb.c), where minors are exact. Returns the bits of the lanes that are in
 * conflict if their determinant is 0. */
static inline unsigned ties(const corners *c, const rows *r) {
    lanes minor[4], decisive[3] = {c->e[0], c->e[1], c->e[2]}, decision = all(-1);
    minors(r, minor);
    for (int s = 0; s < 4; s++) {
        lanes side = minor[s];
        if (s % 2) side = all(0) - side;
        lane_mask take = first_only(larger(c->v[s], decisive), equal(side, all(0)));
        decision = choose(take, side, decision);
        for (int k = 0; k < 3; k++) decisive[k] = choose(take, c->v[s][k], decisive[k]);
    }
    return bits_of(greater(decision, all(0)));
}

/* Returns the bits of the lanes that are certainly in conflict. Adds their bits, and those of the lanes that are
 * certainly in none, to *known. */
static inline unsigned decide(lanes det, lanes bound, unsigned *known) {
    unsigned above = bits_of(greater(det, bound)), below = bits_of(greater(all(0) - bound, det));
    unsigned fresh = above & ~*known;
    *known |= above | below;
    return fresh;
}

static inline lanes largest(const lanes v[4]) {
    return maximum(maximum(magnitude(v[0]), magnitude(v[1])), maximum(magnitude(v[2]), magnitude(v[3])));
}

/* Returns a bound of the permanent of each lane. */
static inline lanes permanent(const corners *c, const rows *r, const bool weighted) {
    lanes lift[4];
    for (int s = 0; s < 4; s++) {
        lift[s] = square_length(r->x[s], r->y[s], r->z[s]);
        if (weighted) lift[s] += magnitude(c->v[s][3] - c->e[3]);
    }
    lanes box = largest(r->x) * largest(r->y) * largest(r->z);
    return choose(r->infinite, all(6.01) * box, all(24.01) * box * largest(lift));
}

/* Returns the permanent of each lane. The bound above is far too large for one vertex far from the others. */
static inline lanes close_permanent(const corners *c, const rows *r, const bool weighted) {
    lanes x[4], y[4], z[4], lift[4];
    for (int s = 0; s < 4; s++) {
        x[s] = magnitude(r->x[s]), y[s] = magnitude(r->y[s]), z[s] = magnitude(r->z[s]);
        lift[s] = square_length(x[s], y[s], z[s]);
        if (weighted) lift[s] += magnitude(c->v[s][3] - c->e[3]);
    }
    lift[3] = choose(r->infinite, all(1), lift[3]);
    lanes ab = x[0] * y[1] + x[1] * y[0], bc = x[1] * y[2] + x[2] * y[1], cd = x[2] * y[3] + x[3] * y[2];
    lanes da = x[3] * y[0] + x[0] * y[3], ac = x[0] * y[2] + x[2] * y[0], bd = x[1] * y[3] + x[3] * y[1];
    return lift[0] * (z[1] * cd + z[2] * bd + z[3] * bc) + lift[1] * (z[2] * da + z[3] * ac + z[0] * cd) +
           lift[2] * (z[3] * ab + z[0] * bd + z[1] * da) + lift[3] * (z[0] * bc + z[1] * ac + z[2] * ab);
}

/* --- pairs of doubles ---
 *
 * Loose ones (lane_pairs.h): the low part may grow, which so few operations can afford. Let P be the permanent of an
 * expression and u = 2^-53; every pair here has |lo| <= c u P and an error of at most e u^2 P, where
 *   difference  c = 1, e = 0;   product  c = c1 + c2 + 1, e = e1 + e2 + c1 c2 + c1 + 2 c2 + 2;
 *   sum         c = max(c1, c2) + 1, e = max(e1, e2) + 2 c,
 * which makes (4, 14) of a minor of two rows, (8, 60) of three, (5, 24) of a lift and (16, 210) of the determinant. */

/* Returns x y - z w. */
static inline lane_pair minor_of_pairs(lane_pair x, lane_pair y, lane_pair z, lane_pair w) {
    return pair_subtract_loose(pair_multiply_loose(x, y), pair_multiply_loose(z, w));
}
static inline lane_pair masked(lane_pair x, lane_mask drop, double value) {
    return (lane_pair){choose(drop, all(value), x.hi), choose(drop, all(0), x.lo)};
}

static __attribute__((noinline)) lanes determinant_of_pairs(const corners *c, lane_mask infinite, bool weighted) {
    lane_pair x[4], y[4], z[4], l[4];
    for (int s = 0; s < 4; s++) {
        x[s] = pair_difference(c->v[s][0], c->e[0]), y[s] = pair_difference(c->v[s][1], c->e[1]);
        z[s] = pair_difference(c->v[s][2], c->e[2]);
        l[s] = pair_add_loose(pair_add_loose(pair_multiply_loose(x[s], x[s]), pair_multiply_loose(y[s], y[s])),
                              pair_multiply_loose(z[s], z[s]));
        if (weighted) l[s] = pair_subtract_loose(l[s], pair_difference(c->v[s][3], c->e[3]));
    }
    x[3] = masked(x[3], infinite, 0), y[3] = masked(y[3], infinite, 0), z[3] = masked(z[3], infinite, 0);
    l[3] = masked(l[3], infinite, 1);
    lane_pair ab = minor_of_pairs(x[0], y[1], x[1], y[0]), bc = minor_of_pairs(x[1], y[2], x[2], y[1]);
    lane_pair cd = minor_of_pairs(x[2], y[3], x[3], y[2]), da = minor_of_pairs(x[3], y[0], x[0], y[3]);
    lane_pair ac = minor_of_pairs(x[0], y[2], x[2], y[0]), bd = minor_of_pairs(x[1], y[3], x[3], y[1]);
    lane_pair abc = pair_add_loose(minor_of_pairs(z[0], bc, z[1], ac), pair_multiply_loose(z[2], ab));
    lane_pair bcd = pair_add_loose(minor_of_pairs(z[1], cd, z[2], bd), pair_multiply_loose(z[3], bc));
    lane_pair cda = pair_add_loose(pair_add_loose(pair_multiply_loose(z[2], da), pair_multiply_loose(z[3], ac)),
                                   pair_multiply_loose(z[0], cd));
    lane_pair dab = pair_add_loose(pair_add_loose(pair_multiply_loose(z[3], ab), pair_multiply_loose(z[0], bd)),
                                   pair_multiply_loose(z[1], da));
    lane_pair det = pair_add_loose(minor_of_pairs(l[2], dab, l[3], abc), minor_of_pairs(l[0], bcd, l[1], cda));
    return det.hi + det.lo;
}

static const double DOUBLE_UNIT = 18 * 0x1p-53, PAIR_UNIT = 0x1p-97;

/* Settles the lanes of hull facets whose planes hold the point: the finite neighbours decide. */
static inline unsigned settle_in_planes(const brio_tetrahedra *t, brio_filter *f, const uint32_t facets[LANES],
                                        const double *p, unsigned lanes_to_settle) {
    unsigned mask = 0;
    for (int i = 0; i < LANES; i++)
        if (lanes_to_settle >> i & 1)
            mask |= (unsigned)brio_in_conflict(t, f, brio_tet_of(facets[i]), p, f->weighted) << i;
    return mask;
}

/* Decides against a bound from the lifts alone, which are at hand. With the largest lift L no difference is over
 * sqrt(L), so that the permanent is at most 24 L^2.5, for a hull facet 6 L^1.5; compared as squares. */
static inline unsigned decide_by_lifts(const brio_filter *f, const rows *r, lanes det, unsigned *known) {
    static const double FINITE = 24.1 * DOUBLE_UNIT, HULL = 6.1 * DOUBLE_UNIT, TINY = 1e-290;
    lanes last = choose(r->infinite, all(0), r->lift[3]);
    lanes most = maximum(maximum(r->lift[0], r->lift[1]), maximum(r->lift[2], last)), cube = most * most * most;
    lanes bound = choose(r->infinite, all(HULL * HULL) * cube, all(FINITE * FINITE) * cube * (most * most));
    bound += choose(r->infinite, all(f->orient_floor * f->orient_floor), all(f->insphere_floor * f->insphere_floor));
    unsigned certain = bits_of(greater(det * det, bound + all(TINY)));
    unsigned fresh = certain & bits_of(greater(det, all(0))) & ~*known;
    *known |= certain;
    return fresh;
}

/* Decides by the second stage. With weights nearly every call needs it: the balls of neighbouring poles all but touch
 * the same points. */
static inline unsigned decide_by_permanent(const brio_filter *f, const corners *c, const rows *r, lanes det,
                                           unsigned *known, const bool weighted) {
    lanes floor = choose(r->infinite, all(f->orient_floor), all(f->insphere_floor));
    return decide(det, all(DOUBLE_UNIT) * permanent(c, r, weighted) + floor, known);
}

/* Runs the stages that are left, for the lanes not yet known. Loads everything again: keeping it at hand would cost the
 * calls that do not come here as much. */
static __attribute__((noinline)) unsigned settle(const brio_tetrahedra *t, brio_filter *f, const uint32_t facets[LANES],
                                                 const double *p, unsigned known, const bool weighted) {
    corners c;
    rows r;
    load_corners(t, facets, p, &c);
    rows_set(&c, &r, weighted);
    if (f->lattice) { /* the determinants that are not known are 0: ties */
        unsigned zero = ~known & ALL_LANES, infinite = zero & bits_of(r.infinite);
        return (ties(&c, &r) & zero & ~infinite) | settle_in_planes(t, f, facets, p, infinite);
    }
    unsigned mask = weighted ? 0 : decide_by_permanent(f, &c, &r, determinant(&r), &known, false);
    if (known == ALL_LANES) return mask;
    f->unsettled += (uint64_t)__builtin_popcount(~known & ALL_LANES);
    if (!f->coarse) {
        lanes floor = choose(r.infinite, all(f->orient_floor), all(f->insphere_floor));
        lanes det = determinant_of_pairs(&c, r.infinite, weighted);
        mask |= decide(det, all(PAIR_UNIT) * permanent(&c, &r, weighted) + floor, &known);
        if (known != ALL_LANES) mask |= decide(det, all(PAIR_UNIT) * close_permanent(&c, &r, weighted) + floor, &known);
    }
    for (int i = 0; i < LANES; i++)
        if (!(known >> i & 1)) mask |= (unsigned)brio_in_conflict_late(t, f, brio_tet_of(facets[i]), p, weighted) << i;
    return mask;
}

static inline __attribute__((always_inline)) unsigned lanes_in_conflict(const brio_tetrahedra *t, brio_filter *f,
                                                                        const uint32_t facets[LANES], const double *p,
                                                                        const bool weighted) {
    corners c;
    rows r;
    unsigned known = 0;
    load_corners(t, facets, p, &c);
    rows_set(&c, &r, weighted);
    lanes bound = choose(r.infinite, all(f->orient_static), all(f->insphere_static));
    lanes det = determinant(&r);
    unsigned mask = decide(det, bound, &known);
    if (__builtin_expect(known == ALL_LANES, 1)) return mask;
    if (!weighted && !f->lattice) mask |= decide_by_lifts(f, &r, det, &known);
    if (weighted && !f->lattice) mask |= decide_by_permanent(f, &c, &r, det, &known, true);
    if (known == ALL_LANES) return mask;
    return mask | settle(t, f, facets, p, known, weighted);
}

static inline __attribute__((always_inline)) unsigned batch_in_conflict(const brio_tetrahedra *t, brio_filter *f,
                                                                        const uint32_t *facets, size_t count,
                                                                        const double *p, const bool weighted) {
    unsigned mask = 0;
    for (size_t i = 0; i < count; i += LANES) mask |= lanes_in_conflict(t, f, facets + i, p, weighted) << i;
    return mask & ((1u << count) - 1);
}
