/* The Gabriel test: is a point strictly inside the smallest orthosphere of an edge or a facet?
 *
 * Let a, b (and c) be the weighted vertices, d the point, U = b - a, V = c - a, A = a - d. The centre of the smallest
 * orthosphere is z = a + y with y in the span of U and V and 2 U y = U^2 - (wb - wa) = beta, 2 V y = V^2 - (wc - wa) =
 * gamma. The power distance of d from z less the squared radius is kappa + 2 A y with kappa = A^2 + wa - wd. Cramer's
 * rule gives, times the positive Gram determinant,
 *   edge    kappa U^2 + beta (A U)
 *   facet   kappa (U^2 V^2 - (U V)^2) + beta ((A U) V^2 - (A V)(U V)) + gamma ((A V) U^2 - (A U)(U V)).
 * d is inside when this is negative.
 *
 * Stages: doubles against a bound from the call's own terms; integers for points on a grid; dyadic numbers. With u =
 * 2^-53 a scalar product of differences is wrong by at most 6 u times its magnitude, kappa, beta and gamma by 8 u, and
 * a sum of products of three of them by less than 40 u; BOUND is 64 u.
 *
 * Based on: Edelsbrunner, Muecke. Three-dimensional alpha shapes. TOG 1994. */
#include "predicates/dyadic.h"
#include "predicates/grid_rows.h"
#include "predicates/predicates.h"

static const double BOUND = 64 * 0x1p-53;

/* NARROW: with b bits for coordinates and 2 b + 2 for weights, the sum is less than 315 * 2^(6 b), below 2^127. */
enum { NARROW_BITS = 19, NARROW_WEIGHT = 40, UNDECIDED = 2 };

/* --- doubles --- */

/* A rounded number, and the sum of the magnitudes of its terms. */
typedef struct {
    double x, size;
} rounded;

static rounded dot(const double *p, const double *q, const double *r, const double *s) {
    rounded sum = {0, 0};
    for (int k = 0; k < 3; k++) {
        double term = (p[k] - q[k]) * (r[k] - s[k]);
        sum.x += term;
        sum.size += fabs(term);
    }
    return sum;
}

static rounded less_weight(rounded square, const double *p, const double *q, bool weighted) {
    if (!weighted) return square;
    double w = p[3] - q[3];
    return (rounded){square.x - w, square.size + fabs(w)};
}

static rounded product(rounded a, rounded b) {
    return (rounded){a.x * b.x, a.size * b.size};
}

static rounded sum(rounded a, rounded b, int sign) {
    return (rounded){a.x + sign * b.x, a.size + b.size};
}

static int attached_rounded(const double *const *p, int count, bool weighted) {
    const double *a = p[0], *b = p[1], *c = p[2], *d = p[count];
    rounded kappa = less_weight(dot(a, d, a, d), d, a, weighted), uu = dot(b, a, b, a), au = dot(a, d, b, a);
    rounded beta = less_weight(uu, b, a, weighted), value = sum(product(kappa, uu), product(beta, au), 1);
    double most = fmax(kappa.size, beta.size);
    if (count == 3) {
        rounded vv = dot(c, a, c, a), uv = dot(b, a, c, a), av = dot(a, d, c, a);
        rounded gamma = less_weight(vv, c, a, weighted);
        rounded gram = sum(product(uu, vv), product(uv, uv), -1);
        rounded first = sum(product(au, vv), product(av, uv), -1), second = sum(product(av, uu), product(au, uv), -1);
        value = sum(sum(product(kappa, gram), product(beta, first), 1), product(gamma, second), 1);
        most = fmax(most, fmax(vv.size, gamma.size));
    }
    /* fewer than a hundred products may each lose 2^-1074, and be multiplied by two more factors */
    double bound = BOUND * value.size + 0x1p-1060 * (1 + most) * (1 + most);
    if (!(fabs(value.x) > bound && bound < INFINITY)) return UNDECIDED;
    return value.x < 0;
}

/* --- integers --- */

