/* Which of two segments is longer, exactly: doubles with a bound of their error; segments whose three differences are
 * the same, as on a grid; dyadic numbers for the rest. */
#include "predicates/lengths.h"
#include "predicates/dyadic.h"
#include <math.h>
#include <stdbool.h>

/* A difference is wrong by 2^-53 of itself, a square by 3, a sum of three by 5 of these units, all but their squares;
 * the difference of two such sums by 6 of their sum. */
static const double ERROR = 8 * 0x1p-53;

static double squared(const double *a, const double *b) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

/* Returns whether a - b is a double. */
static bool is_exact(double a, double b) {
    double s = a - b, t = s - a;
    return (a - (s - t)) - (b + t) == 0;
}

static void sort3(double v[3]) {
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2 - i; k++)
            if (v[k] > v[k + 1]) {
                double swap = v[k];
                v[k] = v[k + 1], v[k + 1] = swap;
            }
}

static bool same_differences(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        if (!is_exact(a[k], b[k]) || !is_exact(c[k], d[k])) return false;
        u[k] = fabs(a[k] - b[k]), v[k] = fabs(c[k] - d[k]);
    }
    sort3(u);
    sort3(v);
    return u[0] == v[0] && u[1] == v[1] && u[2] == v[2];
}

static void exact_square(brio_dyadic *sum, const double *a, const double *b) {
    brio_dyadic x, y;
    brio_dyadic_set(sum, 0);
    for (int k = 0; k < 3; k++) {
        brio_dyadic_difference(&x, a[k], b[k]);
        brio_dyadic_multiply(&y, &x, &x);
        brio_dyadic_add(sum, sum, &y, 1);
    }
}

static __attribute__((noinline)) int compare_exactly(const double *a, const double *b, const double *c,
                                                     const double *d) {
    brio_dyadic u, v, r;
    exact_square(&u, a, b);
    exact_square(&v, c, d);
    brio_dyadic_add(&r, &u, &v, -1);
    return r.sign;
}

int brio_compare_lengths(const double *a, const double *b, const double *c, const double *d, uint64_t *exact) {
    double u = squared(a, b), v = squared(c, d), sum = u + v;
    if (sum > 0x1p-900 && sum < 0x1p1000 && fabs(u - v) > ERROR * sum) return u > v ? 1 : -1;
    if (same_differences(a, b, c, d)) return 0;
    ++*exact;
    return compare_exactly(a, b, c, d);
}
