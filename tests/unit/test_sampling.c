/* Thinning and outliers: held against their definitions by brute force, on any order of the points, with any number of
 * threads, on degenerate and extreme inputs, and without memory. */
#include "failing_allocator.h"
#include "points.h"

static double square_of(const double *p, const double *q, double spacing) {
    double sum = 0;
    for (int k = 0; k < 3; k++) sum += (p[k] / spacing - q[k] / spacing) * (p[k] / spacing - q[k] / spacing);
    return sum;
}

/* Chosen points are apart, and each other point is near a chosen one. Distances within a rounding of the spacing may
 * count as either. */
static void expect_maximal(const double *points, size_t n, double spacing, const uint8_t *chosen) {
    const double rounding = 1e-12;
    for (size_t i = 0; i < n; i++) {
        size_t near = 0;
        for (size_t j = 0; j < n; j++)
            if (j != i && chosen[j])
                near += square_of(points + 3 * i, points + 3 * j, spacing) < 1 + (chosen[i] ? -rounding : rounding);
        EXPECT(chosen[i] ? near == 0 : near > 0, "point %zu: %d, %zu near", i, chosen[i], near);
    }
}

/* Thins points, and again reversed with three threads. */
static void expect_thinned(const double *points, size_t n, double spacing) {
    brio_context *ctx = new_context();
    double *turned = malloc(3 * n * sizeof *turned);
    uint8_t *chosen = malloc(n), *again = malloc(n);
    size_t count = 0, count_again = 0;
    for (size_t i = 0; i < n; i++) memcpy(turned + 3 * i, points + 3 * (n - 1 - i), 3 * sizeof *points);
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_thin(ctx, points, n, spacing, chosen, &count) == BRIO_OK, "%s", brio_message(ctx));
    expect_maximal(points, n, spacing, chosen);
    brio_context_set_threads(ctx, 3);
    EXPECT(brio_thin(ctx, turned, n, spacing, again, &count_again) == BRIO_OK);
    EXPECT(count == count_again && count > 0, "%zu, %zu", count, count_again);
    for (size_t i = 0; i < n; i++) {
        if (chosen[i] == again[n - 1 - i]) continue;
        bool coincident = false; /* of coincident points either may be the first */
        for (size_t j = 0; j < n; j++) coincident |= j != i && !memcmp(points + 3 * i, points + 3 * j, 24);
        EXPECT(coincident, "point %zu", i);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    free(turned);
    free(chosen);
    free(again);
}

static void thinned_sets_are_maximal(void) {
    enum { N = 1500 };
    double points[3 * N];
    static const double spacings[] = {1e-9, 0.03, 0.2, 5};
    for (int i = 0; i < 4; i++) {
        uniform_points(1, N, points);
        expect_thinned(points, N, spacings[i]);
        clustered_points(2, N, points);
        expect_thinned(points, N, spacings[i]);
        sphere_points(3, N, points);
        expect_thinned(points, N, spacings[i]);
    }
    integer_points(4, N, 8, points);
    for (int i = 1; i < 4; i++) expect_thinned(points, N, i);
}

static void thinning_at_extreme_scales(void) {
    enum { N = 300 };
    double points[3 * N];
    static const double scales[] = {1e-300, 1e-150, 1e150, 1e307};
    for (int i = 0; i < 4; i++) {
        uniform_points(5, N, points);
        for (size_t j = 0; j < 3 * N; j++) points[j] = (points[j] - 0.5) * 2 * scales[i];
        expect_thinned(points, N, 0.3 * scales[i]);
    }
    clustered_points(6, N, points);
    for (int k = 0; k < 3; k++) points[k] = 1e200; /* cells as wide as the spacing have no numbers */
    expect_thinned(points, N, 1e-3);
}

