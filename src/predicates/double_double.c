/* Stage 3 of the predicates: the determinants in double-double arithmetic.
 *
 * BOUND is derived. Along any path through the in-sphere determinant the errors of double_double.h add up to less than
 * 60 u^2 of the permanent: 7 u^2 for each of four products, 3 u^2 for each of nine sums. So 2^-99 = 128 u^2 is a safe
 * bound. The rows relative to e and the differences of weights are exact in double-doubles. */
#include "predicates/double_double.h"
#include "predicates/predicates.h"

static const double BOUND = 0x1p-99;

static inline int sign_of(brio_dd det, brio_magnitude m) {
    if (!(fabs(det.hi) > BOUND * m.permanent + m.floor)) return 2;
    return det.hi > 0 ? 1 : -1;
}

BRIO_INLINE int orient3d(const double *a, const double *b, const double *c, const double *d, brio_magnitude magnitude,
                         const bool fma) {
    brio_dd m[3][3];
    for (int k = 0; k < 3; k++) {
        m[0][k] = dd_difference(b[k], a[k]);
        m[1][k] = dd_difference(c[k], a[k]);
        m[2][k] = dd_difference(d[k], a[k]);
    }
    brio_dd x = dd_multiply(m[2][0], dd_minor(m[0][1], m[1][2], m[0][2], m[1][1], fma), fma);
    brio_dd y = dd_multiply(m[2][1], dd_minor(m[0][2], m[1][0], m[0][0], m[1][2], fma), fma);
    brio_dd z = dd_multiply(m[2][2], dd_minor(m[0][0], m[1][1], m[0][1], m[1][0], fma), fma);
    return sign_of(dd_sum3(x, y, z), magnitude);
}

BRIO_INLINE brio_dd lift_of(const brio_dd r[3], const double *p, const double *e, const bool weighted, const bool fma) {
    brio_dd lift = dd_sum3(dd_multiply(r[0], r[0], fma), dd_multiply(r[1], r[1], fma), dd_multiply(r[2], r[2], fma));
    return weighted ? dd_subtract(lift, dd_difference(p[3], e[3])) : lift;
}

/* The two factors of a product. */
typedef struct {
    brio_dd z, m;
} product;

/* Returns the sum of three products. */
BRIO_INLINE brio_dd expand(product a, product b, product c, const bool fma) {
    return dd_sum3(dd_multiply(a.z, a.m, fma), dd_multiply(b.z, b.m, fma), dd_multiply(c.z, c.m, fma));
}

BRIO_INLINE brio_dd negated(brio_dd x) {
    return (brio_dd){-x.hi, -x.lo};
}

BRIO_INLINE int insphere(const double *const row[5], const bool weighted, brio_magnitude magnitude, const bool fma) {
    const double *e = row[4];
    brio_dd r[4][3], lift[4];
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) r[i][k] = dd_difference(row[i][k], e[k]);
        lift[i] = lift_of(r[i], row[i], e, weighted, fma);
    }
    brio_dd ab = dd_minor(r[0][0], r[1][1], r[1][0], r[0][1], fma);
    brio_dd bc = dd_minor(r[1][0], r[2][1], r[2][0], r[1][1], fma);
    brio_dd cd = dd_minor(r[2][0], r[3][1], r[3][0], r[2][1], fma);
    brio_dd da = dd_minor(r[3][0], r[0][1], r[0][0], r[3][1], fma);
    brio_dd ac = dd_minor(r[0][0], r[2][1], r[2][0], r[0][1], fma);
    brio_dd bd = dd_minor(r[1][0], r[3][1], r[3][0], r[1][1], fma);
    brio_dd abc = expand((product){r[0][2], bc}, (product){r[1][2], negated(ac)}, (product){r[2][2], ab}, fma);
    brio_dd bcd = expand((product){r[1][2], cd}, (product){r[2][2], negated(bd)}, (product){r[3][2], bc}, fma);
    brio_dd cda = expand((product){r[2][2], da}, (product){r[3][2], ac}, (product){r[0][2], cd}, fma);
    brio_dd dab = expand((product){r[3][2], ab}, (product){r[0][2], bd}, (product){r[1][2], da}, fma);
    brio_dd first = dd_minor(lift[2], dab, lift[3], abc, fma), second = dd_minor(lift[0], bcd, lift[1], cda, fma);
    return sign_of(dd_add(first, second), magnitude);
}

BRIO_TARGET_FMA static int orient3d_fma(const double *a, const double *b, const double *c, const double *d,
                                        brio_magnitude magnitude) {
    return orient3d(a, b, c, d, magnitude, true);
}

BRIO_TARGET_FMA static int insphere_fma(const double *const row[5], bool weighted, brio_magnitude magnitude) {
    return insphere(row, weighted, magnitude, true);
}

int brio_orient3d_double_double(const double *a, const double *b, const double *c, const double *d,
                                brio_magnitude magnitude) {
    if (brio_have_fma()) return orient3d_fma(a, b, c, d, magnitude);
    return orient3d(a, b, c, d, magnitude, false);
}

int brio_insphere_double_double(const double *const row[5], bool weighted, brio_magnitude magnitude) {
    if (brio_have_fma()) return insphere_fma(row, weighted, magnitude);
    return insphere(row, weighted, magnitude, false);
}

/* Returns |x - p|^2 - w_p. */
BRIO_INLINE brio_dd power(const double *x, const double *p, const bool fma) {
    brio_dd d[3];
    for (int k = 0; k < 3; k++) d[k] = dd_difference(x[k], p[k]);
    brio_dd sum = dd_sum3(dd_multiply(d[0], d[0], fma), dd_multiply(d[1], d[1], fma), dd_multiply(d[2], d[2], fma));
    return dd_subtract(sum, (brio_dd){p[3], 0});
}

BRIO_INLINE int power_compare(const double *x, const double *p, const double *q, double magnitude, const bool fma) {
    /* The error is at most 20 u^2 of the magnitude. Below 2^500 nothing overflows, and underflow costs less than
     * 2^-900. */
    if (!(magnitude < 0x1p500)) return 2;
    return sign_of(dd_subtract(power(x, p, fma), power(x, q, fma)), (brio_magnitude){magnitude, 0x1p-900});
}

BRIO_TARGET_FMA static int power_compare_fma(const double *x, const double *p, const double *q, double magnitude) {
    return power_compare(x, p, q, magnitude, true);
}

int brio_power_compare_double_double(const double *x, const double *p, const double *q, double magnitude) {
    if (brio_have_fma()) return power_compare_fma(x, p, q, magnitude);
    return power_compare(x, p, q, magnitude, false);
}
