/* Four doubles side by side: the vector operations of conflict_lanes.h, sound_lanes.h and centre_lanes.h in
 * AVX2. */
#ifndef BRIO_PREDICATES_LANES_AVX2_H
#define BRIO_PREDICATES_LANES_AVX2_H

#include <immintrin.h>
#include <stdbool.h>

enum { LANES = 4 };

typedef __m256d lanes; /* + - * / act on each lane */
typedef __m256d lane_mask;

static inline lanes all(double x) {
    return _mm256_set1_pd(x);
}
static inline lanes magnitude(lanes x) {
    return _mm256_andnot_pd(all(-0.0), x);
}
static inline lanes maximum(lanes x, lanes y) {
    return _mm256_max_pd(x, y);
}
static inline lanes root(lanes x) {
    return _mm256_sqrt_pd(x);
}
/* Return x y - z and x y + z with one rounding. */
static inline lanes multiply_subtract(lanes x, lanes y, lanes z) {
    return _mm256_fmsub_pd(x, y, z);
}
static inline lanes multiply_add(lanes x, lanes y, lanes z) {
    return _mm256_fmadd_pd(x, y, z);
}
/* Returns x y - p, where p is the rounded product of x and y. */
static inline lanes product_error(lanes x, lanes y, lanes p) {
    return multiply_subtract(x, y, p);
}
static inline lane_mask greater(lanes x, lanes y) {
    return _mm256_cmp_pd(x, y, _CMP_GT_OQ);
}
static inline lane_mask equal(lanes x, lanes y) {
    return _mm256_cmp_pd(x, y, _CMP_EQ_OQ);
}
static inline lane_mask both(lane_mask a, lane_mask b) {
    return _mm256_and_pd(a, b);
}
static inline lane_mask first_only(lane_mask a, lane_mask b) {
    return _mm256_andnot_pd(b, a);
}
static inline lane_mask either(lane_mask a, lane_mask b) {
    return _mm256_or_pd(a, b);
}
/* Returns x in the lanes of the mask, and y in the other lanes. */
static inline lanes choose(lane_mask m, lanes x, lanes y) {
    return _mm256_blendv_pd(y, x, m);
}
static inline unsigned bits_of(lane_mask m) {
    return (unsigned)_mm256_movemask_pd(m);
}

/* Returns the largest power of two that is at most x, by keeping only the exponent bits. x is positive and normal. */
static inline lanes leading_power(lanes x) {
    return _mm256_and_pd(x, all(__builtin_inf()));
}

/* Writes to out[k] entry k of each lane's row. A row has four doubles or, when `four` is false, three; then out[3] is
 * 0. */
static inline void load_rows(const double *const row[LANES], const bool four, lanes out[4]) {
    const __m256i three = _mm256_setr_epi64x(-1, -1, -1, 0);
    lanes r[4];
    for (int i = 0; i < LANES; i++) r[i] = four ? _mm256_loadu_pd(row[i]) : _mm256_maskload_pd(row[i], three);
    lanes ab0 = _mm256_unpacklo_pd(r[0], r[1]), ab1 = _mm256_unpackhi_pd(r[0], r[1]);
    lanes cd0 = _mm256_unpacklo_pd(r[2], r[3]), cd1 = _mm256_unpackhi_pd(r[2], r[3]);
    out[0] = _mm256_permute2f128_pd(ab0, cd0, 0x20);
    out[1] = _mm256_permute2f128_pd(ab1, cd1, 0x20);
    out[2] = _mm256_permute2f128_pd(ab0, cd0, 0x31);
    out[3] = _mm256_permute2f128_pd(ab1, cd1, 0x31);
}

static inline lanes load_lanes(const double x[LANES]) {
    return _mm256_loadu_pd(x);
}
static inline void store_lanes(double out[LANES], lanes x) {
    _mm256_storeu_pd(out, x);
}

#endif
