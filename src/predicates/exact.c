/* Stages 4 and 5 of the predicates: integers where the points are on a grid, otherwise exact dyadic numbers, which hold
 * every finite double. */
#include "predicates/dyadic.h"
#include "predicates/predicates.h"

/* Sets r = x y - z w. */
static void minor2(brio_dyadic *r, const brio_dyadic *x, const brio_dyadic *y, const brio_dyadic *z,
                   const brio_dyadic *w) {
    brio_dyadic p, q;
    brio_dyadic_multiply(&p, x, y);
    brio_dyadic_multiply(&q, z, w);
    brio_dyadic_add(r, &p, &q, -1);
}

/* Sets r to the determinant of the rows p, q, s. */
static void minor3(brio_dyadic *r, const brio_dyadic p[3], const brio_dyadic q[3], const brio_dyadic s[3]) {
    brio_dyadic m, t;
    minor2(&m, &p[1], &q[2], &p[2], &q[1]);
    brio_dyadic_multiply(r, &s[0], &m);
    minor2(&m, &p[2], &q[0], &p[0], &q[2]);
    brio_dyadic_multiply(&t, &s[1], &m);
    brio_dyadic_add(r, r, &t, 1);
    minor2(&m, &p[0], &q[1], &p[1], &q[0]);
    brio_dyadic_multiply(&t, &s[2], &m);
    brio_dyadic_add(r, r, &t, 1);
}

static void difference3(brio_dyadic r[3], const double *p, const double *q) {
    for (int k = 0; k < 3; k++) brio_dyadic_difference(&r[k], p[k], q[k]);
}

static void add_square(brio_dyadic *r, const brio_dyadic *x, int s) {
    brio_dyadic square;
    brio_dyadic_multiply(&square, x, x);
    brio_dyadic_add(r, r, &square, s);
}

int brio_orient3d_dyadic(const double *a, const double *b, const double *c, const double *d) {
    brio_dyadic rows[3][3], det;
    difference3(rows[0], b, a);
    difference3(rows[1], c, a);
    difference3(rows[2], d, a);
    minor3(&det, rows[0], rows[1], rows[2]);
    return det.sign;
}

/* Sets lift = |row|^2 - (weight of p - weight of e), where row = p - e. */
static void lift_of(brio_dyadic *lift, const brio_dyadic row[3], const double *p, const double *e, bool weighted) {
    brio_dyadic_multiply(lift, &row[0], &row[0]);
    add_square(lift, &row[1], 1);
    add_square(lift, &row[2], 1);
    if (!weighted) return;
    brio_dyadic w;
    brio_dyadic_difference(&w, p[3], e[3]);
    brio_dyadic_add(lift, lift, &w, -1);
}

int brio_insphere_dyadic(const double *a, const double *b, const double *c, const double *d, const double *e,
                         bool weighted) {
    const double *p[4] = {a, b, c, d};
    brio_dyadic row[4][3], det = {0}, lift, minor, term;
    for (int i = 0; i < 4; i++) difference3(row[i], p[i], e);
    for (int i = 0; i < 4; i++) {
        /* `other` lists the rows except row i, in order; the sign of the cofactor alternates with i */
        const brio_dyadic *other[3];
        for (int j = 0, k = 0; j < 4; j++)
            if (j != i) other[k++] = row[j];
        minor3(&minor, other[0], other[1], other[2]);
        lift_of(&lift, row[i], p[i], e, weighted);
        brio_dyadic_multiply(&term, &lift, &minor);
        brio_dyadic_add(&det, &det, &term, i % 2 ? -1 : 1);
    }
    return det.sign;
}

/* Adds s (|x - p|^2 - w_p) to r. */
static void add_power(brio_dyadic *r, const double *x, const double *p, int s) {
    brio_dyadic t;
    for (int k = 0; k < 3; k++) {
        brio_dyadic_difference(&t, x[k], p[k]);
        add_square(r, &t, s);
    }
    brio_dyadic_set(&t, p[3]);
    brio_dyadic_add(r, r, &t, -s);
}

int brio_power_compare_exact(const double *x, const double *p, const double *q) {
    brio_dyadic difference = {0};
    add_power(&difference, x, p, 1);
    add_power(&difference, x, q, -1);
    return difference.sign;
}

bool brio_collinear(const double *a, const double *b, const double *c) {
    brio_dyadic u[3], v[3], m;
    difference3(u, b, a);
    difference3(v, c, a);
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3;
        minor2(&m, &u[k], &v[l], &u[l], &v[k]);
        if (m.sign) return false;
    }
    return true;
}

int brio_orient3d_exact(const double *a, const double *b, const double *c, const double *d) {
    int sign = brio_orient3d_integer(a, b, c, d);
    return sign != 2 ? sign : brio_orient3d_dyadic(a, b, c, d);
}

int brio_insphere_exact(const double *a, const double *b, const double *c, const double *d, const double *e,
                        bool weighted) {
    int sign = brio_insphere_integer(a, b, c, d, e, weighted);
    return sign != 2 ? sign : brio_insphere_dyadic(a, b, c, d, e, weighted);
}
