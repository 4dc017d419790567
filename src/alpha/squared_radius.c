/* Squared radii in double-doubles.
 *
 * The vertices are taken relative to the first one, a, exactly, and scaled by a power of two to at most 1. Let U, V, W be
 * the others and b_i = |U_i|^2 - (w_i - w_a). The centre is a + y with y in the span of U, V, W and 2 U_i y = b_i; the
 * squared radius is |y|^2 - w_a. */
#include "alpha/squared_radius.h"
#include "base/scale.h"
#include "predicates/double_double.h"
#include <assert.h>
#include <math.h>

typedef struct {
    brio_dd row[3][3]; /* U, V, W */
    brio_dd b[3];
    int exponent; /* true coordinates are 2^exponent times these */
} simplex;

static double largest_difference(const double *const *p, int count) {
    double most = 0;
    for (int i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) most = fmax(most, fabs(p[i][k] - p[0][k]));
    return fmin(most, 0x1p1023);
}

/* Returns x 2^exponent. */
BRIO_INLINE brio_dd scaled(brio_dd x, int exponent) {
    if (exponent >= -1022 && exponent <= 1023) { /* ldexp is a call */
        double factor = brio_power_of_two(exponent);
        return (brio_dd){x.hi * factor, x.lo * factor};
    }
    return (brio_dd){ldexp(x.hi, exponent), ldexp(x.lo, exponent)};
}

BRIO_INLINE brio_dd dot(const brio_dd *x, const brio_dd *y, const bool fma) {
    return dd_sum3(dd_multiply(x[0], y[0], fma), dd_multiply(x[1], y[1], fma), dd_multiply(x[2], y[2], fma));
}

BRIO_INLINE void cross(const brio_dd *x, const brio_dd *y, brio_dd *out, const bool fma) {
    out[0] = dd_minor(x[1], y[2], x[2], y[1], fma);
    out[1] = dd_minor(x[2], y[0], x[0], y[2], fma);
    out[2] = dd_minor(x[0], y[1], x[1], y[0], fma);
}

/* Returns x / y, up to a few roundings of double-doubles. */
BRIO_INLINE brio_dd divide(brio_dd x, brio_dd y, const bool fma) {
    double first = x.hi / y.hi;
    if (!(fabs(first) < INFINITY)) return (brio_dd){first, 0};
    brio_dd rest = dd_subtract(x, dd_multiply(y, (brio_dd){first, 0}, fma));
    return dd_fast_two_sum(first, rest.hi / y.hi);
}

BRIO_INLINE void take(simplex *s, const double *const *p, int count, const bool fma) {
    assert(2 <= count && count <= 4);
    frexp(largest_difference(p, count), &s->exponent);
    for (int i = 0; i + 1 < count; i++) {
        for (int k = 0; k < 3; k++) s->row[i][k] = scaled(dd_difference(p[i + 1][k], p[0][k]), -s->exponent);
        brio_dd weight = scaled(dd_difference(p[i + 1][3], p[0][3]), -2 * s->exponent);
        s->b[i] = dd_subtract(dot(s->row[i], s->row[i], fma), weight);
    }
}

/* Returns |y|^2 = b^2 / (4 U^2). */
BRIO_INLINE brio_dd square_of_edge(const simplex *s, const bool fma) {
    brio_dd square = divide(dd_multiply(s->b[0], s->b[0], fma), dot(s->row[0], s->row[0], fma), fma);
    return scaled(square, -2);
}

/* Returns the square of a vector divided by 2 d. */
BRIO_INLINE brio_dd square_of_quotient(const brio_dd *x, brio_dd d, const bool fma) {
    brio_dd y[3];
    for (int k = 0; k < 3; k++) y[k] = divide(x[k], d, fma);
    return scaled(dot(y, y, fma), -2);
}

/* Returns |y|^2 of y = (b (V x N) + c (N x U)) / (2 N^2), N = U x V; for an edge of length 0 in doubles, NaN. */
BRIO_INLINE brio_dd square_of_facet(const simplex *s, const bool fma) {
    brio_dd normal[3], one[3], other[3];
    cross(s->row[0], s->row[1], normal, fma);
    cross(s->row[1], normal, one, fma);
    cross(normal, s->row[0], other, fma);
    for (int k = 0; k < 3; k++) one[k] = dd_add(dd_multiply(s->b[0], one[k], fma), dd_multiply(s->b[1], other[k], fma));
    return square_of_quotient(one, dot(normal, normal, fma), fma);
}

/* Returns |y|^2 of y = (b (V x W) + c (W x U) + d (U x V)) / (2 U (V x W)). */
BRIO_INLINE brio_dd square_of_tetrahedron(const simplex *s, const bool fma) {
    brio_dd vw[3], wu[3], uv[3], sum[3];
    cross(s->row[1], s->row[2], vw, fma);
    cross(s->row[2], s->row[0], wu, fma);
    cross(s->row[0], s->row[1], uv, fma);
    for (int k = 0; k < 3; k++)
        sum[k] = dd_sum3(dd_multiply(s->b[0], vw[k], fma), dd_multiply(s->b[1], wu[k], fma),
                         dd_multiply(s->b[2], uv[k], fma));
    return square_of_quotient(sum, dot(s->row[0], vw, fma), fma);
}

BRIO_INLINE double squared_radius(const double *const *p, int count, const bool fma) {
    simplex s;
    take(&s, p, count, fma);
    brio_dd square = count == 2   ? square_of_edge(&s, fma)
                     : count == 3 ? square_of_facet(&s, fma)
                                  : square_of_tetrahedron(&s, fma);
    square = scaled(square, 2 * s.exponent);
    if (!(square.hi < INFINITY)) return INFINITY;
    double power = dd_subtract(square, (brio_dd){p[0][3], 0}).hi;
    return isnan(power) ? INFINITY : power; /* a sum beyond doubles has no second part */
}

BRIO_TARGET_FMA static double squared_radius_fma(const double *const *p, int count) {
    return squared_radius(p, count, true);
}

double brio_squared_radius(const double *const *p, int count) {
    return brio_have_fma() ? squared_radius_fma(p, count) : squared_radius(p, count, false);
}
