/* Floating-point stages of the plane's predicates: error bounds, the permanents from which they are derived, and stages
 * 2 and 3 of rows that are scaled where underflow or overflow would count.
 *
 * The permanent of an expression is the expression with every term replaced by its magnitude. With u = 2^-53, the error
 * of an estimate is, in the first order,
 *   orient2d  3 u times the permanent (Shewchuk's ccwerrboundA),
 *   incircle  13 u times the permanent: 6 u of a lift (one of its difference, doubled and rounded in the square, two
 *             sums, one difference of weights), 4 u of a minor, 1 u of their product, 2 u of the sum of three products.
 * ORIENT_BOUND and INCIRCLE_BOUND round these up to 4 u and 14 u.
 *
 * The symbolic perturbation is that of perturb.c, one dimension lower. */
#include "predicates/plane.h"
#include "predicates/span.h"
#include <math.h>

static const double ORIENT_BOUND = 4 * 0x1p-53, INCIRCLE_BOUND = 14 * 0x1p-53;

/* Chosen: with larger extents, stages 1 to 3 could overflow (polynomials of degree 4, Dekker's splitting). */
static const double EXTENT_MOST = 1e55, WEIGHT_MOST = 1e110;

/* Some thirty products may each lose 2^-1074 by underflow; the floor multiplies this by the largest cofactors. */
static const double FLOOR_UNIT = 0x1p-1060;

static double incircle_floor(double most, double w) {
    return FLOOR_UNIT * (1 + most) * (1 + most) * (1 + most * most + w);
}

void brio_plane_filter_set(brio_plane_filter *f, const double extent[4], bool general) {
    double x = extent[0], y = extent[1], z = general ? extent[2] : 0, w = general ? extent[3] : 0;
    double most = fmax(x, fmax(y, z));
    *f = (brio_plane_filter){INFINITY, INFINITY, INFINITY, INFINITY, general, false, {0, 1, 2}, 0, 0};
    if (!(most <= EXTENT_MOST && w <= WEIGHT_MOST)) return;
    f->orient_floor = FLOOR_UNIT;
    f->incircle_floor = incircle_floor(most, w);
    /* orient2d has 2 products, incircle 3 minors times a lift; 1.001 covers the rounding of the bound */
    f->orient_static = 1.001 * ORIENT_BOUND * 2 * x * y + f->orient_floor;
    f->incircle_static = 1.001 * INCIRCLE_BOUND * 6 * x * y * (x * x + y * y + z * z + w) + f->incircle_floor;
}

static int most_of(int a, int b) {
    return a > b ? a : b;
}
static int least_of(int a, int b) {
    return a < b ? a : b;
}

/* Returns whether the in-circle determinant is exact in doubles for numbers with these spans. A lift is a sum of three
 * squares and a weight; a minor is a sum of two products; the determinant is a sum of three products of both. */
static bool exact_in_doubles(brio_span c, brio_span w, bool general) {
    int low = general ? least_of(2 * c.low, w.low) : 2 * c.low;
    int high = general ? most_of(2 * c.high + 2, w.high) + 1 : 2 * c.high + 1;
    return (high - low) + 2 * (c.high - c.low) + 1 + 2 <= 53;
}

/* Returns whether stage 1 is exact. Stops reading once the coordinates need more bits than it could have. */
static bool on_lattice(const double (*record)[4], size_t n, const double extent[4], bool general) {
    enum { MOST_BITS = 12, FAR = 150 };
    brio_span c, w;
    frexp(fmax(extent[0], fmax(extent[1], general ? extent[2] : 0)), &c.high);
    frexp(extent[3], &w.high);
    c.low = c.high;
    w.low = w.high;
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < (general ? 3 : 2); k++) c.low = least_of(c.low, brio_span_of(record[i][k]).low);
        if (general) w.low = least_of(w.low, brio_span_of(record[i][3]).low);
        if (c.high - c.low > MOST_BITS) return false;
    }
    bool ordinary = c.low > -FAR && c.high < FAR && (!general || (w.low > -2 * FAR && w.high < 2 * FAR));
    return ordinary && exact_in_doubles(c, w, general);
}

void brio_plane_filter_for(brio_plane_filter *f, const double (*record)[4], size_t n, bool general) {
    double low[4], high[4], extent[4];
    uint8_t key[3] = {f->key[0], f->key[1], f->key[2]};
    for (int c = 0; c < 4; c++) low[c] = high[c] = n ? record[0][c] : 0;
    for (size_t i = 1; i < n; i++)
        for (int c = 0; c < 4; c++) {
            double x = record[i][c];
            low[c] = x < low[c] ? x : low[c];
            high[c] = x > high[c] ? x : high[c];
        }
    for (int c = 0; c < 4; c++) extent[c] = high[c] - low[c];
    brio_plane_filter_set(f, extent, general);
    for (int i = 0; i < 3; i++) f->key[i] = key[i];
    if (f->orient_floor == INFINITY) return;
    f->lattice = on_lattice(record, n, extent, general);
    if (f->lattice) f->orient_static = f->incircle_static = 0;
}

