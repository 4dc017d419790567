/* Circumcentres and orthocentres, in as much precision as they need.
 *
 * With the points sorted lexicographically and taken relative to the first, b, c, d, and with their lifts l = |p|^2
 * less the difference of weights, the centre is
 *     a + (l_b c x d + l_c d x b + l_d b x c) / (2 det [b, c, d]).
 * A numerator and the determinant carry an error of a few units in the last place of their permanents; when that leaves
 * the quotient less certain than the goal, the same formula is evaluated in double-doubles, and at last in exact
 * dyadic numbers. Differences are first scaled by a power of two to at most 1, so that nothing overflows on the way. */
#include "predicates/circumcentre.h"
#include "base/float_state.h"
#include "base/scale.h"
#include "brio/brio.h"
#include "predicates/centre_bounds.h"
#include "predicates/double_double.h"
#include "predicates/dyadic.h"
#include "predicates/predicates.h"
#include <string.h>

/* 2^-30 is enough for angles, and doubles reach it for nearly flat tetrahedra too. */
static const double ROUGH_GOAL = 0x1p-30;

typedef struct {
    double offset[3]; /* centre - first point, scaled */
    double error;     /* of each coordinate */
} solution;

/* Magnitudes of the numerators and the determinant with every term positive. */
typedef struct {
    double numerator[3], determinant;
} permanents;

static permanents permanents_of(double r[3][3], double lift[3]) {
    permanents p = {{0, 0, 0}, 0};
    for (int i = 0; i < 3; i++) {
        const double *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        double x = fabs(u[1] * v[2]) + fabs(u[2] * v[1]), y = fabs(u[2] * v[0]) + fabs(u[0] * v[2]),
               z = fabs(u[0] * v[1]) + fabs(u[1] * v[0]);
        p.numerator[0] += lift[i] * x, p.numerator[1] += lift[i] * y, p.numerator[2] += lift[i] * z;
        if (i == 0) p.determinant = fabs(r[0][0]) * x + fabs(r[0][1]) * y + fabs(r[0][2]) * z;
    }
    return p;
}

/* The quotients with their error from the errors of numerator and determinant; false when that is too large. */
static bool divide(const double numerator[3], double determinant, const permanents *p, double bound, double goal,
                   solution *s) {
    double slack = fabs(determinant) - bound * p->determinant - 0x1p-900, most = 0;
    if (!(slack > 0)) return false;
    double inverse = 1 / slack, share = bound * p->determinant * inverse * (1 + 0x1p-50) + 0x1p-52;
    s->error = 0;
    for (int k = 0; k < 3; k++) {
        s->offset[k] = 0.5 * (numerator[k] / determinant);
        double size = fabs(s->offset[k]);
        double error = 0.5 * (bound * p->numerator[k] + 0x1p-900) * inverse * (1 + 0x1p-50) + size * share;
        s->error = s->error > error ? s->error : error;
        most = most > size ? most : size;
    }
    return s->error <= goal * most && most < INFINITY;
}

static bool solve_double(double r[3][3], const double weight[3], double goal, solution *s, permanents *p) {
    double lift[3], magnitude[3], numerator[3] = {0, 0, 0}, determinant = 0;
    for (int i = 0; i < 3; i++) {
        double square = r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2];
        lift[i] = square - weight[i];
        magnitude[i] = square + fabs(weight[i]);
    }
    *p = permanents_of(r, magnitude);
    for (int i = 0; i < 3; i++) {
        const double *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        numerator[0] += lift[i] * x, numerator[1] += lift[i] * y, numerator[2] += lift[i] * z;
        if (i == 0) determinant = r[0][0] * x + r[0][1] * y + r[0][2] * z;
    }
    return divide(numerator, determinant, p, BRIO_DOUBLE_BOUND, goal, s);
}

