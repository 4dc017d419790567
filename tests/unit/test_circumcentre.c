/* Circumcentres and orthocentres: known ones, every order of the points, and the error bound against exact residuals.
 * */
#include "harness.h"
#include "instruction_sets.h"
#include "points.h"
#include "predicates/circumcentre.h"
#include <math.h>

static void known_centres(void) {
    const double a[3] = {0, 0, 0}, b[3] = {2, 0, 0}, c[3] = {0, 4, 0}, d[3] = {0, 0, 6};
    double x[3], error, weights[4] = {0, 4, 0, 0};
    EXPECT(brio_circumcentre(a, b, c, d, NULL, x, &error) == BRIO_OK);
    EXPECT(x[0] == 1 && x[1] == 2 && x[2] == 3 && error < 1e-12);
    EXPECT(brio_circumcentre(a, b, c, d, weights, x, NULL) == BRIO_OK);
    EXPECT(x[0] == 0 && x[1] == 2 && x[2] == 3); /* |x|^2 = |x-b|^2 - 4 */
    EXPECT(brio_circumcentre(a, b, c, c, NULL, x, NULL) == BRIO_ERR_ARGUMENT);
}

static void order_of_the_points_does_not_matter(void) {
    static const int order[6][4] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 0, 3, 2}, {2, 3, 0, 1}, {0, 2, 1, 3}, {3, 0, 1, 2}};
    for (uint64_t trial = 0; trial < 2000; trial++) {
        double p[12], w[4], first[3], x[3];
        uniform_points(trial, 4, p);
        for (int i = 0; i < 4; i++) w[i] = p[i] * 0.1;
        if (trial % 3 == 0) p[2] = p[5] = p[8] = 0.5, p[11] = 0.5 + 1e-14; /* nearly flat */
        for (int k = 0; k < 6; k++) {
            const double *q[4];
            double v[4];
            for (int i = 0; i < 4; i++) q[i] = p + 3 * order[k][i], v[i] = w[order[k][i]];
            EXPECT(brio_circumcentre(q[0], q[1], q[2], q[3], v, x, NULL) == BRIO_OK);
            if (k == 0) memcpy(first, x, sizeof x);
            EXPECT(!memcmp(first, x, sizeof x));
        }
    }
}

/* A box's corners have its middle for a centre, which stays within the bound however flat the tetrahedron and wherever
 * the box is. */
static void error_bound_holds_for_flat_and_far_tetrahedra(void) {
    for (int e = 0; e <= 50; e += 5)
        for (int shift = 0; shift < 2; shift++) {
            double h = ldexp(1, -e), o = shift ? 4096 : 0;
            double a[3] = {o, o, 0}, b[3] = {o + 1, o, 0}, c[3] = {o, o + 1, 0}, d[3] = {o + 1, o + 1, h}, x[3], error;
            /* |x-a| = |x-d|: z = (1 + 1 + h^2 - 2 (x + y)) / (2 h) with x = y = 1/2 */
            double z = h / 2;
            EXPECT(brio_circumcentre(a, b, c, d, NULL, x, &error) == BRIO_OK);
            EXPECT(fabs(x[0] - o - 0.5) <= error && fabs(x[1] - o - 0.5) <= error && fabs(x[2] - z) <= error,
                   "2^-%d: %g %g %g, error %g", e, x[0], x[1], x[2], error);
            EXPECT(error < 1e-11);
        }
}

static void extreme_scales_are_answered(void) {
    const double scales[] = {0x1p-1000, 0x1p-600, 0x1p-30, 0x1p500, 0x1p1000};
    for (int s = 0; s < 5; s++) {
        double u = scales[s], a[3] = {0, 0, 0}, b[3] = {2 * u, 0, 0}, c[3] = {0, 4 * u, 0}, d[3] = {0, 0, 6 * u}, x[3];
        EXPECT(brio_circumcentre(a, b, c, d, NULL, x, NULL) == BRIO_OK);
        EXPECT(x[0] == u && x[1] == 2 * u && x[2] == 3 * u, "scale %d", s);
    }
    const double a[3] = {0, 0, 0}, b[3] = {1e300, 0, 0}, c[3] = {0, 1e-300, 0}, d[3] = {1, 1, 1e-300};
    double x[3];
    brio_status status = brio_circumcentre(a, b, c, d, NULL, x, NULL);
    EXPECT(status == BRIO_ERR_ARGUMENT || (isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2])));
}

/* --- in batches --- */

enum { ROWS = 4 * BRIO_CENTRE_BATCH };

