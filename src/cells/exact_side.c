/* Sides of planes, exactly: see exact_side.h.
 *
 * Rows are relative to the site of the cell, where the numbers are small. In doubles, each number of a row comes with
 * the sum of its absolute terms; a determinant errs by at most ERROR of the same determinant with all terms positive.
 *
 * Based on: Shewchuk. Adaptive precision floating-point arithmetic and fast robust geometric predicates. DCG 1997. */
#include "cells/exact_side.h"
#include "predicates/dyadic.h"
#include <assert.h>
#include <math.h>

/* A number of a row errs by at most 12 roundings of the sum of its terms: the differences, products and sums of an
 * offset, or the divisions of a normal. A determinant adds 3 products and 9 sums to 4 such numbers: less than 64
 * roundings of 2^-53. */
static const double ERROR = 0x1p-47;

/* Numbers that underflow lose at most 2^-1074 each. A determinant loses less than this of the cube of its greatest
 * number. */
static const double FLOOR = 0x1p-1000;

/* Finds the sites of a plane. Returns false for a wall. */
static bool find_sites(const brio_exact_planes *e, int64_t plane, uint32_t *a, uint32_t *b) {
    if (plane < 0) return false;
    *a = e->site;
    *b = (uint32_t)plane;
    if (plane <= UINT32_MAX) return true;
    int64_t number = plane - ((int64_t)1 << 32);
    assert(number / 3 < (int64_t)e->d->num_finite); /* a plane of a finite tetrahedron */
    const uint32_t *v = e->d->t.tet[number / 3].vertex;
    *a = v[0];
    *b = v[1 + number % 3];
    return true;
}

/* --- in doubles --- */

/* The plane n . x = d, and the sums of the absolute terms of each number. */
typedef struct {
    double n[3], d, n_terms[3], d_terms;
} row;

static void fill_wall(const brio_exact_planes *e, size_t wall, row *r) {
    assert(wall < e->region->num_planes);
    const double *plane = e->region->plane[wall], *site = e->d->at + 3 * (size_t)e->site;
    r->d = plane[3];
    r->d_terms = e->region->terms[wall];
    for (int k = 0; k < 3; k++) {
        r->n[k] = plane[k];
        r->n_terms[k] = fabs(plane[k]);
        r->d -= plane[k] * site[k];
        r->d_terms += fabs(plane[k] * site[k]);
    }
}

static void fill_row(const brio_exact_planes *e, int64_t plane, row *r) {
    uint32_t a, b;
    if (!find_sites(e, plane, &a, &b)) {
        fill_wall(e, (size_t)(-1 - plane), r);
        return;
    }
    const double *at = e->d->at, *site = at + 3 * (size_t)e->site, *square = e->d->square;
    r->d = square ? square[a] - square[b] : 0;
    r->d_terms = square ? fabs(square[a]) + fabs(square[b]) : 0;
    for (int k = 0; k < 3; k++) {
        double x = at[3 * (size_t)a + (size_t)k], y = at[3 * (size_t)b + (size_t)k];
        double to_a = x - site[k], to_b = y - site[k];
        r->n[k] = 2 * (y - x);
        r->n_terms[k] = fabs(r->n[k]);
        r->d += to_b * to_b - to_a * to_a;
        r->d_terms += to_b * to_b + to_a * to_a;
    }
}