BRIO_INLINE bool solve_dd(brio_dd r[3][3], const brio_dd weight[3], const permanents *p, double goal, solution *s,
                          const bool fma) {
    brio_dd numerator[3] = {{0, 0}, {0, 0}, {0, 0}}, determinant = {0, 0};
    for (int i = 0; i < 3; i++) {
        brio_dd *u = r[(i + 1) % 3], *v = r[(i + 2) % 3], cross[3];
        brio_dd lift = dd_sum3(dd_multiply(r[i][0], r[i][0], fma), dd_multiply(r[i][1], r[i][1], fma),
                               dd_multiply(r[i][2], r[i][2], fma));
        lift = dd_subtract(lift, weight[i]);
        for (int k = 0; k < 3; k++) {
            int m = (k + 1) % 3, n = (k + 2) % 3;
            cross[k] = dd_minor(u[m], v[n], u[n], v[m], fma);
            numerator[k] = dd_add(numerator[k], dd_multiply(lift, cross[k], fma));
            if (i == 0) determinant = dd_add(determinant, dd_multiply(r[0][k], cross[k], fma));
        }
    }
    return divide((double[]){numerator[0].hi, numerator[1].hi, numerator[2].hi}, determinant.hi, p, BRIO_DD_BOUND, goal,
                  s);
}

static bool solve_dd_plain(brio_dd r[3][3], const brio_dd w[3], const permanents *p, double goal, solution *s) {
    return solve_dd(r, w, p, goal, s, false);
}
BRIO_TARGET_FMA static bool solve_dd_fma(brio_dd r[3][3], const brio_dd w[3], const permanents *p, double goal,
                                         solution *s) {
    return solve_dd(r, w, p, goal, s, true);
}

/* x = 1/2 numerator / determinant of exact numbers, scaled by 2^-exponent. */
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

static bool ordinary(int exponent) {
    return exponent > -400 && exponent < 400;
}

/* Exponent of the largest difference to the first point; the differences may not be finite. */
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

/* In double-doubles; scale is exact and finite. */
static bool solve_finely(const double *const p[4], bool weighted, double scale, const permanents *permanent,
                         double goal, solution *s) {
    brio_dd r[3][3], weight[3] = {{0, 0}, {0, 0}, {0, 0}};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) r[i][k] = dd_difference(p[i + 1][k] * scale, p[0][k] * scale);
        if (weighted) weight[i] = dd_difference(p[i + 1][3] * scale * scale, p[0][3] * scale * scale);
    }
    return brio_have_fma() ? solve_dd_fma(r, weight, permanent, goal, s)
                           : solve_dd_plain(r, weight, permanent, goal, s);
}

static bool solve(const double *const p[4], bool weighted, double goal, int exponent, solution *s) {
    double r[3][3], weight[3] = {0, 0, 0}, scale;
    permanents permanent;
    if (!ordinary(exponent)) return solve_exact(p, weighted, exponent, s);
    scale = brio_power_of_two(-exponent);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) r[i][k] = p[i + 1][k] * scale - p[0][k] * scale;
        if (weighted) weight[i] = p[i + 1][3] * scale * scale - p[0][3] * scale * scale;
    }
    return solve_double(r, weight, goal, s, &permanent) || solve_finely(p, weighted, scale, &permanent, goal, s) ||
           solve_exact(p, weighted, exponent, s);
}

static bool find_centre(const double *p[4], bool weighted, double goal, double centre[3], double *error) {
    solution s;
    sort_ascending(p);
    int exponent = exponent_of(p);
    if (!solve(p, weighted, goal, exponent, &s)) return false;
    double unit = ordinary(exponent) ? brio_power_of_two(exponent) : 1, far = 0;
    *error = ordinary(exponent) ? s.error * unit : ldexp(s.error, exponent);
    for (int k = 0; k < 3; k++) {
        centre[k] = p[0][k] + (ordinary(exponent) ? s.offset[k] * unit : ldexp(s.offset[k], exponent));
        if (!isfinite(centre[k])) return false;
        far = far > fabs(centre[k]) ? far : fabs(centre[k]);
    }
    *error += 0x1p-53 * far;
    return true;
}

