/* Pieces of surface fitted side by side: each as if it were alone, and against the surface that the points are on. */
#include "base/instruction_set.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/noise/local_surface.h"
#include <math.h>
#include <string.h>

/* A neighbourhood of a kind: 0 a quadratic, 1 noise, 2 a plane lattice, 3 a line, 4 one position, 5 too few, 6 two lines (no
 * polynomial), 7 huge. */
static void make_neighbourhood(uint64_t seed, int kind, brio_neighbourhood *n) {
    brio_rng rng = brio_rng_new(seed);
    size_t count = kind == 5 ? brio_rng_below(&rng, 7) : 7 + brio_rng_below(&rng, BRIO_MOST_NEAR - 6);
    n->count = 0;
    for (size_t i = 0; i < count; i++) {
        double u = brio_rng_double(&rng) - 0.5, v = brio_rng_double(&rng) - 0.5, q[3] = {u, v, u * u - u * v / 2};
        if (kind == 1) q[2] = brio_rng_double(&rng);
        if (kind == 2) q[0] = (double)(i % 8) - 3, q[1] = (double)(i / 8) - 3, q[2] = 0;
        if (kind == 3) q[1] = q[2] = 0;
        if (kind == 4) q[0] = q[1] = q[2] = 0;
        if (kind == 6) q[i % 2] = 0, q[2] = 0.25;
        for (int k = 0; k < 3; k++) q[k] = kind == 7 ? ldexp(q[k], 600) : q[k];
        brio_add_neighbour(n, (double[3]){0, 0, 0}, q);
    }
}

static bool same_surface(const brio_local_surface *a, const brio_local_surface *b) {
    return !memcmp(a->frame, b->frame, sizeof a->frame) && a->unit == b->unit &&
           !memcmp(a->coefficient, b->coefficient, sizeof a->coefficient) && a->height == b->height;
}

static void surfaces_do_not_depend_on_their_neighbours_in_a_batch(void) {
    brio_neighbourhood n[BRIO_SURFACE_BATCH], one;
    brio_local_surface s[BRIO_SURFACE_BATCH], alone;
    bool fitted[BRIO_SURFACE_BATCH], is;
    size_t fits = 0, differ = 0;
    for (uint64_t trial = 0; trial < 500; trial++) {
        size_t count = 1 + trial % BRIO_SURFACE_BATCH;
        for (size_t i = 0; i < count; i++) make_neighbourhood(8 * trial + i, (int)((trial * 7 + i * 3) % 8), &n[i]);
        brio_fit_local_surfaces(n, count, s, fitted);
        for (size_t i = 0; i < count; i++) {
            make_neighbourhood(8 * trial + i, (int)((trial * 7 + i * 3) % 8), &one);
            brio_fit_local_surfaces(&one, 1, &alone, &is);
            differ += is != fitted[i] || (is && !same_surface(&alone, &s[i]));
            fits += is;
        }
    }
    EXPECT(differ == 0 && fits > 300, "%zu of %zu differ", differ, fits);
}

static void points_of_a_quadratic_give_it_back(void) {
    for (uint64_t trial = 0; trial < 100; trial++) {
        brio_neighbourhood n;
        brio_local_surface s;
        bool fitted;
        make_neighbourhood(trial, 0, &n);
        if (n.count < 16) continue; /* few points can leave a lopsided plane */
        brio_fit_local_surfaces(&n, 1, &s, &fitted);
        EXPECT(fitted);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const double *a = s.frame[i], *b = s.frame[j];
                EXPECT(fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - (i == j)) < 1e-12, "axes %d and %d", i, j);
            }
        EXPECT(fabs(s.height) < 0.05 && brio_local_spread(&n, &s) < 0.05, "%g, %g", s.height,
               brio_local_spread(&n, &s));
    }
}

static void lines_positions_and_few_points_have_no_surface(void) {
    for (uint64_t seed = 0; seed < 40; seed++)
        for (int kind = 3; kind <= 5; kind++) {
            brio_neighbourhood n;
            brio_local_surface s;
            bool fitted;
            make_neighbourhood(seed, kind, &n);
            brio_fit_local_surfaces(&n, 1, &s, &fitted);
            EXPECT(!fitted, "kind %d", kind);
        }
}

SUITE(test_local_surface) {
    RUN(surfaces_do_not_depend_on_their_neighbours_in_a_batch);
    RUN(points_of_a_quadratic_give_it_back);
    RUN(lines_positions_and_few_points_have_no_surface);
    return harness_end();
}
