/* Weighted means, see weighted_mean.h.
 *
 * Rounding can carry a sum over the ends of its values, and then it is moved back to the end. Where the values are near
 * the largest double, or so small that products with shares lose bits, they are first scaled by a power of two. */
#include "base/weighted_mean.h"
#include "base/scale.h"
#include <assert.h>
#include <math.h>

/* Exponents of values whose sums cannot overflow, and whose products with shares above 2^-100 are normal numbers. */
enum { LOWEST = -920, HIGHEST = 1020 };

static inline double value_of(const brio_weighted_mean *m, size_t i, size_t component) {
    assert(i < m->count && component < m->components);
    size_t row = m->name ? m->name[m->place[i]] : m->place[i];
    return m->values[m->components * row + component];
}

static double scaled_sum(const brio_weighted_mean *m, size_t component, int exponent) {
    double sum = 0;
    for (size_t i = 0; i < m->count; i++)
        if (m->share[i] != 0) sum += m->share[i] * ldexp(value_of(m, i, component), -exponent);
    return ldexp(sum, exponent);
}

static double mean_of(const brio_weighted_mean *m, size_t component) {
    double sum = 0, low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < m->count; i++) {
        if (m->share[i] == 0) continue;
        double x = value_of(m, i, component);
        sum += m->share[i] * x;
        if (x < low) low = x;
        if (x > high) high = x;
    }
    double most = fmax(fabs(low), fabs(high));
    int exponent = brio_exponent(most);
    if (most > 0 && (exponent < LOWEST || exponent > HIGHEST)) sum = scaled_sum(m, component, exponent);
    return sum < low ? low : sum > high ? high : sum;
}

void brio_weighted_means(const brio_weighted_mean *m, double *mean) {
    for (size_t c = 0; c < m->components; c++) mean[c] = mean_of(m, c);
}