static double orient2d_with_permanent(const double *a, const double *b, const double *c, double *permanent) {
    double first = (b[0] - a[0]) * (c[1] - a[1]), second = (b[1] - a[1]) * (c[0] - a[0]);
    *permanent = fabs(first) + fabs(second);
    return first - second;
}

int brio_orient2d_rescaled(const brio_plane_filter *f, const double *a, const double *b, const double *c) {
    double u[3][4] = {{a[0], a[1]}, {b[0], b[1]}, {c[0], c[1]}}, permanent;
    const double *const row[3] = {u[0], u[1], u[2]};
    brio_near_one r;
    orient2d_with_permanent(a, b, c, &permanent);
    if (!brio_floor_matters(permanent, f->orient_floor)) return 2;
    if (!brio_bring_near_one(row, 3, false, 0, &r)) return 2;
    double det = orient2d_with_permanent(r.row[0], r.row[1], r.row[2], &permanent);
    if (fabs(det) > ORIENT_BOUND * permanent + FLOOR_UNIT) return det > 0 ? 1 : -1;
    return brio_orient2d_double_double(r.row[0], r.row[1], r.row[2], permanent, FLOOR_UNIT);
}

int brio_orient2d_unsettled(brio_plane_filter *f, const double *a, const double *b, const double *c) {
    if (f->lattice) return 0;
    double permanent, det = orient2d_with_permanent(a, b, c, &permanent);
    if (fabs(det) > ORIENT_BOUND * permanent + f->orient_floor) return det > 0 ? 1 : -1;
    f->unsettled++;
    int sign = brio_orient2d_double_double(a, b, c, permanent, f->orient_floor);
    if (sign == 2) sign = brio_orient2d_rescaled(f, a, b, c);
    if (sign != 2) return sign;
    f->exact++;
    return brio_orient2d_exact(a, b, c);
}

static double incircle_permanent(const double *a, const double *b, const double *c, const double *e, bool general) {
    const double *row[3] = {a, b, c};
    double x[3], y[3], lift[3], sum = 0;
    for (int i = 0; i < 3; i++) {
        double z = general ? row[i][2] - e[2] : 0;
        x[i] = fabs(row[i][0] - e[0]), y[i] = fabs(row[i][1] - e[1]);
        lift[i] = x[i] * x[i] + y[i] * y[i] + z * z + (general ? fabs(row[i][3] - e[3]) : 0);
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        sum += lift[i] * (x[j] * y[k] + x[k] * y[j]);
    }
    return sum;
}

int brio_incircle_rescaled(const brio_plane_filter *f, const double *const row[4]) {
    double permanent = incircle_permanent(row[0], row[1], row[2], row[3], f->general);
    brio_near_one r;
    if (!brio_floor_matters(permanent, f->incircle_floor)) return 2;
    if (!brio_bring_near_one(row, 4, f->general, WEIGHT_MOST, &r)) return 2;
    const double *const p[4] = {r.row[0], r.row[1], r.row[2], r.row[3]};
    double det = brio_incircle_estimate(p[0], p[1], p[2], p[3], f->general), floor = incircle_floor(1, r.most_weight);
    permanent = incircle_permanent(p[0], p[1], p[2], p[3], f->general);
    if (fabs(det) > INCIRCLE_BOUND * permanent + floor) return det > 0 ? 1 : -1;
    return brio_incircle_double_double(p, permanent, floor);
}

int brio_incircle_unsettled(brio_plane_filter *f, const double *a, const double *b, const double *c, const double *e) {
    if (f->lattice) return 0;
    double det = brio_incircle_estimate(a, b, c, e, f->general);
    double permanent = incircle_permanent(a, b, c, e, f->general);
    if (fabs(det) > INCIRCLE_BOUND * permanent + f->incircle_floor) return det > 0 ? 1 : -1;
    f->unsettled++;
    const double *const row[4] = {a, b, c, e};
    int sign = brio_incircle_double_double(row, permanent, f->incircle_floor);
    if (sign == 2) sign = brio_incircle_rescaled(f, row);
    if (sign != 2) return sign;
    f->exact++;
    return brio_incircle_exact(a, b, c, e);
}

int brio_incircle_tie(brio_plane_filter *f, const double *a, const double *b, const double *c, const double *e) {
    const double *p[3] = {a, b, c}, *decisive = e;
    int decision = -1;
    for (int i = 0; i < 3; i++) {
        if (brio_plane_lexicographic(f, p[i], decisive) < 0) continue;
        const double *q[3] = {a, b, c};
        q[i] = e;
        int sign = brio_orient2d_sign(f, q[0], q[1], q[2]);
        if (sign) decisive = p[i], decision = sign;
    }
    return decision;
}
