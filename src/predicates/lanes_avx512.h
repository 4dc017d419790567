/* Eight doubles side by side: the vector operations of conflict_lanes.h, sound_lanes.h and centre_lanes.h in
 * AVX-512. */
#ifndef BRIO_PREDICATES_LANES_AVX512_H
#define BRIO_PREDICATES_LANES_AVX512_H

#include <immintrin.h>
#include <stdbool.h>

enum { LANES = 8 };

typedef __m512d lanes; /* + - * / act on each lane */
typedef __mmask8 lane_mask;

static inline lanes all(double x) {
    return _mm512_set1_pd(x);
}
static inline lanes magnitude(lanes x) {
    return _mm512_abs_pd(x);
}
static inline lanes maximum(lanes x, lanes y) {
    return _mm512_max_pd(x, y);
}
static inline lanes root(lanes x) {
    return _mm512_sqrt_pd(x);
}
/* Return x y - z and x y + z with one rounding. */
static inline lanes multiply_subtract(lanes x, lanes y, lanes z) {
    return _mm512_fmsub_pd(x, y, z);
}
static inline lanes multiply_add(lanes x, lanes y, lanes z) {
    return _mm512_fmadd_pd(x, y, z);
}
/* Returns x y - p, where p is the rounded product of x and y. */
static inline lanes product_error(lanes x, lanes y, lanes p) {
    return multiply_subtract(x, y, p);
}
static inline lane_mask greater(lanes x, lanes y) {
    return _mm512_cmp_pd_mask(x, y, _CMP_GT_OQ);
}
static inline lane_mask equal(lanes x, lanes y) {
    return _mm512_cmp_pd_mask(x, y, _CMP_EQ_OQ);
}
static inline lane_mask both(lane_mask a, lane_mask b) {
    return a & b;
}
static inline lane_mask first_only(lane_mask a, lane_mask b) {
    return a & (lane_mask)~b;
}
static inline lane_mask either(lane_mask a, lane_mask b) {
    return a | b;
}
/* Returns x in the lanes of the mask, and y in the other lanes. */
static inline lanes choose(lane_mask m, lanes x, lanes y) {
    return _mm512_mask_blend_pd(m, y, x);
}
static inline unsigned bits_of(lane_mask m) {
    return m;
}

/* Returns the largest power of two that is at most x, by keeping only the exponent bits. x is positive and normal. */
static inline lanes leading_power(lanes x) {
    return _mm512_and_pd(x, all(__builtin_inf()));
}

/* Writes to out[k] entry k of each lane's row. A row has four doubles or, when `four` is false, three; then out[3] is
 * 0. */
static inline void load_rows(const double *const row[LANES], const bool four, lanes out[4]) {
    lanes r[4]; /* two rows each; the pairing puts the lanes in order after the shuffles */
    for (int i = 0; i < 4; i++) {
        int low = i < 2 ? i : i + 2;
        __m256d a = four ? _mm256_loadu_pd(row[low]) : _mm256_maskz_loadu_pd(7, row[low]);
        __m256d b = four ? _mm256_loadu_pd(row[low + 2]) : _mm256_maskz_loadu_pd(7, row[low + 2]);
        r[i] = _mm512_insertf64x4(_mm512_castpd256_pd512(a), b, 1);
    }
    lanes ab0 = _mm512_unpacklo_pd(r[0], r[1]), ab1 = _mm512_unpackhi_pd(r[0], r[1]);
    lanes cd0 = _mm512_unpacklo_pd(r[2], r[3]), cd1 = _mm512_unpackhi_pd(r[2], r[3]);
    out[0] = _mm512_shuffle_f64x2(ab0, cd0, 0x88);
    out[1] = _mm512_shuffle_f64x2(ab1, cd1, 0x88);
    out[2] = _mm512_shuffle_f64x2(ab0, cd0, 0xdd);
    out[3] = _mm512_shuffle_f64x2(ab1, cd1, 0xdd);
}

static inline lanes load_lanes(const double x[LANES]) {
    return _mm512_loadu_pd(x);
}
static inline void store_lanes(double out[LANES], lanes x) {
    _mm512_storeu_pd(out, x);
}

#endif