static double minor_of(const double *a, const double *b, const double *c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static double terms_of(const double *a, const double *b, const double *c) {
    return a[0] * (b[1] * c[2] + b[2] * c[1]) + a[1] * (b[2] * c[0] + b[0] * c[2]) + a[2] * (b[0] * c[1] + b[1] * c[0]);
}

static double greatest_of(const row *r, int count) {
    double most = 1;
    for (int i = 0; i < count; i++) {
        most = fmax(most, r[i].d_terms);
        for (int k = 0; k < 3; k++) most = fmax(most, r[i].n_terms[k]);
    }
    return most;
}

/* Returns the sign of a determinant, 2 if rounding may have changed it. */
static int sign_beyond(double determinant, double terms, double most) {
    double bound = ERROR * terms + FLOOR * most * most * most;
    if (!(bound < (double)INFINITY)) return 2;
    return determinant > bound ? 1 : determinant < -bound ? -1 : 2;
}

static int rounded_orientation(const row r[3]) {
    double terms = terms_of(r[0].n_terms, r[1].n_terms, r[2].n_terms);
    return sign_beyond(minor_of(r[0].n, r[1].n, r[2].n), terms, greatest_of(r, 3));
}

static const int OTHERS[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

/* Returns the sign of the determinant of four rows, expanded along their offsets; 2 if rounding may have changed it. */
static int rounded_determinant(const row r[4]) {
    double sum = 0, terms = 0;
    for (int i = 0; i < 4; i++) {
        const row *a = &r[OTHERS[i][0]], *b = &r[OTHERS[i][1]], *c = &r[OTHERS[i][2]];
        double part = r[i].d * minor_of(a->n, b->n, c->n);
        sum += i % 2 ? part : -part;
        terms += r[i].d_terms * terms_of(a->n_terms, b->n_terms, c->n_terms);
    }
    return sign_beyond(sum, terms, greatest_of(r, 4));
}

/* --- exactly --- */

typedef struct {
    brio_dyadic n[3], d;
} exact_row;

/* Adds s (x - o)^2 to a sum. */
static void add_square(brio_dyadic *sum, double x, double o, int s) {
    brio_dyadic way, square;
    brio_dyadic_difference(&way, x, o);
    brio_dyadic_multiply(&square, &way, &way);
    brio_dyadic_add(sum, sum, &square, s);
}

/* Fills the row of a wall n . x = d. Its offset is doubled, as a plane between sites is n . 2 x = d. */
static void fill_exact_wall(const brio_exact_planes *e, size_t wall, exact_row *r) {
    assert(wall < e->region->num_planes);
    const double *plane = e->region->given[wall], *site = e->d->points + 3 * (size_t)e->site;
    brio_dyadic term, at;
    brio_dyadic_set(&r->d, plane[3]);
    for (int k = 0; k < 3; k++) {
        brio_dyadic_set(&r->n[k], plane[k]);
        brio_dyadic_set(&at, site[k]);
        brio_dyadic_multiply(&term, &r->n[k], &at);
        brio_dyadic_add(&r->d, &r->d, &term, -1);
    }
    term = r->d;
    brio_dyadic_add(&r->d, &r->d, &term, 1);
}

__attribute__((noinline)) static void fill_exact(const brio_exact_planes *e, int64_t plane, exact_row *r) {
    uint32_t a, b;
    if (!find_sites(e, plane, &a, &b)) {
        fill_exact_wall(e, (size_t)(-1 - plane), r);
        return;
    }
    const double *points = e->d->points, *site = points + 3 * (size_t)e->site, *weights = e->d->weights;
    brio_dyadic_difference(&r->d, weights ? weights[a] : 0, weights ? weights[b] : 0);
    for (int k = 0; k < 3; k++) {
        double x = points[3 * (size_t)a + (size_t)k], y = points[3 * (size_t)b + (size_t)k];
        brio_dyadic_difference(&r->n[k], y, x);
        add_square(&r->d, y, site[k], 1);
        add_square(&r->d, x, site[k], -1);
    }
}

/* Sets r to the determinant of the normals of three rows. */
__attribute__((noinline)) static void exact_minor(brio_dyadic *r, const exact_row *a, const exact_row *b,
                                                  const exact_row *c) {
    brio_dyadic_set(r, 0);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        brio_dyadic first, second, term;
        brio_dyadic_multiply(&first, &b->n[i], &c->n[j]);
        brio_dyadic_multiply(&second, &b->n[j], &c->n[i]);
        brio_dyadic_add(&first, &first, &second, -1);
        brio_dyadic_multiply(&term, &a->n[k], &first);
        brio_dyadic_add(r, r, &term, 1);
    }
}

__attribute__((noinline)) static int exact_determinant(const exact_row r[4]) { /* its numbers need a frame apart */
    brio_dyadic sum, minor, term;
    brio_dyadic_set(&sum, 0);
    for (int i = 0; i < 4; i++) {
        exact_minor(&minor, &r[OTHERS[i][0]], &r[OTHERS[i][1]], &r[OTHERS[i][2]]);
        brio_dyadic_multiply(&term, &r[i].d, &minor);
        brio_dyadic_add(&sum, &sum, &term, i % 2 ? 1 : -1);
    }
    return sum.sign;
}

static int exact_orientation(const brio_exact_planes *e, const int64_t planes[3]) {
    exact_row r[3];
    brio_dyadic minor;
    for (int i = 0; i < 3; i++) fill_exact(e, planes[i], &r[i]);
    exact_minor(&minor, &r[0], &r[1], &r[2]);
    return minor.sign;
}

static int exact_determinant_of(const brio_exact_planes *e, const int64_t planes[3], int64_t plane) {
    exact_row r[4];
    for (int i = 0; i < 4; i++) fill_exact(e, i < 3 ? planes[i] : plane, &r[i]);
    return exact_determinant(r);
}

/* --- both --- */

int brio_exact_orientation(const void *user, const int64_t planes[3]) {
    row r[3];
    for (int i = 0; i < 3; i++) fill_row(user, planes[i], &r[i]);
    int sign = rounded_orientation(r);
    return sign == 2 ? exact_orientation(user, planes) : sign;
}

int brio_exact_side(const void *user, const int64_t planes[3], int orientation, int64_t plane) {
    row r[4];
    for (int i = 0; i < 3; i++)
        if (planes[i] == plane) return 0;
    for (int i = 0; i < 4; i++) fill_row(user, i < 3 ? planes[i] : plane, &r[i]);
    int sign = rounded_determinant(r);
    if (sign == 2) sign = exact_determinant_of(user, planes, plane);
    return -sign * orientation;
}
