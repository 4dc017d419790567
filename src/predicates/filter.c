/* Floating-point stages of the predicates: error bounds, the permanents from which they are derived, and stages 2 and 3
 * of rows that are scaled where underflow or overflow would count.
 *
 * The permanent of an expression is the expression with every term replaced by its magnitude. With u = 2^-53, the error
 * of an estimate is at most
 *   orient3d   (7 + 56 u) u   times the permanent (Shewchuk's o3derrboundA),
 *   insphere   (16 + 224 u) u times the permanent (Shewchuk's isperrboundA). The additional subtraction of the weighted
 *              lift raises 16 to 17.
 * ORIENT_BOUND and INSPHERE_BOUND round these up to 8 u and 18 u. */
#include "base/float_state.h"
#include "predicates/predicates.h"
#include "predicates/span.h"
#include <assert.h>

static const double ORIENT_BOUND = 8 * 0x1p-53, INSPHERE_BOUND = 18 * 0x1p-53;

/* Chosen: with larger extents, stages 1 to 3 could overflow (polynomials of degree 5, Dekker's splitting). */
static const double EXTENT_MOST = 1e55, WEIGHT_MOST = 1e110;

/* About a hundred products may each lose 2^-1074 by underflow. The floors multiply this by the largest cofactors of
 * rows whose differences are at most `most` and whose weights differ by at most w. */
static const double FLOOR_UNIT = 0x1p-1060;

static double orient_floor(double most) {
    return FLOOR_UNIT * (1 + most) * (1 + most);
}

static double insphere_floor(double most, double w) {
    return FLOOR_UNIT * (1 + most) * (1 + most) * (1 + most) * (1 + most + w);
}

void brio_filter_set(brio_filter *f, const double extent[3], double weight_extent, bool weighted) {
    assert(brio_float_is_standard()); /* the bounds hold for rounding to nearest */
    double x = extent[0], y = extent[1], z = extent[2];
    double most = fmax(x, fmax(y, z)), w = weighted ? weight_extent : 0;
    *f = (brio_filter){INFINITY, INFINITY, INFINITY, INFINITY, weighted, false, false, 0, 0};
    if (!(most <= EXTENT_MOST && w <= WEIGHT_MOST)) return;
    f->orient_floor = orient_floor(most);
    f->insphere_floor = insphere_floor(most, w);
    /* a 3 by 3 minor has 6 products, insphere 4 minors times a lift; 1.001 covers the rounding of the bound */
    f->orient_static = 1.001 * ORIENT_BOUND * 6 * x * y * z + f->orient_floor;
    f->insphere_static = 1.001 * INSPHERE_BOUND * 24 * x * y * z * (x * x + y * y + z * z + w) + f->insphere_floor;
}

enum { COARSE_BITS = 20 }; /* NARROW_BITS of integer.c */

/* Finds the span of the differences of coordinates and the span of the differences of weights. Stops once the span of
 * the coordinates exceeds COARSE_BITS: neither test below can then succeed. */
static void find_spans(const double (*record)[4], size_t n, const double extent[4], bool weighted,
                       brio_span *coordinates, brio_span *weights) {
    frexp(fmax(extent[0], fmax(extent[1], extent[2])), &coordinates->high);
    frexp(extent[3], &weights->high);
    coordinates->low = coordinates->high;
    weights->low = weights->high;
    for (size_t i = 0; i < n && coordinates->high - coordinates->low <= COARSE_BITS; i++) {
        for (int k = 0; k < 3; k++) {
            int bit = brio_span_of(record[i][k]).low;
            coordinates->low = bit < coordinates->low ? bit : coordinates->low;
        }
        int bit = weighted ? brio_span_of(record[i][3]).low : INT32_MAX;
        weights->low = bit < weights->low ? bit : weights->low;
    }
}

static int most(int a, int b) {
    return a > b ? a : b;
}
static int least(int a, int b) {
    return a < b ? a : b;
}

/* Returns whether the in-sphere determinant is exact in doubles. A lift is a sum of three squares and a weight; its
 * unit is the lesser of the squared coordinate unit and the weight unit. A minor is a sum of six products of three
 * differences. The determinant is a sum of four products of a lift and a minor. */
