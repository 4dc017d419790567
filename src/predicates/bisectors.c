/* Signs of polynomials in the values of g: doubles with bounds of their errors first, then dyadic numbers, then the
 * translation (bisectors.h).
 *
 * A value is a multiple of 2^-2148 below 2^2053, as the scalar products of dyadic.h are, so that products of three of
 * them, and their sums, fit.
 *
 * Based on: Edelsbrunner, Shah. Triangulating topological spaces. IJCGA 1997, for what is asked.
 *           Edelsbrunner, Muecke. Simulation of simplicity. ACM TOG 1990, for ties.
 * Differs from the paper: one translation moves the whole surface, instead of another power for each point. */
#include "predicates/bisectors.h"
#include "predicates/dyadic.h"
#include <math.h>

/* --- doubles with bounds --- */

/* A number within `error` of `value`. */
typedef struct {
    double value, error;
} bounded;

static const double UNIT = 0x1p-53, MORE = 1 + 0x1p-49, TINY = 0x1p-1020; /* what bounds, and underflow, may lose */

static inline bounded difference(double x, double y) {
    double d = x - y;
    return (bounded){d, UNIT * fabs(d)};
}

static inline bounded sum(bounded x, bounded y) {
    double s = x.value + y.value;
    return (bounded){s, (x.error + y.error + UNIT * fabs(s)) * MORE};
}

static inline bounded product(bounded x, bounded y) {
    double p = x.value * y.value;
    double error = fabs(x.value) * y.error + x.error * (fabs(y.value) + y.error) + UNIT * fabs(p);
    return (bounded){p, error * MORE + TINY};
}

static inline bounded minor(bounded x, bounded y, bounded z, bounded w) { /* x y - z w */
    bounded q = product(z, w);
    q.value = -q.value;
    return sum(product(x, y), q);
}

/* Returns the sign, 2 where the error leaves it open. */
static inline int sign_of(bounded x) {
    return x.value > x.error ? 1 : -x.value > x.error ? -1 : 2;
}

/* Returns g of sample s at p: (a - s) . ((p - a) + (p - s)). */
static bounded bounded_g(const double *a, const double *s, const double *p) {
    bounded g = {0, 0};
    for (int k = 0; k < 3; k++)
        g = sum(g, product(difference(a[k], s[k]), sum(difference(p[k], a[k]), difference(p[k], s[k]))));
    return g;
}

/* --- dyadic numbers --- */

#define OUT_OF_LINE __attribute__((noinline)) /* a dyadic number takes 1.7 KB of the stack */

static OUT_OF_LINE void exact_g(brio_dyadic *g, const double *a, const double *s, const double *p) {
    brio_dyadic x, y, t;
    brio_dyadic_set(g, 0);
    for (int k = 0; k < 3; k++) {
        brio_dyadic_difference(&x, p[k], a[k]);
        brio_dyadic_difference(&y, p[k], s[k]);
        brio_dyadic_add(&y, &x, &y, 1);
        brio_dyadic_difference(&x, a[k], s[k]);
        brio_dyadic_multiply(&t, &x, &y);
        brio_dyadic_add(g, g, &t, 1);
    }
}

/* Sets r = x y - z w. */
static OUT_OF_LINE void exact_minor(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y, const brio_dyadic *z,
                                    const brio_dyadic *w) {
    brio_dyadic p, q;
    brio_dyadic_multiply(&p, x, y);
    brio_dyadic_multiply(&q, z, w);
    brio_dyadic_add(r, &p, &q, -1);
}

/* Adds (x - y) m to r, for doubles x and y. */
static OUT_OF_LINE void add_scaled(brio_dyadic *r, double x, double y, const brio_dyadic *m) {
    brio_dyadic d, t;
    brio_dyadic_difference(&d, x, y);
    brio_dyadic_multiply(&t, &d, m);
    brio_dyadic_add(r, r, &t, 1);
}

/* --- the signs --- */

int brio_nearer_sample(brio_bisector_counts *n, const double *a, const double *b, const double *p) {
    brio_dyadic g;
    int sign = sign_of(bounded_g(a, b, p));
    if (sign != 2) return sign;
    n->exact++;
    exact_g(&g, a, b, p);
    if (g.sign) return g.sign;
    n->ties++;
    for (int k = 0; k < 2; k++)
        if (a[k] != b[k]) return a[k] > b[k] ? 1 : -1;
    return a[2] > b[2] ? 1 : -1;
}

