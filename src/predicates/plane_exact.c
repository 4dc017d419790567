/* Stages 3 to 5 of the plane's predicates: double-doubles; integers where the points are on a grid; dyadic numbers,
 * which hold every finite double.
 *
 * BOUND is derived as in double_double.c: along any path through the in-circle determinant the errors add up to less
 * than 50 u^2 of the permanent, 7 u^2 for each of three products and 3 u^2 for each of eight sums. Lifts always have
 * `rest` and the weight, which are 0 where the filter ignores them.
 *
 * Integers of 61 bits leave lifts and minors below 2^125, so that the sum of three products fits 256 bits. With 30 bits
 * it fits 128 bits. */
#include "predicates/dyadic.h"
#include "predicates/double_double.h"
#include "predicates/grid_rows.h"
#include "predicates/plane.h"
#include <math.h>

enum { NARROW_BITS = 30, WIDE_BITS = 61, DECLINED = 2 };

static const double BOUND = 0x1p-99;

/* --- stage 3 --- */

static inline int decide(brio_dd det, double permanent, double floor) {
    if (!(fabs(det.hi) > BOUND * permanent + floor)) return DECLINED;
    return det.hi > 0 ? 1 : -1;
}

BRIO_INLINE brio_dd orient2d(const double *a, const double *b, const double *c, const bool fma) {
    brio_dd bx = dd_difference(b[0], a[0]), by = dd_difference(b[1], a[1]);
    brio_dd cx = dd_difference(c[0], a[0]), cy = dd_difference(c[1], a[1]);
    return dd_minor(bx, cy, by, cx, fma);
}

BRIO_INLINE brio_dd incircle(const double *const row[4], const bool fma) {
    brio_dd r[3][3], lift[3];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) r[i][k] = dd_difference(row[i][k], row[3][k]);
        brio_dd square = dd_sum3(dd_multiply(r[i][0], r[i][0], fma), dd_multiply(r[i][1], r[i][1], fma),
                                 dd_multiply(r[i][2], r[i][2], fma));
        lift[i] = dd_subtract(square, dd_difference(row[i][3], row[3][3]));
    }
    brio_dd bc = dd_minor(r[1][0], r[2][1], r[2][0], r[1][1], fma);
    brio_dd ca = dd_minor(r[2][0], r[0][1], r[0][0], r[2][1], fma);
    brio_dd ab = dd_minor(r[0][0], r[1][1], r[1][0], r[0][1], fma);
    return dd_sum3(dd_multiply(lift[0], bc, fma), dd_multiply(lift[1], ca, fma), dd_multiply(lift[2], ab, fma));
}

BRIO_TARGET_FMA static brio_dd orient2d_fma(const double *a, const double *b, const double *c) {
    return orient2d(a, b, c, true);
}

BRIO_TARGET_FMA static brio_dd incircle_fma(const double *const row[4]) {
    return incircle(row, true);
}

int brio_orient2d_double_double(const double *a, const double *b, const double *c, double permanent, double floor) {
    return decide(brio_have_fma() ? orient2d_fma(a, b, c) : orient2d(a, b, c, false), permanent, floor);
}

int brio_incircle_double_double(const double *const row[4], double permanent, double floor) {
    return decide(brio_have_fma() ? incircle_fma(row) : incircle(row, false), permanent, floor);
}

/* --- stage 4 --- */

static inline brio_wide minor2(const int64_t *p, const int64_t *q) {
    return (brio_wide)p[0] * q[1] - (brio_wide)p[1] * q[0];
}

/* Writes the rows p[i] - origin for records whose third number does not count. */
static bool flat_rows(const double *a, const double *b, const double *c, int64_t (*row)[3]) {
    double flat[3][3] = {{a[0], a[1], 0}, {b[0], b[1], 0}, {c[0], c[1], 0}};
    const double *p[2] = {flat[1], flat[2]};
    return brio_grid_rows(p, 2, flat[0], WIDE_BITS, row, NULL);
}