/* Four points each: spread evenly, nearly flat, flat, on a small lattice (so that coordinates are equal), tiny, huge. */
static void mixed_points(uint64_t trial, double *p, double *w) {
    uniform_points(trial, ROWS, p);
    for (size_t i = 0; i < ROWS; i++) {
        w[i] = p[3 * i] * p[3 * i + 1] * (trial % 3 ? 1e-3 : 1);
        size_t kind = i / 4 % 6;
        if (kind == 1) p[3 * i + 2] *= ldexp(1, -(int)(trial % 60));
        if (kind == 2) p[3 * i + 2] = 0.25;
        for (size_t k = 0; kind == 3 && k < 3; k++) p[3 * i + k] = floor(4 * p[3 * i + k]) / 4;
        for (size_t k = 0; kind == 4 && k < 3; k++) p[3 * i + k] = ldexp(p[3 * i + k], trial % 2 ? -1060 : -500);
        for (size_t k = 0; kind == 5 && k < 3; k++) p[3 * i + k] = ldexp(p[3 * i + k], trial % 2 ? 1020 : 300);
    }
}

static bool same_centre(const double *x, const double *y) {
    return (isnan(x[0]) && isnan(y[0])) || !memcmp(x, y, 3 * sizeof *x);
}

/* Each centre of a batch against brio_circumcentre. */
static void check_batch(const brio_centre_batch *b, const double *centre, int set) {
    for (size_t n = 0; n < b->count; n++) {
        const double *p[4];
        double w[4] = {0}, x[3];
        for (int i = 0; i < 4; i++) {
            p[i] = b->points + 3 * (size_t)b->vertex[n][i];
            if (b->weights) w[i] = b->weights[b->vertex[n][i]];
        }
        brio_status status = brio_circumcentre(p[0], p[1], p[2], p[3], b->weights ? w : NULL, x, NULL);
        if (status != BRIO_OK) x[0] = NAN;
        EXPECT(same_centre(x, centre + 3 * n), "%s: tetrahedron %zu: %g %g %g",
               brio_instruction_set_name((brio_instruction_set)set), n, x[0], x[1], x[2]);
    }
}

static const brio_centre_engine *engine_of(int set) {
#if defined(__x86_64__)
    if (set == BRIO_AVX2) return &brio_centres_avx2;
    if (set == BRIO_AVX512) return &brio_centres_avx512;
#endif
    return set == BRIO_PLAIN ? &brio_centres_plain : NULL;
}

/* Batches in the lanes of each set against single centres in plain lanes. */
static void batches_have_the_bits_of_single_centres(void) {
    static double p[3 * ROWS], w[ROWS], centre[3 * BRIO_CENTRE_BATCH];
    uint32_t vertex[BRIO_CENTRE_BATCH][4];
    for (uint32_t i = 0; i < ROWS; i++) vertex[i / 4][i % 4] = i;
    for (int set = BRIO_PLAIN; set < BRIO_INSTRUCTION_SETS; set++) {
        size_t left_over = 0, in_all = 0;
        if (!use_set(set)) continue;
        for (uint64_t trial = 0; trial < 400; trial++) {
            brio_centre_batch b = {p, trial / 2 % 2 ? w : NULL, (const uint32_t(*)[4])vertex, BRIO_CENTRE_BATCH};
            mixed_points(trial, p, w);
            if (trial % 5 == 0) b.count = trial / 5 % BRIO_CENTRE_BATCH;
            uint64_t every = b.count < 64 ? (UINT64_C(1) << b.count) - 1 : UINT64_MAX;
            uint64_t left = engine_of(set)->find(&b, every, &(brio_centre_goal){0x1p-44, centre, 3, NULL});
            EXPECT(!(left & ~every));
            left_over += (size_t)__builtin_popcountll(left), in_all += b.count;
            brio_use_instructions((brio_instruction_set)set);
            brio_centres(&b, centre, NULL);
            brio_use_instructions(BRIO_PLAIN);
            check_batch(&b, centre, set);
        }
        EXPECT(2 * left_over <= in_all, "%zu of %zu left over", left_over,
               in_all); /* flat ones, tiny ones, huge ones */
    }
    use_largest_set();
}

SUITE(test_circumcentre) {
    RUN(batches_have_the_bits_of_single_centres);
    RUN(known_centres);
    RUN(order_of_the_points_does_not_matter);
    RUN(error_bound_holds_for_flat_and_far_tetrahedra);
    RUN(extreme_scales_are_answered);
    return harness_end();
}
