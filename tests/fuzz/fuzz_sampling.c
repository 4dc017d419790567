/* Thinning and outliers against their definitions: chosen points are apart and leave no holes; spacings, quartiles and the
 * median by brute force over all points; both for the points in another order, in threads. Small integers, or any finite
 * doubles. */
#include "base/rng.h"
#include "points_input.h"

enum { MOST = 40 };

typedef struct {
    size_t n;
    bool plain;
    double p[3 * MOST];
} cloud;

static void make_cloud(fuzz_input *in, cloud *c) {
    uint8_t mode = fuzz_byte(in);
    c->plain = mode & 3;
    c->n = fuzz_below(in, MOST + 1);
    int side = mode & 1 ? 4 : 32;
    for (size_t i = 0; i < 3 * c->n; i++) c->p[i] = c->plain ? fuzz_byte(in) % side : fuzz_double(in);
}

static void shuffle(const cloud *c, uint64_t seed, cloud *to, size_t *from) {
    brio_rng rng = brio_rng_new(seed);
    *to = *c;
    for (size_t i = 0; i < c->n; i++) from[i] = i;
    for (size_t i = c->n; i > 1; i--) {
        size_t j = brio_rng_below(&rng, (uint32_t)i), swap = from[i - 1];
        from[i - 1] = from[j], from[j] = swap;
    }
    for (size_t i = 0; i < 3 * c->n; i++) to->p[i] = c->p[3 * from[i / 3] + i % 3];
}