/* Returns the sign of the translation's share along the first axis k where it is not 0: (a - b) (g_c(q) - g_c(p)) + (a
 * - c) (g_b(p) - g_b(q)). */
static int order_of_translated(const double *a, const double *b, const double *c, const brio_dyadic gb[2],
                               const brio_dyadic gc[2]) {
    brio_dyadic db, dc, r;
    brio_dyadic_add(&db, &gb[0], &gb[1], -1);
    brio_dyadic_add(&dc, &gc[1], &gc[0], -1);
    for (int k = 0; k < 3; k++) {
        brio_dyadic_set(&r, 0);
        add_scaled(&r, a[k], b[k], &dc);
        add_scaled(&r, a[k], c[k], &db);
        if (r.sign) return r.sign;
    }
    return 0;
}

int brio_bisector_order(brio_bisector_counts *n, const double *a, const double *b, const double *c, const double *p,
                        const double *q) {
    brio_dyadic gb[2], gc[2], r;
    int sign = sign_of(minor(bounded_g(a, b, p), bounded_g(a, c, q), bounded_g(a, b, q), bounded_g(a, c, p)));
    if (sign != 2) return sign;
    n->exact++;
    exact_g(&gb[0], a, b, p), exact_g(&gb[1], a, b, q);
    exact_g(&gc[0], a, c, p), exact_g(&gc[1], a, c, q);
    exact_minor(&r, &gb[0], &gc[1], &gb[1], &gc[0]);
    if (r.sign) return r.sign;
    n->ties++;
    return order_of_translated(a, b, c, gb, gc);
}

/* Sets r to the sum of x cross y: the determinant of (1, 1, 1), x, y. */
static OUT_OF_LINE void exact_area(brio_dyadic *r, const brio_dyadic x[3], const brio_dyadic y[3]) {
    brio_dyadic m;
    exact_minor(r, &x[1], &y[2], &x[2], &y[1]);
    exact_minor(&m, &x[2], &y[0], &x[0], &y[2]);
    brio_dyadic_add(r, r, &m, 1);
    exact_minor(&m, &x[0], &y[1], &x[1], &y[0]);
    brio_dyadic_add(r, r, &m, 1);
}

/* Returns the sign of the translation's share along the first axis where it is not 0: each row of the determinant in
 * turn replaced by its (a - s). */
static OUT_OF_LINE int side_of_translated(const double *const samples[4], const brio_dyadic g[3][3]) {
    brio_dyadic area[3], r;
    for (int i = 0; i < 3; i++) exact_area(&area[i], g[(i + 1) % 3], g[(i + 2) % 3]);
    for (int k = 0; k < 3; k++) {
        brio_dyadic_set(&r, 0);
        for (int i = 0; i < 3; i++) add_scaled(&r, samples[0][k], samples[i + 1][k], &area[i]);
        if (r.sign) return r.sign;
    }
    return 0;
}

static int side_exact(brio_bisector_counts *n, const double *const samples[4], const double *const corners[3]) {
    brio_dyadic g[3][3], m, t, r;
    n->exact++;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) exact_g(&g[i][j], samples[0], samples[i + 1], corners[j]);
    brio_dyadic_set(&r, 0);
    for (int j = 0; j < 3; j++) {
        exact_minor(&m, &g[0][(j + 1) % 3], &g[1][(j + 2) % 3], &g[0][(j + 2) % 3], &g[1][(j + 1) % 3]);
        brio_dyadic_multiply(&t, &g[2][j], &m);
        brio_dyadic_add(&r, &r, &t, 1);
    }
    if (r.sign) return r.sign;
    n->ties++;
    return side_of_translated(samples, (const brio_dyadic(*)[3])g);
}

int brio_bisector_side(brio_bisector_counts *n, const double *const samples[4], const double *const corners[3]) {
    bounded g[3][3], det = {0, 0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) g[i][j] = bounded_g(samples[0], samples[i + 1], corners[j]);
    for (int j = 0; j < 3; j++)
        det = sum(det,
                  product(g[2][j], minor(g[0][(j + 1) % 3], g[1][(j + 2) % 3], g[0][(j + 2) % 3], g[1][(j + 1) % 3])));
    int sign = sign_of(det);
    return sign != 2 ? sign : side_exact(n, samples, corners);
}
