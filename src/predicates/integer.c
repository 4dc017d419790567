/* Exact predicates in fixed-width integers, for points on a common grid, such as lattices and scans in single
 * precision.
 *
 * Where the differences of a call are exact doubles, they are integers times one power of two (grid_rows.h). With
 * integers of at most 20 bits, all products except the last fit 64 bits and the sum fits 128 bits. With at most 41
 * bits, every 3 by 3 minor fits 128 bits and the sum fits 256 bits. Integers decide a zero in tens of nanoseconds;
 * dyadic numbers take a microsecond. The functions return DECLINED for other calls. */
#include "predicates/predicates.h"
#include "predicates/grid_rows.h"

typedef brio_wide wide;

enum { NARROW_BITS = 20, WIDE_BITS = 41, DECLINED = 2 };

static wide minor3(const int64_t p[3], const int64_t q[3], const int64_t s[3]) {
    return s[0] * ((wide)p[1] * q[2] - (wide)p[2] * q[1]) + s[1] * ((wide)p[2] * q[0] - (wide)p[0] * q[2]) +
           s[2] * ((wide)p[0] * q[1] - (wide)p[1] * q[0]);
}

int brio_orient3d_integer(const double *a, const double *b, const double *c, const double *d) {
    const double *p[3] = {b, c, d};
    int64_t row[3][3];
    if (!brio_grid_rows(p, 3, a, WIDE_BITS, row, NULL)) return DECLINED;
    return brio_sign_of_wide(minor3(row[0], row[1], row[2]));
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
    return brio_sign_of_wide((wide)lift[0] * bcd - (wide)lift[1] * acd + (wide)lift[2] * abd - (wide)lift[3] * abc);
}

/* --- at most 41 bits: a signed sum of 256 bits --- */

static int insphere_wide(const int64_t (*r)[3], const wide weight[4]) {
    brio_sum256 sum = {0, 0};
    for (int i = 0; i < 4; i++) {
        const int64_t *other[3];
        for (int j = 0, n = 0; j < 4; j++)
            if (j != i) other[n++] = r[j];
        wide lift = (wide)r[i][0] * r[i][0] + (wide)r[i][1] * r[i][1] + (wide)r[i][2] * r[i][2] - weight[i];
        brio_add_product(&sum, lift, minor3(other[0], other[1], other[2]), i % 2 ? -1 : 1);
    }
    return brio_sum256_sign(sum);
}

int brio_insphere_integer(const double *a, const double *b, const double *c, const double *d, const double *e,
                          bool weighted) {
    const double *p[4] = {a, b, c, d};
    int64_t row[4][3];
    wide weight[4] = {0, 0, 0, 0};
    if (!brio_grid_rows(p, 4, e, WIDE_BITS, row, weighted ? weight : NULL)) return DECLINED;
    bool narrow = brio_bits_of((const int64_t(*)[3])row, 4) <= NARROW_BITS;
    for (int i = 0; i < 4; i++) narrow &= weight[i] < (wide)1 << 42 && weight[i] > -((wide)1 << 42);
    return narrow ? insphere_narrow((const int64_t(*)[3])row, weight) : insphere_wide((const int64_t(*)[3])row, weight);
}