static brio_wide dot_integer(const int64_t *p, const int64_t *q) {
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

/* Returns the sign by integers, 2 where the points are on no grid. The rows are U, V (for a facet) and -A. */
static int attached_integer(const double *const *p, int count, bool weighted) {
    int64_t row[3][3];
    brio_wide w[3] = {0, 0, 0};
    if (!brio_grid_rows(p + 1, count, p[0], NARROW_BITS, row, weighted ? w : NULL)) return UNDECIDED;
    for (int i = 0; i < count; i++)
        if (w[i] >> NARROW_WEIGHT != 0 && w[i] >> NARROW_WEIGHT != -1) return UNDECIDED;
    const int64_t *u = row[0], *v = row[1], *d = row[count - 1];
    brio_wide kappa = dot_integer(d, d) - w[count - 1], uu = dot_integer(u, u), au = -dot_integer(d, u);
    brio_wide beta = uu - w[0];
    if (count == 2) return kappa * uu + beta * au < 0;
    brio_wide vv = dot_integer(v, v), uv = dot_integer(u, v), av = -dot_integer(d, v), gamma = vv - w[1];
    return kappa * (uu * vv - uv * uv) + beta * (au * vv - av * uv) + gamma * (av * uu - au * uv) < 0;
}

/* --- dyadic numbers --- */

static void dot_dyadic(brio_dyadic *r, const double *p, const double *q, const double *s, const double *t) {
    brio_dyadic one, other, term;
    brio_dyadic_set(r, 0);
    for (int k = 0; k < 3; k++) {
        brio_dyadic_difference(&one, p[k], q[k]);
        brio_dyadic_difference(&other, s[k], t[k]);
        brio_dyadic_multiply(&term, &one, &other);
        brio_dyadic_add(r, r, &term, 1);
    }
}

static void square_less_weight(brio_dyadic *r, const double *p, const double *q, bool weighted) {
    brio_dyadic w;
    dot_dyadic(r, p, q, p, q);
    if (!weighted) return;
    brio_dyadic_difference(&w, p[3], q[3]);
    brio_dyadic_add(r, r, &w, -1);
}

/* Sets r = a b - c d. */
static void minor(brio_dyadic *r, const brio_dyadic *a, const brio_dyadic *b, const brio_dyadic *c,
                  const brio_dyadic *d) {
    brio_dyadic one, other;
    brio_dyadic_multiply(&one, a, b);
    brio_dyadic_multiply(&other, c, d);
    brio_dyadic_add(r, &one, &other, -1);
}

/* Adds (|p - q|^2 - (wp - wq)) x to the sum. */
static void add_lift(brio_dyadic *sum_of, const double *p, const double *q, bool weighted, const brio_dyadic *x) {
    brio_dyadic lift, term;
    square_less_weight(&lift, p, q, weighted);
    brio_dyadic_multiply(&term, &lift, x);
    brio_dyadic_add(sum_of, sum_of, &term, 1);
}

int brio_attached_dyadic(const double *const *p, int count, bool weighted) {
    const double *a = p[0], *b = p[1], *c = p[2], *d = p[count];
    brio_dyadic value, uu, au, vv, uv, av, factor;
    brio_dyadic_set(&value, 0);
    dot_dyadic(&uu, b, a, b, a);
    dot_dyadic(&au, a, d, b, a);
    if (count == 2) {
        add_lift(&value, d, a, weighted, &uu); /* |d - a|^2 - (wd - wa) is kappa */
        add_lift(&value, b, a, weighted, &au);
        return value.sign < 0;
    }
    dot_dyadic(&vv, c, a, c, a);
    dot_dyadic(&uv, b, a, c, a);
    dot_dyadic(&av, a, d, c, a);
    minor(&factor, &uu, &vv, &uv, &uv);
    add_lift(&value, d, a, weighted, &factor);
    minor(&factor, &au, &vv, &av, &uv);
    add_lift(&value, b, a, weighted, &factor);
    minor(&factor, &av, &uu, &au, &uv);
    add_lift(&value, c, a, weighted, &factor);
    return value.sign < 0;
}

bool brio_attached(const double *const *p, int count, bool weighted) {
    int answer = attached_rounded(p, count, weighted);
    if (answer == UNDECIDED) answer = attached_integer(p, count, weighted);
    return answer == UNDECIDED ? brio_attached_dyadic(p, count, weighted) : answer;
}
