/* The predicates of the plane against brute force in 128-bit integers, the symbolic perturbation against a real
 * perturbation by separated powers of two, and the stages against each other. */
#include "base/rng.h"
#include "harness.h"
#include "predicates/plane.h"
#include <float.h>
#include <math.h>
#include <stdbool.h>

typedef __int128 wide;

typedef struct {
    long long x, y, w;
} integer_point;

static wide oracle_orient(const integer_point *a, const integer_point *b, const integer_point *c) {
    return (wide)(b->x - a->x) * (c->y - a->y) - (wide)(b->y - a->y) * (c->x - a->x);
}

/* The in-circle determinant as a sum over the four points of lift times the orientation of the others: positive when the
 * lifted query, the last point, is below the plane of a counterclockwise triangle. */
static wide oracle_incircle(const integer_point *p[4], const wide lift[4]) {
    return lift[0] * oracle_orient(p[1], p[2], p[3]) - lift[1] * oracle_orient(p[0], p[2], p[3]) +
           lift[2] * oracle_orient(p[0], p[1], p[3]) - lift[3] * oracle_orient(p[0], p[1], p[2]);
}

static int sign_of(wide x) {
    return (x > 0) - (x < 0);
}

static int lexicographic(const integer_point *p, const integer_point *q) {
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    return (p->y > q->y) - (p->y < q->y);
}

static void check_four(const integer_point *p[4], bool weighted, double scale) {
    double r[4][2], w[4];
    wide lift[4], perturbed[4];
    for (int i = 0; i < 4; i++) {
        int rank = 0;
        for (int j = 0; j < 4; j++) rank += lexicographic(p[j], p[i]) < 0;
        lift[i] = p[i]->x * p[i]->x + p[i]->y * p[i]->y - (weighted ? p[i]->w : 0);
        perturbed[i] = lift[i] * ((wide)1 << 60) + ((wide)1 << (15 * rank));
        r[i][0] = (double)p[i]->x * scale, r[i][1] = (double)p[i]->y * scale;
        w[i] = (double)p[i]->w * scale * scale;
    }
    const double *weights = weighted ? w : NULL;
    int orient = sign_of(oracle_orient(p[0], p[1], p[2]));
    EXPECT(brio_orient2d(r[0], r[1], r[2]) == orient);
    EXPECT(brio_incircle(r[0], r[1], r[2], r[3], weights) == sign_of(oracle_incircle(p, lift)));
    if (orient <= 0) return;
    EXPECT(brio_incircle_perturbed(r[0], r[1], r[2], r[3], weights) == sign_of(oracle_incircle(p, perturbed)));
}

static void every_four_of_a_grid(void) {
    integer_point p[16];
    brio_rng rng = brio_rng_new(5);
    for (int weighted = 0; weighted < 2; weighted++) {
        for (int i = 0; i < 16; i++) p[i] = (integer_point){i / 4, i % 4, brio_rng_below(&rng, 3)};
        for (int i = 0; i < 16 * 16 * 16 * 16; i++) {
            int k[4] = {i >> 12, i >> 8 & 15, i >> 4 & 15, i & 15};
            if (k[0] == k[1] || k[0] == k[2] || k[1] == k[2] || k[3] == k[0] || k[3] == k[1] || k[3] == k[2]) continue;
            const integer_point *four[4] = {&p[k[0]], &p[k[1]], &p[k[2]], &p[k[3]]};
            check_four(four, weighted, 1);
        }
    }
}

/* Integers of up to `bits` bits, scaled so that intermediate results would overflow or underflow in doubles. */
static void integers_at_every_scale(void) {
    const double scales[] = {1, 0x1p-530, 0x1p490, 0x1p-160, 0x1p170, 0x1p-20};
    for (uint64_t trial = 0; trial < 60000; trial++) {
        brio_rng rng = brio_rng_new(trial);
        uint32_t most = trial % 3 == 0 ? 4 : trial % 3 == 1 ? 1000 : 30000;
        integer_point p[4];
        bool distinct = true;
        for (int i = 0; i < 4; i++) {
            p[i].x = brio_rng_below(&rng, most), p[i].y = brio_rng_below(&rng, most), p[i].w = brio_rng_below(&rng, 6);
            for (int j = 0; j < i; j++) distinct &= lexicographic(&p[i], &p[j]) != 0;
        }
        const integer_point *four[4] = {&p[0], &p[1], &p[2], &p[3]};
        if (distinct) check_four(four, trial % 2, scales[trial % 6]);
    }
}

