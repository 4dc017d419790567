/* Circumcentres and orthocentres, in as much precision as each one needs. centre_lanes.h tries doubles and then pairs
 * of doubles, in vector lanes. This file solves the remaining tetrahedra in exact dyadic numbers. */
#include "predicates/circumcentre.h"
#include "base/float_state.h"
#include "base/instruction_set.h"
#include "base/scale.h"
#include "base/vector.h"
#include "brio/brio.h"
#include "predicates/dyadic.h"
#include "predicates/predicates.h"
#include <string.h>

/* Chosen errors, relative to the distance of the centre from the points. Doubles reach 2^-44 for tetrahedra of ordinary
 * shape. 2^-30 is enough for angles, and doubles reach 2^-30 for nearly flat tetrahedra too. */
static const double FINE = 0x1p-44, ROUGH = 0x1p-30;

typedef struct {
    double offset[3]; /* (centre - first point) 2^-exponent */
    double error;     /* bounds the error of each coordinate of offset */
} solution;

/* Returns 2^-exponent 1/2 numerator / determinant, rounded. */
static double quotient(const brio_dyadic *numerator, const brio_dyadic *determinant, int exponent) {
    int en, ed;
    double n = brio_dyadic_to_double(numerator, &en), d = brio_dyadic_to_double(determinant, &ed);
    return ldexp(n / d, en - ed - 1 - exponent);
}

static bool solve_exact(const double *const p[4], bool weighted, int exponent, solution *s) {
    brio_dyadic r[3][3], lift, minor, term, determinant = {0}, numerator[3] = {{0}, {0}, {0}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) brio_dyadic_difference(&r[i][k], p[i + 1][k], p[0][k]);
    for (int i = 0; i < 3; i++) {
        const brio_dyadic *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        brio_dyadic_multiply(&lift, &r[i][0], &r[i][0]);
        for (int k = 1; k < 3; k++) {
            brio_dyadic_multiply(&term, &r[i][k], &r[i][k]);
            brio_dyadic_add(&lift, &lift, &term, 1);
        }
        if (weighted) {
            brio_dyadic_difference(&term, p[i + 1][3], p[0][3]);
            brio_dyadic_add(&lift, &lift, &term, -1);
        }
        for (int k = 0; k < 3; k++) {
            int m = (k + 1) % 3, n = (k + 2) % 3;
            brio_dyadic_multiply(&minor, &u[m], &v[n]);
            brio_dyadic_multiply(&term, &u[n], &v[m]);
            brio_dyadic_add(&minor, &minor, &term, -1);
            brio_dyadic_multiply(&term, &lift, &minor);
            brio_dyadic_add(&numerator[k], &numerator[k], &term, 1);
            if (i > 0) continue;
            brio_dyadic_multiply(&term, &r[0][k], &minor);
            brio_dyadic_add(&determinant, &determinant, &term, 1);
        }
    }
    if (!determinant.sign) return false;
    s->error = 0;
    for (int k = 0; k < 3; k++) {
        s->offset[k] = quotient(&numerator[k], &determinant, exponent);
        s->error = fmax(s->error, fabs(s->offset[k]) * 0x1p-50);
    }
    return true;
}

static inline void order_two(const double **p, const double **q) {
    const double *a = *p, *b = *q;
    bool swap = a[0] != b[0] ? a[0] > b[0] : brio_lexicographic(a, b) > 0;
    *p = swap ? b : a;
    *q = swap ? a : b;
}

static void sort_ascending(const double *p[4]) {
    order_two(&p[0], &p[1]), order_two(&p[2], &p[3]);
    order_two(&p[0], &p[2]), order_two(&p[1], &p[3]);
    order_two(&p[1], &p[2]);
}

/* Returns an exponent e such that the differences to the first point are less than 2^e. Halves the coordinates, because
 * the differences may overflow. */