static bool coincide(const cloud *c, size_t i, size_t j) {
    const double *a = c->p + 3 * i, *b = c->p + 3 * j;
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* The square of a distance, in which nothing overflows or vanishes. */
static long double square_of(const cloud *c, size_t i, size_t j) {
    long double sum = 0;
    for (size_t k = 0; k < 3; k++) {
        long double by = (long double)c->p[3 * i + k] - (long double)c->p[3 * j + k];
        sum += by * by;
    }
    return sum;
}

/* --- thinning --- */

static void expect_thinned(const cloud *c, double spacing, const uint8_t *chosen, size_t count) {
    const long double rounding = c->plain ? 0 : 1e-12L, wanted = (long double)spacing * (long double)spacing;
    size_t seen = 0;
    for (size_t i = 0; i < c->n; i++) {
        size_t near = 0;
        seen += chosen[i];
        for (size_t j = 0; j < c->n; j++)
            if (j != i && chosen[j]) near += square_of(c, i, j) < wanted * (chosen[i] ? 1 - rounding : 1 + rounding);
        FUZZ_EXPECT(chosen[i] ? !near : near, "point %zu: %d, %zu near", i, chosen[i], near);
        for (size_t j = 0; j < i && chosen[i]; j++) FUZZ_EXPECT(!coincide(c, i, j), "point %zu is not the first", i);
    }
    FUZZ_EXPECT(seen == count, "%zu chosen, %zu said", seen, count);
}

static void thin(brio_context *ctx, fuzz_input *in, const cloud *c) {
    cloud other;
    size_t from[MOST], count = 99, again = 99;
    uint8_t chosen[MOST], turned[MOST];
    double spacing = c->plain ? 1 + fuzz_byte(in) % 8 / 2.0 : fabs(fuzz_double(in));
    brio_status status = brio_thin(ctx, c->p, c->n, spacing, chosen, &count);
    FUZZ_EXPECT(status == (spacing > 0 ? BRIO_OK : BRIO_ERR_ARGUMENT), "%s", brio_message(ctx));
    if (status != BRIO_OK) return;
    expect_thinned(c, spacing, chosen, count);
    shuffle(c, fuzz_byte(in), &other, from);
    brio_context_set_threads(ctx, 3);
    FUZZ_EXPECT(brio_thin(ctx, other.p, c->n, spacing, turned, &again) == BRIO_OK, "%s", brio_message(ctx));
    expect_thinned(&other, spacing, turned, again);
    FUZZ_EXPECT(count == again, "%zu and %zu chosen", count, again);
    for (size_t i = 0; i < c->n; i++) {
        bool alone = true;
        for (size_t j = 0; j < c->n; j++) alone &= j == from[i] || !coincide(c, from[i], j);
        FUZZ_EXPECT(!alone || chosen[from[i]] == turned[i], "point %zu", i);
    }
}

/* --- outliers --- */

typedef struct {
    double square;
    const double *p;
    size_t i;
} near_point;

static int compare_near(const void *a, const void *b) {
    const near_point *x = a, *y = b;
    if (x->square != y->square) return x->square < y->square ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (x->p[k] != y->p[k]) return x->p[k] < y->p[k] ? -1 : 1;
    return 0;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The points nearest to point i, itself left out; their number. */
static size_t find_near(const cloud *c, size_t i, size_t neighbours, near_point *near) {
    size_t n = 0;
    for (size_t j = 0; j < c->n; j++)
        if (j != i) near[n++] = (near_point){(double)square_of(c, i, j), c->p + 3 * j, j};
    qsort(near, n, sizeof *near, compare_near);
    return n < neighbours ? n : neighbours;
}

static double spacing_of(const cloud *c, size_t i, size_t neighbours) {
    near_point near[MOST];
    size_t n = find_near(c, i, neighbours, near);
    double sum = 0;
    for (size_t j = 0; j < n; j++) sum += sqrt(near[j].square);
    return n ? sum / (double)n : 0;
}

static double median_of(double *numbers, size_t n) {
    qsort(numbers, n, sizeof *numbers, compare_doubles);
    return numbers[n / 2];
}

/* The greatest spacing that is none of an outlier wherever it is. */
static double most_allowed(const cloud *c, const double *spacing, double factor) {
    double numbers[MOST];
    size_t n = 0;
    for (size_t i = 0; i < c->n; i++)
        if (spacing[i] > 0) numbers[n++] = spacing[i];
    if (!n) return INFINITY;
    double middle = log(median_of(numbers, n));
    for (size_t i = 0; i < n; i++) numbers[i] = fabs(log(numbers[i]) - middle);
    return exp(middle + fmax(8 * 1.4826 * median_of(numbers, n), 2 * log(factor)));
}

static double greatest_coordinate(const cloud *c) {
    double greatest = 0;
    for (size_t i = 0; i < 3 * c->n; i++) greatest = fmax(greatest, fabs(c->p[i]));
    return greatest;
}

/* Where rounding decides, either answer is right. */
static void expect_outliers(const cloud *c, size_t neighbours, double factor, const uint8_t *outlier) {
    near_point near[MOST];
    double spacing[MOST], numbers[MOST];
    for (size_t i = 0; i < c->n; i++) spacing[i] = spacing_of(c, i, neighbours);
    double most = most_allowed(c, spacing, factor);
    for (size_t i = 0; i < c->n; i++) {
        size_t n = find_near(c, i, neighbours, near);
        for (size_t j = 0; j < n; j++) numbers[j] = spacing[near[j].i];
        if (n) qsort(numbers, n, sizeof *numbers, compare_doubles);
        double allowed = fmin(most, n ? factor * numbers[n / 4] : INFINITY);
        double rounded = factor * 1e-14 * greatest_coordinate(c); /* of the quartile, times the factor */
        if (fabs(spacing[i] - allowed) <= 1e-9 * spacing[i] + rounded) continue;
        FUZZ_EXPECT(outlier[i] == (spacing[i] > allowed), "point %zu: spacing %g, allowed %g", i, spacing[i], allowed);
    }
}

static void find_outliers(brio_context *ctx, fuzz_input *in, const cloud *c) {
    static const double factors[] = {1, 1.5, 2, 3, 10, 0.5, -1, 1e300};
    cloud other;
    size_t from[MOST];
    uint8_t outlier[MOST], turned[MOST];
    brio_outliers_options o = {0};
    int neighbours = 1 + (int)fuzz_below(in, 12);
    o.factor = factors[fuzz_below(in, 8)];
    brio_status status = brio_outliers(ctx, c->p, c->n, neighbours, &o, outlier);
    FUZZ_EXPECT(status == (o.factor >= 1 ? BRIO_OK : BRIO_ERR_ARGUMENT), "%s", brio_message(ctx));
    if (status != BRIO_OK) return;
    if (c->plain) expect_outliers(c, (size_t)neighbours, o.factor, outlier);
    shuffle(c, fuzz_byte(in), &other, from);
    brio_context_set_threads(ctx, 3);
    FUZZ_EXPECT(brio_outliers(ctx, other.p, c->n, neighbours, &o, turned) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < c->n; i++) FUZZ_EXPECT(turned[i] == outlier[from[i]], "point %zu", i);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    cloud c;
    bool thins = fuzz_flag(&in);
    make_cloud(&in, &c);
    (thins ? thin : find_outliers)(ctx, &in, &c);
    fuzz_end();
    return 0;
}