static void thinning_refuses(void) {
    brio_context *ctx = new_context();
    double points[6] = {0, 0, 0, 1, NAN, 0};
    uint8_t chosen[2];
    size_t count = 7;
    EXPECT(brio_thin(ctx, points, 1, 0, chosen, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_thin(ctx, points, 1, NAN, chosen, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_thin(ctx, points, 2, 1, chosen, NULL) == BRIO_ERR_NOT_FINITE);
    EXPECT(brio_thin(ctx, points, 1, 1, chosen, &count) == BRIO_OK && count == 1 && chosen[0] == 1);
    EXPECT(brio_thin(ctx, NULL, 0, 1, NULL, &count) == BRIO_OK && count == 0);
    EXPECT(brio_outliers(ctx, points, 1, 0, NULL, chosen) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_outliers(ctx, points, 1, 64, NULL, chosen) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_outliers(ctx, points, 2, 8, NULL, chosen) == BRIO_ERR_NOT_FINITE);
    EXPECT(brio_outliers(ctx, points, 1, 8, NULL, chosen) == BRIO_OK && chosen[0] == 0);
    brio_context_free(ctx);
}

/* An infinite number was said to be no number above 0, and none of 1 or more. */
static void infinite_spacings_and_factors_are_said_to_be_infinite(void) {
    const double point[3] = {0, 0, 0};
    brio_context *ctx = new_context();
    brio_outliers_options o = {0};
    uint8_t chosen[1];
    EXPECT(brio_thin(ctx, point, 1, INFINITY, chosen, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(ctx), "expected a finite number above 0"), "%s", brio_message(ctx));
    o.factor = INFINITY;
    EXPECT(brio_outliers(ctx, point, 1, 8, &o, chosen) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(ctx), "expected a finite number, 1 or more"), "%s", brio_message(ctx));
    brio_context_free(ctx);
}

/* memcpy from NULL is undefined also for no bytes. */
static void no_points_have_no_outliers(void) {
    brio_context *ctx = new_context();
    EXPECT(brio_outliers(ctx, NULL, 0, 8, NULL, NULL) == BRIO_OK, "%s", brio_message(ctx));
    brio_context_free(ctx);
}

/* Points on a sphere with stray points: the stray ones are found and no other, in any order. */
static void outliers_are_found(void) {
    enum { N = 4000, STRAY = 20, ALL = N + STRAY };
    static double points[3 * ALL], turned[3 * ALL];
    uint8_t outlier[ALL], again[ALL];
    brio_context *ctx = new_context();
    sphere_points(7, N, points);
    for (size_t i = N; i < ALL; i++) {
        double r = i % 2 ? 0.5 : 1.8;
        sphere_points(i, 1, points + 3 * i);
        for (size_t k = 0; k < 3; k++) points[3 * i + k] *= r;
    }
    for (size_t i = 0; i < ALL; i++) memcpy(turned + 3 * i, points + 3 * (ALL - 1 - i), 3 * sizeof *points);
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_outliers(ctx, points, ALL, 8, NULL, outlier) == BRIO_OK);
    brio_context_set_threads(ctx, 3);
    EXPECT(brio_outliers(ctx, turned, ALL, 8, NULL, again) == BRIO_OK);
    for (size_t i = 0; i < ALL; i++) {
        EXPECT(outlier[i] == (i >= N), "point %zu: %d", i, outlier[i]);
        EXPECT(outlier[i] == again[ALL - 1 - i], "point %zu", i);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* Sets outlier[i] for points times 2^exponent. */
static void find_outliers_at(const double *points, size_t n, int exponent, uint8_t *outlier) {
    brio_context *ctx = new_context();
    double *scaled = malloc(3 * n * sizeof *scaled);
    for (size_t i = 0; i < 3 * n; i++) scaled[i] = ldexp(points[i], exponent);
    EXPECT(brio_outliers(ctx, scaled, n, 8, NULL, outlier) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    free(scaled);
}

/* Counts the outliers of the grid of `side`^3 points of that spacing, moved by `shift`. */
static size_t count_grid_outliers(int side, double spacing, double shift, int neighbours) {
    brio_context *ctx = new_context();
    brio_outliers_options o = {0};
    double points[3 * 125];
    uint8_t outlier[125];
    size_t n = 0, count = 0;
    o.factor = 1;
    for (int i = 0; i < side * side * side; i++, n++) {
        points[3 * n] = i % side * spacing + shift;
        points[3 * n + 1] = i / side % side * spacing + shift;
        points[3 * n + 2] = i / side / side * spacing + shift;
    }
    EXPECT(brio_outliers(ctx, points, n, neighbours, &o, outlier) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < n; i++) count += outlier[i];
    brio_context_free(ctx);
    return count;
}

/* With factor 1 points of equal spacings were outliers of each other: two points for 415 of 1,000 distances, and all corners
 * of a cube for some sizes. Spacings were equal to their threshold, or above it by a rounding. */
static void equal_spacings_are_no_outliers(void) {
    for (int k = 1; k <= 1000; k += SHORT_TESTS ? 3 : 1) {
        double spacings[] = {k, 0.1 * k, ldexp(k, -700), ldexp(0.1 * k, 900)};
        for (int s = 0; s < 4; s++) {
            EXPECT(count_grid_outliers(2, spacings[s], 0, 3) == 0, "the cube of side %g", spacings[s]);
            EXPECT(count_grid_outliers(4, spacings[s], 0, 3) == 0, "the grid of spacing %g", spacings[s]);
            EXPECT(count_grid_outliers(3, spacings[s], 1e6 * spacings[s], 3) == 0, "the grid far away, %g",
                   spacings[s]);
        }
    }
}

/* A grid of the spacing 0.1, thinned to 0.1, lost 792 of 1,728 points: distances were 0.1 up to rounding, some of them below it. */
static void grids_thinned_to_their_spacing_stay_whole(void) {
    enum { SIDE = 12, COUNT = SIDE * SIDE * SIDE };
    static double points[3 * COUNT];
    static uint8_t chosen[COUNT];
    const double spacings[] = {1, 0.1, 0.3, 1.0 / 3, 1e-3}, shifts[] = {0, 1000, -12345.678};
    brio_context *ctx = new_context();
    for (size_t s = 0; s < 15; s++) {
        double spacing = spacings[s % 5];
        size_t count = 0;
        for (size_t i = 0; i < COUNT; i++) {
            const size_t at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
            for (size_t k = 0; k < 3; k++) points[3 * i + k] = shifts[s / 5] + spacing * (double)at[k];
        }
        EXPECT(brio_thin(ctx, points, COUNT, spacing, chosen, &count) == BRIO_OK && count == COUNT,
               "spacing %g at %g: %zu", spacing, shifts[s / 5], count);
        EXPECT(brio_thin(ctx, points, COUNT, 1.001 * spacing, chosen, &count) == BRIO_OK && count < COUNT);
    }
    brio_context_free(ctx);
}

/* A spacing that is larger by more than rounding is above the threshold still. */
static void unequal_spacings_are_outliers_by_factor_1(void) {
    brio_context *ctx = new_context();
    brio_outliers_options o = {0};
    const double points[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 3 + 1e-12, 0, 0};
    uint8_t outlier[4];
    o.factor = 1;
    EXPECT(brio_outliers(ctx, points, 4, 1, &o, outlier) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(!outlier[0] && !outlier[1] && !outlier[2] && outlier[3], "%d %d %d %d", outlier[0], outlier[1], outlier[2],
           outlier[3]);
    brio_context_free(ctx);
}

/* Beyond 1e154 all spacings were infinite, below 1e-162 all 0: no point was an outlier, or good ones were. The coordinates
 * have 30 bits, so that small ones are exact, too. */
static void outliers_are_the_same_at_every_scale(void) {
    enum { N = 1000, STRAY = 10, ALL = N + STRAY };
    static const int exponents[] = {-1040, -1000, -600, -530, -500, -256, -100, 100, 300, 500, 515, 600, 1000, 1020};
    double points[3 * ALL];
    uint8_t outlier[ALL], again[ALL];
    sphere_points(7, ALL, points);
    for (size_t i = 3 * (size_t)N; i < 3 * (size_t)ALL; i++) points[i] *= 1.8;
    for (size_t i = 0; i < 3 * (size_t)ALL; i++) points[i] = rint(points[i] * 0x1p30) * 0x1p-30;
    find_outliers_at(points, ALL, 0, outlier);
    for (size_t i = 0; i < ALL; i++) EXPECT(outlier[i] == (i >= N), "point %zu: %d", i, outlier[i]);
    for (size_t k = 0; k < sizeof exponents / sizeof *exponents; k++) {
        find_outliers_at(points, ALL, exponents[k], again);
        EXPECT(!memcmp(outlier, again, ALL), "2^%d", exponents[k]);
    }
}

/* One point far out must not make all other points coincide. */
static void a_far_outlier_hides_no_other(void) {
    enum { N = 1000, STRAY = 10, ALL = N + STRAY };
    static const double far[] = {1e150, 1e300, 1e300, 1e100};
    static const int exponents[] = {0, 0, 600, -600}; /* of the other points */
    double points[3 * ALL];
    uint8_t outlier[ALL];
    for (int set = 0; set < 4; set++) {
        sphere_points(7, ALL, points);
        for (size_t i = 3 * (size_t)N; i < 3 * (size_t)ALL; i++) points[i] *= 1.8;
        for (size_t i = 0; i < 3 * (size_t)ALL; i++) points[i] = ldexp(points[i], exponents[set]);
        points[3 * (ALL - 1)] = far[set];
        find_outliers_at(points, ALL, 0, outlier);
        for (size_t i = 0; i < ALL; i++) EXPECT(outlier[i] == (i >= N), "set %d, point %zu: %d", set, i, outlier[i]);
    }
}

/* A query among duplicates met them all. */
static void outliers_among_duplicates_cost_little(void) {
    enum { N = BRIEF_TESTS ? 4000 : SHORT_TESTS ? 12000 : 50000, STRAY = N - 1 };
    double *points = calloc(3 * N, sizeof *points);
    uint8_t *outlier = malloc(N);
    brio_context *ctx = new_context();
    sphere_points(7, 1000, points);
    points[3 * STRAY] = 9;
    EXPECT(brio_outliers(ctx, points, N, 8, NULL, outlier) == BRIO_OK);
    for (size_t i = 0; i < N; i++) EXPECT(outlier[i] == (i == STRAY), "point %zu", i);
    free(points);
    free(outlier);
    brio_context_free(ctx);
}

/* A set whose spacing doubles again and again has no outliers. */
static void sparse_parts_are_no_outliers(void) {
    enum { N = 600 };
    double points[3 * N];
    uint8_t outlier[N];
    brio_context *ctx = new_context();
    for (size_t i = 0; i < N; i++) {
        double r = pow(1.02, (double)(i / 12)), a = (double)(i % 12) * 0.523599;
        points[3 * i] = r * cos(a), points[3 * i + 1] = r * sin(a), points[3 * i + 2] = 0;
    }
    EXPECT(brio_outliers(ctx, points, N, 8, NULL, outlier) == BRIO_OK);
    for (size_t i = 0; i < N; i++) EXPECT(!outlier[i], "point %zu", i);
    brio_context_free(ctx);
}

static brio_status choose(brio_context *ctx) {
    double points[300];
    uint8_t flags[100];
    uniform_points(8, 100, points);
    brio_status status = brio_thin(ctx, points, 100, 0.2, flags, NULL);
    return status == BRIO_OK ? brio_outliers(ctx, points, 100, 4, NULL, flags) : status;
}

static void without_memory(void) {
    expect_clean_failures(choose);
}

static int cancel(const char *stage, double fraction, void *user) {
    EXPECT(fraction >= 0 && fraction <= 1, "%s %g", stage, fraction);
    return --*(int *)user < 0;
}

static void can_be_cancelled(void) {
    enum { N = 3000 };
    double points[3 * N];
    uint8_t flags[N];
    brio_context *ctx = new_context();
    uniform_points(9, N, points);
    for (int allowed = 0; allowed < 3; allowed++) {
        int left = allowed;
        brio_context_set_progress(ctx, cancel, &left);
        EXPECT(brio_thin(ctx, points, N, 0.1, flags, NULL) == BRIO_ERR_CANCELLED);
        left = allowed;
        EXPECT(brio_outliers(ctx, points, N, 4, NULL, flags) == BRIO_ERR_CANCELLED);
        EXPECT(brio_context_memory(ctx) == 0);
    }
    brio_context_free(ctx);
}

SUITE(test_sampling) {
    RUN(thinned_sets_are_maximal);
    RUN(thinning_at_extreme_scales);
    RUN_ALONE(thinning_refuses);
    RUN_ALONE(infinite_spacings_and_factors_are_said_to_be_infinite);
    RUN_ALONE(no_points_have_no_outliers);
    RUN(outliers_are_found);
    RUN_ALONE(outliers_are_the_same_at_every_scale);
    RUN_ALONE(equal_spacings_are_no_outliers);
    RUN_ALONE(unequal_spacings_are_outliers_by_factor_1);
    RUN_ALONE(grids_thinned_to_their_spacing_stay_whole);
    RUN_ALONE(a_far_outlier_hides_no_other);
    RUN_ALONE(outliers_among_duplicates_cost_little);
    RUN_ALONE(sparse_parts_are_no_outliers);
    RUN(without_memory);
    RUN(can_be_cancelled);
    return harness_end();
}