/* Points near a common circle, so that every stage is reached. */
static void stages_agree_near_a_circle(void) {
    int double_double = 0, integer = 0;
    for (uint64_t trial = 0; trial < 40000; trial++) {
        brio_rng rng = brio_rng_new(trial + 1000000);
        double p[4][4], extent[4] = {2, 2, 2, 1};
        double grid = trial % 4 == 0 ? 0x1p20 : trial % 4 == 1 ? 0x1p40 : 0x1p60;
        bool general = trial % 2;
        for (int i = 0; i < 4; i++) {
            double angle = 6.283185307179586 * brio_rng_double(&rng);
            p[i][0] = rint(cos(angle) * grid) / grid, p[i][1] = rint(sin(angle) * grid) / grid;
            p[i][2] = general ? rint(brio_rng_double(&rng) * 4) * 0x1p-30 : 0;
            p[i][3] = general ? rint(brio_rng_double(&rng) * 4) * 0x1p-60 : 0;
        }
        brio_plane_filter f;
        brio_plane_filter_set(&f, extent, general);
        int exact = brio_incircle_dyadic(p[0], p[1], p[2], p[3]);
        const double *const row[4] = {p[0], p[1], p[2], p[3]};
        int dd = brio_incircle_double_double(row, 100, 0), by_grid = brio_incircle_integer(p[0], p[1], p[2], p[3]);
        EXPECT(brio_incircle_sign(&f, p[0], p[1], p[2], p[3], general) == exact);
        EXPECT(dd == 2 || dd == exact);
        EXPECT(by_grid == 2 || by_grid == exact);
        EXPECT(brio_orient2d_integer(p[0], p[1], p[2]) == 2 ||
               brio_orient2d_integer(p[0], p[1], p[2]) == brio_orient2d_dyadic(p[0], p[1], p[2]));
        double_double += dd != 2, integer += by_grid != 2;
    }
    EXPECT(double_double > 10000 && integer > 10000, "%d %d", double_double, integer);
}

static double any_double(brio_rng *rng) {
    int exponent = (int)brio_rng_below(rng, 2098) - 1074;
    double x = ldexp(0.5 + 0.5 * brio_rng_double(rng), exponent);
    return brio_rng_below(rng, 2) ? x : -x;
}

/* Doubles of every exponent: swapping two points swaps the sign, and the query at a vertex gives 0. */
static void every_finite_double_is_exact(void) {
    for (uint64_t trial = 0; trial < 3000; trial++) {
        brio_rng rng = brio_rng_new(trial + 77);
        double p[4][2], w[4];
        for (int i = 0; i < 4; i++) {
            bool zero = brio_rng_below(&rng, 4) == 0;
            p[i][0] = zero ? 0 : any_double(&rng), p[i][1] = zero ? -DBL_MAX : any_double(&rng),
            w[i] = any_double(&rng);
        }
        const double *weights = trial % 2 ? w : NULL;
        double exchanged[4] = {w[1], w[0], w[2], w[3]}, turned[4] = {w[1], w[2], w[0], w[3]};
        int orient = brio_orient2d(p[0], p[1], p[2]), in = brio_incircle(p[0], p[1], p[2], p[3], weights);
        EXPECT(brio_orient2d(p[1], p[0], p[2]) == -orient);
        EXPECT(brio_orient2d(p[1], p[2], p[0]) == orient);
        EXPECT(brio_incircle(p[1], p[0], p[2], p[3], weights ? exchanged : NULL) == -in);
        EXPECT(brio_incircle(p[1], p[2], p[0], p[3], weights ? turned : NULL) == in);
        EXPECT(brio_incircle(p[0], p[1], p[2], p[0], NULL) == 0);
    }
    double low[2] = {-DBL_MAX, 0}, high[2] = {DBL_MAX, 0}, just[2] = {0, 0x1p-1074}, under[2] = {0, -0x1p-1074};
    EXPECT(brio_orient2d(low, high, just) == 1);
    EXPECT(brio_orient2d(low, high, under) == -1);
    EXPECT(brio_incircle(low, high, just, under, NULL) == 1);
}

SUITE(test_plane_predicates) {
    RUN(every_four_of_a_grid);
    RUN(integers_at_every_scale);
    RUN(stages_agree_near_a_circle);
    RUN(every_finite_double_is_exact);
    return harness_end();
}