bool brio_centre(const double *a, const double *b, const double *c, const double *d, bool weighted, double centre[3],
                 double *error) {
    const double *p[4] = {a, b, c, d};
    double ignored;
    return find_centre(p, weighted, BRIO_FINE_GOAL, centre, error ? error : &ignored);
}

/* --- several at once --- */

static uint64_t in_lanes(const brio_centre_batch *b) {
#if defined(__x86_64__)
    if (brio_instructions() == BRIO_AVX512) return brio_centres_avx512(b);
    if (brio_instructions() == BRIO_AVX2) return brio_centres_avx2(b);
#endif
    return b->count < 64 ? (UINT64_C(1) << b->count) - 1 : UINT64_MAX;
}

void brio_centres(const brio_centre_batch *b) {
    for (uint64_t left = in_lanes(b); left; left &= left - 1) {
        size_t n = (size_t)__builtin_ctzll(left);
        double r[4][4] = {{0}};
        for (int i = 0; i < 4; i++) {
            size_t v = b->vertex[n][i];
            memcpy(r[i], b->points + 3 * v, 3 * sizeof **r);
            if (b->weights) r[i][3] = b->weights[v];
        }
        if (!brio_centre(r[0], r[1], r[2], r[3], b->weights != NULL, b->centre + 3 * n, NULL)) b->centre[3 * n] = NAN;
    }
}

/* --- several at once, roughly --- */

typedef double lanes __attribute__((vector_size(8 * BRIO_CENTRES)));
typedef int64_t lane_mask __attribute__((vector_size(8 * BRIO_CENTRES)));

/* most = the larger of most and |x|, lane by lane. Vectors are passed by address: their registers depend on the
 * instruction set. */
BRIO_INLINE void take_larger(lanes *most, const lanes *x) {
    lanes size = (lanes)((lane_mask)*x & INT64_MAX);
    lane_mask more = size > *most;
    *most = (lanes)(((lane_mask)size & more) | ((lane_mask)*most & ~more));
}

/* The quotients and a bound of their errors, from the differences r to the first points; in doubles, unscaled, with the
 * permanents bounded by the largest difference in each coordinate. Where a lane is no number its error is none. */
BRIO_INLINE void solve_lanes(const lanes r[3][3], lanes offset[3], lanes *error, lanes *far) {
    lanes zero = {0}, one = zero + 1, determinant = zero, lifts = zero, numerator[3] = {zero, zero, zero};
    lanes size[3] = {zero, zero, zero}, slack = zero;
    for (int i = 0; i < 3; i++) {
        const lanes *u = r[(i + 1) % 3], *v = r[(i + 2) % 3];
        lanes lift = r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2];
        lanes x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        numerator[0] += lift * x, numerator[1] += lift * y, numerator[2] += lift * z;
        if (i == 0) determinant = r[0][0] * x + r[0][1] * y + r[0][2] * z;
        lifts += lift;
        for (int k = 0; k < 3; k++) take_larger(&size[k], &r[i][k]);
    }
    lanes permanent = 6 * size[0] * size[1] * size[2];
    take_larger(&slack, &determinant);
    slack -= BRIO_DOUBLE_BOUND * permanent + 0x1p-900;
    lanes inverse = one / slack, share = BRIO_DOUBLE_BOUND * permanent * inverse * (1 + 0x1p-50) + 0x1p-52;
    *error = zero, *far = zero;
    for (int k = 0; k < 3; k++) {
        lanes most = 2 * lifts * size[(k + 1) % 3] * size[(k + 2) % 3];
        offset[k] = 0.5 * (numerator[k] / determinant);
        lanes own = 0.5 * (BRIO_DOUBLE_BOUND * most + 0x1p-900) * inverse * (1 + 0x1p-50), length = zero;
        take_larger(&length, &offset[k]);
        own += length * share;
        take_larger(error, &own);
        take_larger(far, &length);
    }
    lane_mask bad = ~(slack > zero) | ~(*error <= ROUGH_GOAL * *far) | ~(*far < 0x1p900);
    *error = (lanes)((lane_mask)*error | bad);
}