static bool exact_in_doubles(brio_span c, brio_span w, bool weighted) {
    int low = weighted ? least(2 * c.low, w.low) : 2 * c.low,
        high = weighted ? most(2 * c.high + 2, w.high) + 1 : 2 * c.high + 2;
    return (high - low) + 3 * (c.high - c.low) + 3 + 2 <= 53;
}

/* Returns whether the differences of coordinates fit 20 bits in a unit whose square divides the weights (integer.c). */
static bool fits_integers(brio_span c, brio_span w, bool weighted) {
    int low = c.low;
    if (weighted) low = least(low, brio_half_exponent(w.low));
    return c.high - low <= 20 && (!weighted || w.high - 2 * low <= 42);
}

void brio_filter_for(brio_filter *f, const double (*record)[4], size_t n, bool weighted) {
    enum { FAR = 150 };
    double low[4], high[4], extent[4];
    for (int c = 0; c < 4; c++) low[c] = high[c] = n ? record[0][c] : 0;
    for (size_t i = 1; i < n; i++)
        for (int c = 0; c < 4; c++) {
            double x = record[i][c];
            low[c] = x < low[c] ? x : low[c];
            high[c] = x > high[c] ? x : high[c];
        }
    for (int c = 0; c < 4; c++) extent[c] = high[c] - low[c];
    brio_filter_set(f, extent, extent[3], weighted);
    if (f->orient_floor == INFINITY) return;
    brio_span coordinates, weights;
    find_spans(record, n, extent, weighted, &coordinates, &weights);
    bool ordinary = coordinates.low > -FAR && coordinates.high < FAR;
    if (weighted) ordinary &= weights.low > -2 * FAR && weights.high < 2 * FAR;
    f->coarse = ordinary && fits_integers(coordinates, weights, weighted);
    f->lattice = ordinary && exact_in_doubles(coordinates, weights, weighted);
    if (f->lattice) f->orient_static = f->insphere_static = 0;
}

/* --- orient3d --- */

static double orient3d_with_permanent(const double *a, const double *b, const double *c, const double *d,
                                      double *permanent) {
    double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
    double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
    double dx = d[0] - a[0], dy = d[1] - a[1], dz = d[2] - a[2];
    *permanent = fabs(dx) * (fabs(by * cz) + fabs(bz * cy)) + fabs(dy) * (fabs(bz * cx) + fabs(bx * cz)) +
                 fabs(dz) * (fabs(bx * cy) + fabs(by * cx));
    return dx * (by * cz - bz * cy) + dy * (bz * cx - bx * cz) + dz * (bx * cy - by * cx);
}

int brio_orient3d_rescaled(const brio_filter *f, const double *a, const double *b, const double *c, const double *d) {
    const double *const row[4] = {b, c, d, a};
    double permanent;
    brio_near_one r;
    orient3d_with_permanent(a, b, c, d, &permanent);
    if (!brio_floor_matters(permanent, f->orient_floor)) return 2;
    if (!brio_bring_near_one(row, 4, false, 0, &r)) return 2;
    double det = orient3d_with_permanent(r.row[3], r.row[0], r.row[1], r.row[2], &permanent);
    if (fabs(det) > ORIENT_BOUND * permanent + orient_floor(1)) return det > 0 ? 1 : -1;
    return brio_orient3d_double_double(r.row[3], r.row[0], r.row[1], r.row[2],
                                       (brio_magnitude){permanent, orient_floor(1)});
}

int brio_orient3d_unsettled(brio_filter *f, const double *a, const double *b, const double *c, const double *d) {
    double permanent;
    if (f->lattice) return 0;
    double det = orient3d_with_permanent(a, b, c, d, &permanent);
    double bound = ORIENT_BOUND * permanent + f->orient_floor;
    if (fabs(det) > bound) return det > 0 ? 1 : -1;
    f->unsettled++;
    int sign = f->coarse ? 2 : brio_orient3d_double_double(a, b, c, d, (brio_magnitude){permanent, f->orient_floor});
    return sign != 2 ? sign : brio_orient3d_late(f, a, b, c, d);
}

int brio_orient3d_late(brio_filter *f, const double *a, const double *b, const double *c, const double *d) {
    int sign = f->coarse ? 2 : brio_orient3d_rescaled(f, a, b, c, d);
    if (sign != 2) return sign;
    f->exact++;
    return brio_orient3d_exact(a, b, c, d);
}