int brio_orient2d_integer(const double *a, const double *b, const double *c) {
    int64_t row[2][3];
    return flat_rows(a, b, c, row) ? brio_sign_of_wide(minor2(row[0], row[1])) : DECLINED;
}

int brio_incircle_integer(const double *a, const double *b, const double *c, const double *e) {
    const double *p[3] = {a, b, c};
    int64_t r[3][3];
    brio_wide lift[3];
    if (!brio_grid_rows(p, 3, e, WIDE_BITS, r, lift)) return DECLINED;
    bool narrow = brio_bits_of((const int64_t(*)[3])r, 3) <= NARROW_BITS;
    brio_sum256 sum = {0, 0};
    brio_wide narrow_sum = 0;
    for (int i = 0; i < 3; i++) {
        brio_wide weight = lift[i];
        narrow &= weight < (brio_wide)1 << 61 && weight > -((brio_wide)1 << 61);
        lift[i] = (brio_wide)r[i][0] * r[i][0] + (brio_wide)r[i][1] * r[i][1] + (brio_wide)r[i][2] * r[i][2] - weight;
    }
    for (int i = 0; i < 3; i++) {
        brio_wide minor = minor2(r[(i + 1) % 3], r[(i + 2) % 3]);
        if (narrow)
            narrow_sum += lift[i] * minor;
        else
            brio_add_product(&sum, lift[i], minor, 1);
    }
    return narrow ? brio_sign_of_wide(narrow_sum) : brio_sum256_sign(sum);
}

/* --- stage 5 --- */

/* Sets r = x y - z w. */
static void dyadic_minor(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y, const brio_dyadic *z,
                         const brio_dyadic *w) {
    brio_dyadic p, q;
    brio_dyadic_multiply(&p, x, y);
    brio_dyadic_multiply(&q, z, w);
    brio_dyadic_add(r, &p, &q, -1);
}

int brio_orient2d_dyadic(const double *a, const double *b, const double *c) {
    brio_dyadic d[4], det;
    brio_dyadic_difference(&d[0], b[0], a[0]);
    brio_dyadic_difference(&d[1], c[1], a[1]);
    brio_dyadic_difference(&d[2], b[1], a[1]);
    brio_dyadic_difference(&d[3], c[0], a[0]);
    dyadic_minor(&det, &d[0], &d[1], &d[2], &d[3]);
    return det.sign;
}

/* Sets lift = |row|^2 - (weight of p - weight of e). */
static void dyadic_lift(brio_dyadic *lift, const brio_dyadic row[3], const double *p, const double *e) {
    brio_dyadic t;
    brio_dyadic_multiply(lift, &row[0], &row[0]);
    for (int k = 1; k < 3; k++) {
        brio_dyadic_multiply(&t, &row[k], &row[k]);
        brio_dyadic_add(lift, lift, &t, 1);
    }
    brio_dyadic_difference(&t, p[3], e[3]);
    brio_dyadic_add(lift, lift, &t, -1);
}

int brio_incircle_dyadic(const double *a, const double *b, const double *c, const double *e) {
    const double *p[3] = {a, b, c};
    brio_dyadic row[3][3], det = {0}, lift, minor, term;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) brio_dyadic_difference(&row[i][k], p[i][k], e[k]);
    for (int i = 0; i < 3; i++) {
        const brio_dyadic *q = row[(i + 1) % 3], *s = row[(i + 2) % 3];
        dyadic_minor(&minor, &q[0], &s[1], &q[1], &s[0]);
        dyadic_lift(&lift, row[i], p[i], e);
        brio_dyadic_multiply(&term, &lift, &minor);
        brio_dyadic_add(&det, &det, &term, 1);
    }
    return det.sign;
}

int brio_orient2d_exact(const double *a, const double *b, const double *c) {
    int sign = brio_orient2d_integer(a, b, c);
    return sign != DECLINED ? sign : brio_orient2d_dyadic(a, b, c);
}

int brio_incircle_exact(const double *a, const double *b, const double *c, const double *e) {
    int sign = brio_incircle_integer(a, b, c, e);
    return sign != DECLINED ? sign : brio_incircle_dyadic(a, b, c, e);
}
