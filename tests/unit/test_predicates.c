/* The predicates against brute force in 128-bit integers, the symbolic perturbation against a real perturbation by
 * separated powers of two, and the stages against each other. */
#include "base/rng.h"
#include "harness.h"
#include "predicates/plane.h"
#include "predicates/predicates.h"
#include <string.h>

typedef __int128 wide;

typedef struct {
    long long x, y, z, w;
} integer_point;

static wide det3(const wide m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static wide oracle_orient(const integer_point *p[4]) {
    wide m[3][3];
    for (int i = 0; i < 3; i++) {
        m[i][0] = p[i + 1]->x - p[0]->x;
        m[i][1] = p[i + 1]->y - p[0]->y;
        m[i][2] = p[i + 1]->z - p[0]->z;
    }
    return det3(m);
}

/* The in-sphere determinant as the sum over the five points of (-1)^i lift_i orient(others): positive when the lifted
 * query is below the hyperplane of a positive tetrahedron. */
static wide oracle_insphere(const integer_point *p[5], const wide lift[5]) {
    wide sum = 0;
    for (int i = 0; i < 5; i++) {
        const integer_point *others[4];
        for (int j = 0, k = 0; j < 5; j++)
            if (j != i) others[k++] = p[j];
        wide term = lift[i] * oracle_orient(others);
        sum += i % 2 ? -term : term;
    }
    /* normalised so that raising the query (the last point) over a positive tetrahedron lowers the result */
    return -sum;
}

static int sign_of(wide x) {
    return (x > 0) - (x < 0);
}

static int lexicographic(const integer_point *p, const integer_point *q) {
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    if (p->y != q->y) return p->y < q->y ? -1 : 1;
    return p->z < q->z ? -1 : p->z > q->z;
}

static void check_five(const integer_point *p[5], bool weighted, double scale) {
    if (sign_of(oracle_orient(p)) <= 0) return;
    double r[5][3], w[5];
    wide lift[5], perturbed[5];
    for (int i = 0; i < 5; i++) {
        int rank = 0;
        for (int j = 0; j < 5; j++) rank += lexicographic(p[j], p[i]) < 0;
        lift[i] = p[i]->x * p[i]->x + p[i]->y * p[i]->y + p[i]->z * p[i]->z - (weighted ? p[i]->w : 0);
        perturbed[i] = lift[i] * ((wide)1 << 50) + ((wide)1 << (10 * rank));
        r[i][0] = (double)p[i]->x * scale, r[i][1] = (double)p[i]->y * scale, r[i][2] = (double)p[i]->z * scale;
        w[i] = (double)p[i]->w * scale * scale;
    }
    const double *weights = weighted ? w : NULL;
    int expected = sign_of(oracle_insphere(p, lift)), ties = sign_of(oracle_insphere(p, perturbed));
    EXPECT(brio_orient3d(r[0], r[1], r[2], r[3]) == 1);
    EXPECT(brio_insphere(r[0], r[1], r[2], r[3], r[4], weights) == expected);
    EXPECT(brio_insphere_perturbed(r[0], r[1], r[2], r[3], r[4], weights) == ties);
}

static const int QUERY_LAST[5][5] = {
    {0, 1, 2, 3, 4}, {0, 1, 2, 4, 3}, {0, 1, 3, 4, 2}, {0, 2, 3, 4, 1}, {1, 2, 3, 4, 0}};

/* Each of five points as the query, in both orders of the others (one of which is positive, unless flat). */
static void check_subset(const integer_point *p, const int index[5], bool weighted, double scale) {
    for (int q = 0; q < 5; q++) {
        const integer_point *five[5];
        for (int i = 0; i < 5; i++) five[i] = &p[index[QUERY_LAST[q][i]]];
        check_five(five, weighted, scale);
        const integer_point *swap = five[0];
        five[0] = five[1], five[1] = swap;
        check_five(five, weighted, scale);
    }
}

static void grid_points(integer_point p[27], brio_rng *rng) {
    for (int i = 0; i < 27; i++)
        p[i] = (integer_point){i / 9, i / 3 % 3, i % 3, rng ? (long long)brio_rng_below(rng, 3) : 0};
}

static void every_five_of_a_grid(void) {
    integer_point p[27];
    brio_rng rng = brio_rng_new(7);
    for (int weighted = 0; weighted < 2; weighted++) {
        grid_points(p, weighted ? &rng : NULL);
        int i[5];
        for (i[0] = 0; i[0] < 27; i[0]++)
            for (i[1] = i[0] + 1; i[1] < 27; i[1]++)
                for (i[2] = i[1] + 1; i[2] < 27; i[2]++)
                    for (i[3] = i[2] + 1; i[3] < 27; i[3]++)
                        for (i[4] = i[3] + 1; i[4] < 27; i[4]++) check_subset(p, i, weighted, 1);
    }
}

static void random_small_integers_at_every_scale(void) {
    const double scales[] = {1, 0x1p-498, 0x1p490, 0x1p-160, 0x1p170};
    const int index[5] = {0, 1, 2, 3, 4};
    for (uint64_t trial = 0; trial < 40000; trial++) {
        brio_rng rng = brio_rng_new(trial);
        integer_point p[5];
        bool distinct = true;
        for (int i = 0; i < 5; i++) {
            p[i].x = brio_rng_below(&rng, 4), p[i].y = brio_rng_below(&rng, 4), p[i].z = brio_rng_below(&rng, 4);
            p[i].w = brio_rng_below(&rng, 6);
            for (int j = 0; j < i; j++) distinct &= lexicographic(&p[i], &p[j]) != 0;
        }
        if (distinct) check_subset(p, index, trial % 2, scales[trial % 5]);
    }
}

/* Points near a common sphere, so that every stage is reached. */
static void stages_agree_near_a_sphere(void) {
    int told = 0, close = 0;
    for (uint64_t trial = 0; trial < 20000; trial++) {
        brio_rng rng = brio_rng_new(trial + 1000000);
        double p[5][4];
        for (int i = 0; i < 5; i++) {
            double x = brio_rng_double(&rng) - 0.5, y = brio_rng_double(&rng) - 0.5, z = brio_rng_double(&rng) - 0.5;
            double r = sqrt(x * x + y * y + z * z);
            p[i][0] = x / r, p[i][1] = y / r, p[i][2] = z / r, p[i][3] = ldexp(brio_rng_double(&rng), -60);
        }
        brio_filter f;
        brio_filter_set(&f, (double[]){2, 2, 2}, 1, trial % 2);
        int exact = brio_insphere_exact(p[0], p[1], p[2], p[3], p[4], trial % 2);
        int staged = brio_insphere_sign(&f, p[0], p[1], p[2], p[3], p[4], trial % 2);
        const double *const row[5] = {p[0], p[1], p[2], p[3], p[4]};
        int dd = brio_insphere_double_double(row, trial % 2, (brio_magnitude){100, 0});
        EXPECT(exact == staged);
        EXPECT(dd == 2 || dd == exact);
        told += dd != 2, close += f.unsettled != 0;
    }
    EXPECT(told > 19000 && close > 10000, "told %d close %d", told, close);
}

/* Integer stage against dyadic numbers: grids of every width, near-zero determinants, weights on and off the grid. */
static void integers_agree_with_dyadic_numbers(void) {
    int answered = 0, zeros = 0;
    for (uint64_t trial = 0; trial < 60000; trial++) {
        brio_rng rng = brio_rng_new(trial + 31);
        int bits = 2 + (int)(trial % 42), grid = (int)brio_rng_below(&rng, 80) - 40;
        bool weighted = trial / 3 % 2;
        double p[5][4];
        for (int i = 0; i < 5; i++) {
            for (int k = 0; k < 3; k++) p[i][k] = ldexp((double)(brio_rng_next(&rng) >> (64 - bits)), grid);
            p[i][3] = ldexp((double)(brio_rng_next(&rng) >> (64 - bits)), 2 * grid + (int)brio_rng_below(&rng, 3) - 1);
        }
        if (trial % 3 == 0) /* cospherical: the corners of a box and its middle point reflected */
            for (int i = 1; i < 5; i++)
                for (int k = 0; k < 3; k++) p[i][k] = (i == k + 1 || i == 4) ? p[1][k] : p[0][k];
        if (trial % 3 == 0)
            for (int i = 0; i < 5; i++) p[i][3] = p[0][3];
        int dyadic = brio_insphere_dyadic(p[0], p[1], p[2], p[3], p[4], weighted);
        int integer = brio_insphere_integer(p[0], p[1], p[2], p[3], p[4], weighted);
        EXPECT(integer == 2 || integer == dyadic, "trial %llu", (unsigned long long)trial);
        int orient = brio_orient3d_integer(p[0], p[1], p[2], p[3]);
        EXPECT(orient == 2 || orient == brio_orient3d_dyadic(p[0], p[1], p[2], p[3]));
        answered += integer != 2, zeros += dyadic == 0;
    }
    EXPECT(answered > 50000 && zeros > 15000, "%d answered, %d zeros", answered, zeros);
}

/* Stages on scaled rows against the exact stage, in units of 2^exponent. Where the unit is ordinary they decline. */
static void scaled_rows_agree_with_exact_signs(void) {
    static const int EXPONENTS[] = {-1065, -1000, -400, 0, 100, 400, 1000};
    for (size_t e = 0; e < sizeof EXPONENTS / sizeof *EXPONENTS; e++) {
        int declined = 0, left = 0, unit = EXPONENTS[e];
        bool ordinary = unit == 0 || unit == 100, huge = abs(unit) > 500;
        for (uint64_t trial = 0; trial < 2000; trial++) {
            brio_rng rng = brio_rng_new(trial + 77);
            bool weighted = trial % 2 && !huge;
            double p[5][4], u[4][4], far = ldexp(1, unit);
            for (int i = 0; i < 5; i++) {
                for (int k = 0; k < 3; k++) p[i][k] = ldexp(brio_rng_double(&rng) - 0.5, unit);
                p[i][3] = weighted ? ldexp(brio_rng_double(&rng), 2 * unit) : 0;
            }
            if (trial % 4 == 3)
                for (int k = 0; k < 3; k++) p[4][k] = p[1][k] / 2 + p[2][k] / 2; /* almost on a line */
            brio_filter f;
            brio_filter_set(&f, (double[]){far, far, far}, weighted ? far * far : 0, weighted);
            const double *const row[5] = {p[0], p[1], p[2], p[3], p[4]};
            int sphere = brio_insphere_exact(p[0], p[1], p[2], p[3], p[4], weighted);
            int orient = brio_orient3d_exact(p[0], p[1], p[2], p[3]);
            EXPECT(brio_insphere_sign(&f, p[0], p[1], p[2], p[3], p[4], weighted) == sphere, "2^%d", unit);
            EXPECT(brio_orient3d_sign(&f, p[0], p[1], p[2], p[3]) == orient, "2^%d", unit);
            int scaled = brio_insphere_rescaled(&f, row);
            EXPECT(scaled == 2 || scaled == sphere, "2^%d: %d, not %d", unit, scaled, sphere);
            declined += scaled == 2;
            scaled = brio_orient3d_rescaled(&f, p[0], p[1], p[2], p[3]);
            EXPECT(scaled == 2 || scaled == orient, "2^%d: %d, not %d", unit, scaled, orient);
            declined += scaled == 2;
            brio_plane_filter g;
            brio_plane_filter_set(&g, (double[]){far, far, far, weighted ? far * far : 0}, weighted);
            memcpy(u, p, sizeof u);
            if (!weighted)
                for (int i = 0; i < 4; i++) u[i][2] = 0;
            const double *const place[4] = {u[0], u[1], u[2], u[3]};
            int circle = brio_incircle_exact(u[0], u[1], u[2], u[3]), turn = brio_orient2d_exact(u[0], u[1], u[2]);
            EXPECT(brio_incircle_sign(&g, u[0], u[1], u[2], u[3], weighted) == circle, "2^%d", unit);
            EXPECT(brio_orient2d_sign(&g, u[0], u[1], u[2]) == turn, "2^%d", unit);
            scaled = brio_incircle_rescaled(&g, place);
            EXPECT(scaled == 2 || scaled == circle, "2^%d: %d, not %d", unit, scaled, circle);
            declined += scaled == 2;
            scaled = brio_orient2d_rescaled(&g, u[0], u[1], u[2]);
            EXPECT(scaled == 2 || scaled == turn, "2^%d: %d, not %d", unit, scaled, turn);
            declined += scaled == 2;
            left += f.exact + g.exact > 0;
        }
        EXPECT(ordinary ? declined == 4 * 2000 : declined <= 2000, "2^%d: %d declined", unit, declined);
        EXPECT(left <= 2, "2^%d: %d exact", unit, left);
    }
}

static void extreme_doubles_are_exact(void) {
    const double tiny = 0x1p-1074, huge = 0x1p1023;
    double o[3] = {0, 0, 0}, x[3] = {huge, 0, 0}, y[3] = {0, tiny, 0}, z[3] = {0, 0, 1}, m[3] = {huge, tiny, 0};
    EXPECT(brio_orient3d(o, x, y, z) == 1);
    EXPECT(brio_orient3d(o, y, x, z) == -1);
    EXPECT(brio_orient3d(o, x, y, m) == 0);
    EXPECT(brio_insphere(o, x, y, z, m, NULL) == 0); /* the fourth corner of a rectangle is on the sphere */
    double inside[3] = {1, tiny, 0}, outside[3] = {-tiny, 0, 0};
    EXPECT(brio_insphere(o, x, y, z, inside, NULL) == 1);
    EXPECT(brio_insphere(o, x, y, z, outside, NULL) == -1);
    double low[3] = {-huge, -huge, -huge}, high[3] = {huge, huge, huge};
    EXPECT(brio_orient3d(low, x, y, high) == -brio_orient3d(low, y, x, high));
}

static void weights_move_the_boundary(void) {
    double a[3] = {0, 0, 0}, b[3] = {2, 0, 0}, c[3] = {0, 2, 0}, d[3] = {0, 0, 2}, e[3] = {2, 2, 2};
    double equal[5] = {0, 0, 0, 0, 0}, heavier[5] = {0, 0, 0, 0, 0x1p-1074}, lighter[5] = {0, 0, 0, 0, -0x1p-1074};
    EXPECT(brio_insphere(a, b, c, d, e, equal) == 0);
    EXPECT(brio_insphere(a, b, c, d, e, heavier) == 1);
    EXPECT(brio_insphere(a, b, c, d, e, lighter) == -1);
}

SUITE(test_predicates) {
    RUN(every_five_of_a_grid);
    RUN(random_small_integers_at_every_scale);
    RUN(stages_agree_near_a_sphere);
    RUN(integers_agree_with_dyadic_numbers);
    RUN(scaled_rows_agree_with_exact_signs);
    RUN(extreme_doubles_are_exact);
    RUN(weights_move_the_boundary);
    return harness_end();
}
