/* Two doubles side by side: the vector operations of conflict_lanes.h, sound_lanes.h and centre_lanes.h with what every
 * processor of the target has: SSE2, or NEON with its fused operations. */
#ifndef BRIO_PREDICATES_LANES_PLAIN_H
#define BRIO_PREDICATES_LANES_PLAIN_H

#include "predicates/double_double.h"
#include <math.h>
#include <stdint.h>
#include <string.h>
#if defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

enum { LANES = 2 };

typedef double lanes __attribute__((vector_size(8 * LANES))); /* + - * / act on each lane */
typedef int64_t lane_mask __attribute__((vector_size(8 * LANES)));

static inline lanes all(double x) {
    return (lanes){x, x};
}
static inline lanes magnitude(lanes x) {
    return (lanes)((lane_mask)x & INT64_MAX);
}
static inline lane_mask greater(lanes x, lanes y) {
    return x > y;
}
static inline lane_mask equal(lanes x, lanes y) {
    return x == y;
}
static inline lane_mask both(lane_mask a, lane_mask b) {
    return a & b;
}
static inline lane_mask first_only(lane_mask a, lane_mask b) {
    return a & ~b;
}
static inline lane_mask either(lane_mask a, lane_mask b) {
    return a | b;
}
/* Returns x in the lanes of the mask, and y in the other lanes. */
static inline lanes choose(lane_mask m, lanes x, lanes y) {
    return (lanes)(((lane_mask)x & m) | ((lane_mask)y & ~m));
}
/* Returns x in the lanes where x > y, and y in the other lanes, which include the lanes with a NaN. */
static inline lanes maximum(lanes x, lanes y) {
#if defined(__SSE2__)
    return (lanes)_mm_max_pd((__m128d)x, (__m128d)y);
#else
    return choose(x > y, x, y);
#endif
}
static inline unsigned bits_of(lane_mask m) {
    return (unsigned)(m[0] & 1) | (unsigned)(m[1] & 2);
}

static inline lanes root(lanes x) {
    return (lanes){sqrt(x[0]), sqrt(x[1])};
}
/* Return x y - z and x y + z, rounded once or twice. */
static inline lanes multiply_subtract(lanes x, lanes y, lanes z) {
#if defined(__aarch64__)
    return (lanes)vfmaq_f64((float64x2_t)-z, (float64x2_t)x, (float64x2_t)y);
#else
    return x * y - z;
#endif
}
static inline lanes multiply_add(lanes x, lanes y, lanes z) {
#if defined(__aarch64__)
    return (lanes)vfmaq_f64((float64x2_t)z, (float64x2_t)x, (float64x2_t)y);
#else
    return x * y + z;
#endif
}
/* Returns x y - p, where p is the rounded product of x and y. */
static inline lanes product_error(lanes x, lanes y, lanes p) {
#if defined(__aarch64__)
    return multiply_subtract(x, y, p);
#else
    lanes error = p;
    for (int i = 0; i < LANES; i++) error[i] = dd_two_product(x[i], y[i], DD_TARGET_HAS_FMA).lo;
    return error;
#endif
}

/* Returns the largest power of two that is at most x, by keeping only the exponent bits. x is positive and normal. */
static inline lanes leading_power(lanes x) {
    return (lanes)((lane_mask)x & (lane_mask)all(__builtin_inf()));
}

/* Writes to out[k] entry k of each lane's row. A row has four doubles or, when `four` is false, three; then out[3] is
 * 0. */
static inline void load_rows(const double *const row[LANES], const bool four, lanes out[4]) {
    for (int k = 0; k < 3 + four; k++) out[k] = (lanes){row[0][k], row[1][k]};
    if (!four) out[3] = all(0);
}

static inline lanes load_lanes(const double x[LANES]) {
    lanes out;
    memcpy(&out, x, sizeof out);
    return out;
}
static inline void store_lanes(double out[LANES], lanes x) {
    memcpy(out, &x, sizeof x);
}

#endif
