/* Pairs of doubles in lanes: unevaluated sums hi + lo, as in double_double.h. Include this file after the operations on
 * lanes.
 *
 * A pair is tight when hi is the rounded sum hi + lo. A loose operation saves the addition that makes the result tight.
 * The lo of a loose result may grow, and the caller bounds its growth (triangulation/conflict_lanes.h).
 *
 * Based on: Dekker. A floating-point technique for extending the available precision. Numer. Math. 1971.
 *           Lange, Rump. Faithfully rounded floating-point computations. TOMS 2020 (loose pairs). */
#ifndef BRIO_PREDICATES_LANE_PAIRS_H
#define BRIO_PREDICATES_LANE_PAIRS_H

typedef struct {
    lanes hi, lo;
} lane_pair;

/* Returns a - b, exact and tight. */
static inline lane_pair pair_difference(lanes a, lanes b) {
    lanes s = a - b, t = s - a;
    return (lane_pair){s, (a - (s - t)) - (b + t)};
}
static inline lane_pair pair_tight(lane_pair x) {
    lanes s = x.hi + x.lo;
    return (lane_pair){s, x.lo - (s - x.hi)};
}
static inline lane_pair pair_add_loose(lane_pair x, lane_pair y) {
    lanes s = x.hi + y.hi, t = s - x.hi;
    return (lane_pair){s, ((x.hi - (s - t)) + (y.hi - t)) + (x.lo + y.lo)};
}
static inline lane_pair pair_subtract_loose(lane_pair x, lane_pair y) {
    lane_pair s = pair_difference(x.hi, y.hi);
    return (lane_pair){s.hi, s.lo + (x.lo - y.lo)};
}
static inline lane_pair pair_add(lane_pair x, lane_pair y) {
    return pair_tight(pair_add_loose(x, y));
}
static inline lane_pair pair_subtract(lane_pair x, lane_pair y) {
    return pair_tight(pair_subtract_loose(x, y));
}
static inline lane_pair pair_multiply(lane_pair x, lane_pair y) {
    lanes p = x.hi * y.hi;
    return pair_tight((lane_pair){p, product_error(x.hi, y.hi, p) + (x.hi * y.lo + x.lo * y.hi)});
}
static inline lane_pair pair_multiply_loose(lane_pair x, lane_pair y) {
    lanes p = x.hi * y.hi;
    return (lane_pair){p, multiply_add(x.lo, y.hi, multiply_add(x.hi, y.lo, product_error(x.hi, y.hi, p)))};
}

#endif