/* --- insphere --- */

static double insphere_permanent(const double *a, const double *b, const double *c, const double *d, const double *e,
                                 bool weighted) {
    const double *row[4] = {a, b, c, d};
    double x[4], y[4], z[4], lift[4], xy[4][4];
    for (int i = 0; i < 4; i++) {
        x[i] = fabs(row[i][0] - e[0]), y[i] = fabs(row[i][1] - e[1]), z[i] = fabs(row[i][2] - e[2]);
        lift[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i] + (weighted ? fabs(row[i][3] - e[3]) : 0);
    }
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++) xy[i][j] = x[i] * y[j] + x[j] * y[i];
    return lift[0] * (z[1] * xy[2][3] + z[2] * xy[1][3] + z[3] * xy[1][2]) +
           lift[1] * (z[2] * xy[0][3] + z[3] * xy[0][2] + z[0] * xy[2][3]) +
           lift[2] * (z[3] * xy[0][1] + z[0] * xy[1][3] + z[1] * xy[0][3]) +
           lift[3] * (z[0] * xy[1][2] + z[1] * xy[0][2] + z[2] * xy[0][1]);
}

int brio_insphere_rescaled(const brio_filter *f, const double *const row[5]) {
    double permanent = insphere_permanent(row[0], row[1], row[2], row[3], row[4], f->weighted);
    brio_near_one r;
    if (!brio_floor_matters(permanent, f->insphere_floor)) return 2;
    if (!brio_bring_near_one(row, 5, f->weighted, WEIGHT_MOST, &r)) return 2;
    const double *const p[5] = {r.row[0], r.row[1], r.row[2], r.row[3], r.row[4]};
    double det = brio_insphere_estimate(p[0], p[1], p[2], p[3], p[4], f->weighted);
    permanent = insphere_permanent(p[0], p[1], p[2], p[3], p[4], f->weighted);
    brio_magnitude magnitude = {permanent, insphere_floor(1, r.most_weight)};
    if (fabs(det) > INSPHERE_BOUND * permanent + magnitude.floor) return det > 0 ? 1 : -1;
    return brio_insphere_double_double(p, f->weighted, magnitude);
}

int brio_insphere_unsettled(brio_filter *f, const double *a, const double *b, const double *c, const double *d,
                            const double *e) {
    if (f->lattice) return 0;
    double det = brio_insphere_estimate(a, b, c, d, e, f->weighted);
    double permanent = insphere_permanent(a, b, c, d, e, f->weighted);
    double bound = INSPHERE_BOUND * permanent + f->insphere_floor;
    if (fabs(det) > bound) return det > 0 ? 1 : -1;
    f->unsettled++;
    const double *const row[5] = {a, b, c, d, e};
    brio_magnitude magnitude = {permanent, f->insphere_floor};
    int sign = f->coarse ? 2 : brio_insphere_double_double(row, f->weighted, magnitude);
    return sign != 2 ? sign : brio_insphere_late(f, row);
}

int brio_insphere_late(brio_filter *f, const double *const row[5]) {
    int sign = f->coarse ? 2 : brio_insphere_rescaled(f, row);
    if (sign != 2) return sign;
    f->exact++;
    return brio_insphere_exact(row[0], row[1], row[2], row[3], row[4], f->weighted);
}

/* --- power distances --- */

static double power(const double *x, const double *p, double *magnitude) {
    double dx = x[0] - p[0], dy = x[1] - p[1], dz = x[2] - p[2], square = dx * dx + dy * dy + dz * dz;
    *magnitude += square + fabs(p[3]);
    return square - p[3];
}

int brio_power_compare(const double *x, const double *p, const double *q) {
    double magnitude = 0, difference = power(x, p, &magnitude) - power(x, q, &magnitude);
    /* Each sum of squares has an error of at most 5 u, each of three more operations 1 u. NaN and infinity compare
     * false. */
    if (fabs(difference) > 10 * 0x1p-53 * magnitude + 0x1p-1000 && magnitude < INFINITY) return difference > 0 ? 1 : -1;
    int sign = brio_power_compare_double_double(x, p, q, magnitude);
    return sign != 2 ? sign : brio_power_compare_exact(x, p, q);
}
