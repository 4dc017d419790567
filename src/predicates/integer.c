/* Exact predicates in fixed-width integers, for points on a common grid, such as lattices and scans in single
 * precision.
 *
 * Where the differences of a call are exact doubles, they are integers times one power of two. With integers of at most
 * 20 bits, all products except the last fit 64 bits and the sum fits 128 bits. With at most 41 bits, every 3 by 3 minor
 * fits 128 bits and the sum fits 256 bits. Integers decide a zero in tens of nanoseconds; dyadic numbers take a
 * microsecond. The functions return DECLINED for other calls. */
#include "predicates/predicates.h"
#include "base/scale.h"
#include "predicates/grid.h"
#include "predicates/span.h"

typedef brio_wide wide;
typedef unsigned __int128 unsigned_wide;

enum { NARROW_BITS = 20, WIDE_BITS = BRIO_GRID_BITS, DECLINED = 2 };

/* Sets *d = a - b, rounded. Returns whether *d is exact. */
static inline bool exact_difference(double a, double b, double *d) {
    double s = a - b, t = s - a;
    *d = s;
    return (a - (s - t)) - (b + t) == 0;
}

bool brio_grid_rows(const double *const *p, int count, const double *origin, bool weighted, int64_t (*row)[3],
                    wide *weight) {
    double d[4][3], w[4];
    brio_span s = BRIO_NO_SPAN;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            if (!exact_difference(p[i][k], origin[k], &d[i][k])) return false;
            brio_span_add(&s, d[i][k]);
        }
    if (s.low == INT32_MAX) s.low = s.high = 0; /* all rows zero */
    int grid = s.low;
    if (weighted) { /* weights are in units of the grid's square */
        brio_span of_weights = BRIO_NO_SPAN;
        for (int i = 0; i < count; i++) {
            if (!exact_difference(p[i][3], origin[3], &w[i])) return false;
            brio_span_add(&of_weights, w[i]);
        }
        if (of_weights.low != INT32_MAX) {
            int half = brio_half_exponent(of_weights.low);
            grid = half < grid ? half : grid;
            if (of_weights.high - 2 * grid > 2 * WIDE_BITS) return false;
        }
    }
    if (s.high - grid > WIDE_BITS || grid < -500 || grid > 400) return false;
    double unit = brio_power_of_two(-grid);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) row[i][k] = (int64_t)(d[i][k] * unit);
        if (weighted) weight[i] = (wide)(w[i] * unit * unit);
    }
    return true;
}

int brio_grid_bits(const int64_t (*row)[3], int count) {
    uint64_t all = 0;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) all |= (uint64_t)(row[i][k] < 0 ? -row[i][k] : row[i][k]);
    return all ? 64 - __builtin_clzll(all) : 0;
}

static int sign_of(wide x) {
    return (x > 0) - (x < 0);
}

static wide minor3(const int64_t p[3], const int64_t q[3], const int64_t s[3]) {
    return s[0] * ((wide)p[1] * q[2] - (wide)p[2] * q[1]) + s[1] * ((wide)p[2] * q[0] - (wide)p[0] * q[2]) +
           s[2] * ((wide)p[0] * q[1] - (wide)p[1] * q[0]);
}

int brio_orient3d_integer(const double *a, const double *b, const double *c, const double *d) {
    const double *p[3] = {b, c, d};
    int64_t row[3][3];
    if (!brio_grid_rows(p, 3, a, false, row, NULL)) return DECLINED;
    return sign_of(minor3(row[0], row[1], row[2]));
}

/* --- at most 20 bits --- */

static int insphere_narrow(const int64_t (*r)[3], const wide weight[4]) {
    int64_t lift[4], m[4][4];
    for (int i = 0; i < 4; i++) {
        lift[i] = r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2] - (int64_t)weight[i];
        for (int j = i + 1; j < 4; j++) m[i][j] = r[i][0] * r[j][1] - r[j][0] * r[i][1];
    }
    int64_t bcd = r[1][2] * m[2][3] - r[2][2] * m[1][3] + r[3][2] * m[1][2];
    int64_t acd = r[0][2] * m[2][3] - r[2][2] * m[0][3] + r[3][2] * m[0][2];
    int64_t abd = r[0][2] * m[1][3] - r[1][2] * m[0][3] + r[3][2] * m[0][1];
    int64_t abc = r[0][2] * m[1][2] - r[1][2] * m[0][2] + r[2][2] * m[0][1];
    return sign_of((wide)lift[0] * bcd - (wide)lift[1] * acd + (wide)lift[2] * abd - (wide)lift[3] * abc);
}

/* --- at most 41 bits: a signed sum of 256 bits --- */

typedef struct {
    unsigned_wide low, high;
} sum256;

/* Adds s x y to *sum; s is 1 or -1. */
static void add_product(sum256 *sum, wide x, wide y, int s) {
    bool negative = (x < 0) != (y < 0);
    unsigned_wide a = x < 0 ? -(unsigned_wide)x : (unsigned_wide)x, b = y < 0 ? -(unsigned_wide)y : (unsigned_wide)y;
    uint64_t a0 = (uint64_t)a, a1 = (uint64_t)(a >> 64), b0 = (uint64_t)b, b1 = (uint64_t)(b >> 64);
    unsigned_wide p00 = (unsigned_wide)a0 * b0, p01 = (unsigned_wide)a0 * b1, p10 = (unsigned_wide)a1 * b0;
    unsigned_wide middle = (p00 >> 64) + (uint64_t)p01 + (uint64_t)p10;
    unsigned_wide low = middle << 64 | (uint64_t)p00;
    unsigned_wide high = (unsigned_wide)a1 * b1 + (p01 >> 64) + (p10 >> 64) + (middle >> 64);
    if (negative != (s < 0)) { /* two's complement */
        low = -low;
        high = ~high + (low == 0);
    }
    sum->low += low;
    sum->high += high + (sum->low < low);
}

static int insphere_wide(const int64_t (*r)[3], const wide weight[4]) {
    sum256 sum = {0, 0};
    for (int i = 0; i < 4; i++) {
        const int64_t *other[3];
        for (int j = 0, n = 0; j < 4; j++)
            if (j != i) other[n++] = r[j];
        wide lift = (wide)r[i][0] * r[i][0] + (wide)r[i][1] * r[i][1] + (wide)r[i][2] * r[i][2] - weight[i];
        add_product(&sum, lift, minor3(other[0], other[1], other[2]), i % 2 ? -1 : 1);
    }
    if (sum.high >> 127) return -1;
    return (sum.high | sum.low) != 0;
}

int brio_insphere_integer(const double *a, const double *b, const double *c, const double *d, const double *e,
                          bool weighted) {
    const double *p[4] = {a, b, c, d};
    int64_t row[4][3];
    wide weight[4] = {0, 0, 0, 0};
    if (!brio_grid_rows(p, 4, e, weighted, row, weight)) return DECLINED;
    bool narrow = brio_grid_bits((const int64_t(*)[3])row, 4) <= NARROW_BITS;
    for (int i = 0; i < 4; i++) narrow &= weight[i] < (wide)1 << 42 && weight[i] > -((wide)1 << 42);
    return narrow ? insphere_narrow((const int64_t(*)[3])row, weight) : insphere_wide((const int64_t(*)[3])row, weight);
}
