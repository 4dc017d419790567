/* Powers of two, and numbers times one of them. */
#ifndef BRIO_BASE_SCALE_H
#define BRIO_BASE_SCALE_H

#include "base/context.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/** Returns 2^exponent for exponents of normal numbers, -1022 to 1023, without a call. */
static inline double brio_power_of_two(int exponent) {
    assert(-1022 <= exponent && exponent <= 1023);
    uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/** Returns 2^-exponent, or the closest power of two that is a normal number: it brings numbers of that exponent near
 *  1. */
static inline double brio_scale_to_one(int exponent) {
    return brio_power_of_two(exponent > 1022 ? -1022 : exponent < -1022 ? 1022 : -exponent);
}

/** Returns the greatest magnitude of numbers, 0 if there are none. */
double brio_greatest(const double *x, size_t n);

/** Returns the exponent of the least power of two above x: x * 2^-exponent is below 1. 0 for 0 and for what is not
 *  finite. */
int brio_exponent(double x);

/** Returns by how much the rounding of coordinates of magnitudes up to `greatest` may change the distance of two
 *  points: two units in the last place of each. Distances closer than that to a threshold count as equal to it, so that
 *  a grid of a spacing that no double holds is treated alike all over. */
static inline double brio_distance_rounding(double greatest) {
    return 0x1p-50 * greatest;
}

/** Returns an exponent so that usual points times 2^-exponent are near 1, and all points finite: the mean exponent of
 *  the greatest coordinates, which a few points far out hardly change.   points  #P by 3. */
int brio_usual_exponent(const double *points, size_t num_points);

/** Sets out[i] to x[i] * 2^exponent for i < n, and -0 to 0. Uses all threads. `out` may be x. */
brio_status brio_scale(brio_context *ctx, const double *x, size_t n, int exponent, double *out);

/** Scales the vertices of a result in place. Returns BRIO_OK, or BRIO_ERR_NO_ANSWER if doubles cannot hold a
 *  coordinate. */
brio_status brio_scale_vertices(brio_context *ctx, double *vertices, size_t num_vertices, int exponent);

/** A unit of sums that do not depend on the order of the numbers: sums of whole multiples of a power of two. Each
 *  number is rounded by itself, so parts of them can be summed apart, by threads or by tiles. */
typedef struct {
    double unit;
    double most; /* units that one number has at most */
} brio_sum_unit;

/** Returns the least unit in which `count` numbers of magnitudes up to `greatest` have a sum below 2^62.
 *  greatest, count  of all numbers, in every part. */
static inline brio_sum_unit brio_sum_unit_for(double greatest, size_t count) {
    int bits = 1;
    while (bits < 61 && count >> bits > 0) bits++;
    int exponent = brio_exponent(greatest) - (62 - bits);
    return (brio_sum_unit){brio_power_of_two(exponent < -1022 ? -1022 : exponent), brio_power_of_two(62 - bits)};
}

/** Returns a number in units: what is not a number is 0, what is beyond the greatest counts as that. */
static inline int64_t brio_in_units(brio_sum_unit u, double x) {
    double units = floor(x / u.unit + 0.5);
    return isnan(units) ? 0 : (int64_t)(units < -u.most ? -u.most : units > u.most ? u.most : units);
}

#endif