/* Swaps the points a and b in the lanes where a is lexicographically greater. */
BRIO_INLINE void order_lanes(lanes a[3], lanes b[3]) {
    lane_mask later = (a[1] > b[1]) | ((a[1] == b[1]) & (a[2] > b[2]));
    lane_mask swap = (a[0] > b[0]) | ((a[0] == b[0]) & later);
    for (int k = 0; k < 3; k++) {
        lane_mask change = ((lane_mask)a[k] ^ (lane_mask)b[k]) & swap;
        a[k] = (lanes)((lane_mask)a[k] ^ change);
        b[k] = (lanes)((lane_mask)b[k] ^ change);
    }
}

BRIO_INLINE void rough_centres(const double *const p[BRIO_CENTRES][4], brio_rough_centre *c) {
    lanes r[4][3], offset[3], worst, far, farthest = {0};
    for (int n = 0; n < BRIO_CENTRES; n++)
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++) r[i][k][n] = p[n][i][k];
    order_lanes(r[0], r[1]), order_lanes(r[2], r[3]);
    order_lanes(r[0], r[2]), order_lanes(r[1], r[3]);
    order_lanes(r[1], r[2]);
    for (int i = 1; i < 4; i++)
        for (int k = 0; k < 3; k++) r[i][k] -= r[0][k];
    solve_lanes((const lanes(*)[3])(r + 1), offset, &worst, &far);
    lanes square = offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2];
    for (int k = 0; k < 3; k++) offset[k] += r[0][k];
    for (int k = 0; k < 3; k++) take_larger(&farthest, &offset[k]);
    worst += 0x1p-53 * farthest;
    for (int n = 0; n < BRIO_CENTRES; n++)
        c[n] = (brio_rough_centre){{offset[0][n], offset[1][n], offset[2][n]}, square[n], worst[n]};
}

static void rough_centres_plain(const double *const p[BRIO_CENTRES][4], brio_rough_centre *centre) {
    rough_centres(p, centre);
}
BRIO_TARGET_FMA static void rough_centres_wide(const double *const p[BRIO_CENTRES][4], brio_rough_centre *centre) {
    rough_centres(p, centre);
}

/* One that the lanes could not find. */
static brio_rough_centre rough_centre(const double *const p[4]) {
    const double *q[4] = {p[0], p[1], p[2], p[3]};
    brio_rough_centre c = {{0, 0, 0}, 0, 0};
    if (!find_centre(q, false, ROUGH_GOAL, c.at, &c.error)) return (brio_rough_centre){{NAN, 0, 0}, NAN, INFINITY};
    for (int k = 0; k < 3; k++) c.square += (c.at[k] - q[0][k]) * (c.at[k] - q[0][k]);
    return c;
}

void brio_rough_centres(const double *const p[BRIO_CENTRES][4], brio_rough_centre *centre) {
    if (brio_have_fma())
        rough_centres_wide(p, centre);
    else
        rough_centres_plain(p, centre);
    for (int n = 0; n < BRIO_CENTRES; n++)
        if (!(centre[n].error < INFINITY)) centre[n] = rough_centre(p[n]);
}

brio_status brio_circumcentre(const double *a, const double *b, const double *c, const double *d, const double *weights,
                              double *centre, double *error) {
    BRIO_DOOR;
    const double *p[4] = {a, b, c, d};
    double r[4][4];
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) r[i][k] = p[i][k] + 0.0;
        r[i][3] = weights ? weights[i] : 0;
    }
    return brio_centre(r[0], r[1], r[2], r[3], weights != NULL, centre, error) ? BRIO_OK : BRIO_ERR_ARGUMENT;
}