static int exponent_of(const double *const p[4]) {
    double most = 0;
    for (int i = 1; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            double half = fabs(p[i][k] * 0.5 - p[0][k] * 0.5);
            most = half > most ? half : most;
        }
    uint64_t bits;
    __builtin_memcpy(&bits, &most, sizeof bits);
    return (int)(bits >> 52) - 1021; /* -1021 for subnormal numbers */
}

/* Computes the centre of tetrahedron n of a batch exactly, and rounds it. */
static void find_exactly(const brio_centre_batch *b, size_t n, const brio_centre_goal *goal) {
    double r[4][4] = {{0}}, *centre = goal->centre + goal->stride * n, far = 0;
    const double *p[4] = {r[0], r[1], r[2], r[3]};
    solution s;
    for (int i = 0; i < 4; i++) {
        size_t v = b->vertex[n][i];
        memcpy(r[i], b->points + 3 * v, 3 * sizeof **r);
        if (b->weights) r[i][3] = b->weights[v];
    }
    sort_ascending(p);
    int exponent = exponent_of(p);
    centre[0] = NAN;
    if (!solve_exact(p, b->weights != NULL, exponent, &s)) return;
    for (int k = 0; k < 3; k++) {
        s.offset[k] = p[0][k] + ldexp(s.offset[k], exponent);
        far = fmax(far, fabs(s.offset[k]));
        if (!isfinite(s.offset[k])) return;
    }
    memcpy(centre, s.offset, sizeof s.offset);
    if (goal->error) goal->error[n] = ldexp(s.error, exponent) + 0x1p-53 * far;
}

static const brio_centre_engine *engine(void) {
    static const brio_centre_engine *const OF_SET[] = {
        &brio_centres_plain,
#if defined(__x86_64__)
        &brio_centres_avx2,
        &brio_centres_avx512,
#endif
    };
    return OF_SET[brio_instructions()];
}

static void find(const brio_centre_batch *b, uint64_t some, const brio_centre_goal *goal) {
    for (uint64_t left = engine()->find(b, some, goal); left; left &= left - 1)
        find_exactly(b, (size_t)__builtin_ctzll(left), goal);
}

static uint64_t every(const brio_centre_batch *b) {
    return b->count < 64 ? (UINT64_C(1) << b->count) - 1 : UINT64_MAX;
}

void brio_centres(const brio_centre_batch *b, double *centre, double *error) {
    find(b, every(b), &(brio_centre_goal){FINE, centre, 3, error});
}

void brio_near_centres(const brio_centre_batch *b, double *centre, double *error) {
    find(b, every(b), &(brio_centre_goal){ROUGH, centre, 3, error});
}

static const double *first_point(const brio_centre_batch *b, size_t n) {
    const double *first = b->points + 3 * (size_t)b->vertex[n][0];
    for (int i = 1; i < 4; i++) {
        const double *p = b->points + 3 * (size_t)b->vertex[n][i];
        if (brio_lexicographic(p, first) < 0) first = p;
    }
    return first;
}

void brio_rough_centres(const brio_centre_batch *b, double *centre) {
    brio_centre_goal goal = {ROUGH, centre, 4, NULL};
    uint64_t left = engine()->find_roughly(b, every(b), &goal);
    if (left) find(b, left, &goal);
    for (; left; left &= left - 1) {
        size_t n = (size_t)__builtin_ctzll(left);
        centre[4 * n + 3] = brio_square_distance(centre + 4 * n, first_point(b, n));
    }
}

brio_status brio_circumcentre(const double *a, const double *b, const double *c, const double *d, const double *weights,
                              double *centre, double *error) {
    BRIO_DOOR;
    static const uint32_t VERTEX[1][4] = {{0, 1, 2, 3}};
    const double *p[4] = {a, b, c, d};
    double points[12], found[3];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) points[3 * i + k] = p[i][k] + 0.0;
    brio_centres(&(brio_centre_batch){points, weights, VERTEX, 1}, found, error);
    if (isnan(found[0])) return BRIO_ERR_ARGUMENT;
    memcpy(centre, found, sizeof found);
    return BRIO_OK;
}
