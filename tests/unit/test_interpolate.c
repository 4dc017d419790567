/* Interpolation: what Sibson's coordinates must satisfy, and their volumes against counted random points. */
#include "harness.h"
#include "base/vector.h"
#include "points.h"

enum { N = 500, Q = 2000 };

typedef struct {
    brio_context *ctx;
    brio_triangulation *t;
    brio_locator *l;
} fixture;

static fixture fixture_new(const double *p, const double *w, size_t n) {
    fixture f = {.ctx = new_context()};
    EXPECT(brio_delaunay(f.ctx, p, w, n, NULL, &f.t) == BRIO_OK);
    EXPECT(brio_locator_new(f.ctx, f.t, p, w, n, &f.l) == BRIO_OK);
    return f;
}

static void fixture_free(fixture *f) {
    brio_locator_free(f->l);
    brio_triangulation_free(f->t);
    EXPECT(brio_context_memory(f->ctx) == 0);
    brio_context_free(f->ctx);
}

static brio_status interpolate(const fixture *f, int method, const double *values, size_t components, const double *x,
                               size_t count, double *results) {
    brio_interpolation o = {0};
    o.method = (brio_interpolation_method)method;
    o.values = values;
    o.components = components;
    return brio_locator_interpolate(f->ctx, f->l, x, count, &o, results);
}

static double extent_of(const double *p, size_t n) {
    double most = 0;
    for (size_t i = 0; i < 3 * n; i++) most = fmax(most, fabs(p[i]));
    return most;
}

/* A constant, and the three coordinates. */
static void expect_linear_functions(const char *name, const double *p, size_t n, const double *x, size_t count) {
    fixture f = fixture_new(p, NULL, n);
    double *values = malloc(4 * n * sizeof *values), *results = malloc(4 * count * sizeof *results);
    uint32_t *tets = malloc(count * sizeof *tets);
    double extent = extent_of(p, n);
    size_t inside = 0;
    for (size_t i = 0; i < n; i++) values[4 * i] = 1, memcpy(values + 4 * i + 1, p + 3 * i, 3 * sizeof *p);
    EXPECT(brio_locator_tetrahedra(f.ctx, f.l, x, count, tets) == BRIO_OK);
    for (int method = 0; method < 2; method++) {
        EXPECT(interpolate(&f, method, values, 4, x, count, results) == BRIO_OK, "%s", brio_message(f.ctx));
        for (size_t i = 0; i < count; i++) {
            EXPECT(isnan(results[4 * i]) == (tets[i] == BRIO_INFINITE), "%s: query %zu", name, i);
            if (tets[i] == BRIO_INFINITE) continue;
            inside++;
            EXPECT(fabs(results[4 * i] - 1) <= 1e-12, "%s, method %d: %.17g", name, method, results[4 * i]);
            for (size_t k = 0; k < 3; k++)
                EXPECT(fabs(results[4 * i + 1 + k] - x[3 * i + k]) <= 1e-9 * extent,
                       "%s, method %d, query %zu: %.17g, not %.17g", name, method, i, results[4 * i + 1 + k],
                       x[3 * i + k]);
        }
    }
    EXPECT(inside > 0, "%s", name);
    fixture_free(&f);
    free(values), free(results), free(tets);
}

static void linear_functions_are_reproduced(void) {
    static double p[3 * N], x[3 * Q];
    uniform_points(1, N, p);
    uniform_points(2, Q, x);
    expect_linear_functions("uniform", p, N, x, Q);
    clustered_points(3, N, p);
    expect_linear_functions("clusters", p, N, x, Q);
    sphere_points(4, N, p);
    for (size_t i = 0; i < 3 * Q; i++) x[i] = 2 * x[i] - 1;
    expect_linear_functions("sphere", p, N, x, Q);
    integer_points(5, N, 7, p);
    for (size_t i = 0; i < 3 * Q; i++) x[i] = floor(12 * fabs(x[i])) / 2;
    expect_linear_functions("grid, ties", p, N, x, Q);
}

/* Makes a grid in a turned box, and places on the sides of the box. */
static void turned_box(size_t side, double angle, brio_rng *rng, double *p, size_t count, double *x) {
    const double c = cos(angle), s = sin(angle), axis[3][3] = {{c * c, s, -c * s}, {-s * c, c, s * s}, {s, 0, c}};
    for (size_t i = 0; i < side * side * side; i++) {
        const double grid[3] = {(double)(i % side), (double)(i / side % side), (double)(i / side / side)};
        for (int k = 0; k < 3; k++) p[3 * i + (size_t)k] = brio_dot(grid, axis[k]);
    }
    for (size_t q = 0; q < count; q++) {
        double place[3], far = (double)(side - 1);
        for (int k = 0; k < 3; k++) place[k] = far * brio_rng_double(rng);
        place[q % 3] = q / 3 % 2 ? far : 0;
        for (int k = 0; k < 3; k++) x[3 * q + (size_t)k] = brio_dot(place, axis[k]);
    }
}

static double slope(const double *x) {
    return x[0] + 2 * x[1] + 3 * x[2];
}

/* In a tetrahedron that is flat up to rounding the volumes of its parts mean nothing: values were NaN, or of anywhere.
 * Natural values beside such tetrahedra were wrong at one place in some thousands. */
static void linear_functions_in_slivers(void) {
    enum { MOST = 6, POINTS = MOST * MOST * MOST, PLACES = 600, BOXES = 40 };
    static double p[3 * POINTS], values[POINTS], x[3 * PLACES], found[PLACES];
    size_t inside = 0;
    brio_rng rng = brio_rng_new(9);
    for (size_t box = 0; box < BOXES; box++) {
        size_t side = 3 + box % (MOST - 2);
        turned_box(side, 0.1 + 0.03 * (double)box, &rng, p, PLACES, x);
        for (size_t i = 0; i < side * side * side; i++) values[i] = slope(p + 3 * i);
        fixture f = fixture_new(p, NULL, side * side * side);
        for (int method = 0; method < 2; method++) {
            EXPECT(interpolate(&f, method, values, 1, x, PLACES, found) == BRIO_OK);
            for (size_t q = 0; q < PLACES; q++) {
                if (isnan(found[q])) continue; /* outside by rounding */
                inside++;
                EXPECT(fabs(found[q] - slope(x + 3 * q)) < 3e-12, "box %zu, method %d, place %zu: %g, %g", box, method,
                       q, found[q], slope(x + 3 * q));
            }
        }
        fixture_free(&f);
    }
    EXPECT(inside > (size_t)BOXES * PLACES / 2, "%zu", inside);
}

static void queries_near_vertices(void) {
    static double p[3 * N], x[3 * Q];
    brio_rng rng = brio_rng_new(8);
    uniform_points(1, N, p);
    for (size_t i = 0; i < Q; i++) {
        double far = pow(10, -16 * brio_rng_double(&rng));
        for (size_t k = 0; k < 3; k++) x[3 * i + k] = p[3 * (i % N) + k] + far * (brio_rng_double(&rng) - 0.5);
    }
    expect_linear_functions("near vertices", p, N, x, Q);
}

static void values_at_vertices_are_exact(void) {
    static double p[3 * N], w[N], values[N], results[N];
    uniform_points(6, N, p);
    for (size_t i = 0; i < N; i++) values[i] = sin(100 * p[3 * i]), w[i] = 0;
    for (int method = 0; method < 2; method++) {
        fixture f = fixture_new(p, method ? w : NULL, N);
        EXPECT(interpolate(&f, method, values, 1, p, N, results) == BRIO_OK);
        for (size_t i = 0; i < N; i++) EXPECT(results[i] == values[i], "%zu: %.17g", i, results[i]);
        fixture_free(&f);
    }
}

/* The share of each point in the cell of x: random points that are nearer to x than to any point, by nearest point. */
static void count_shares(const double *p, size_t n, const double *x, size_t trials, double *share) {
    brio_rng rng = brio_rng_new(3);
    size_t hits = 0;
    for (size_t i = 0; i < n; i++) share[i] = 0;
    while (hits < trials) {
        double y[3], best = INFINITY, own = 0;
        size_t nearest = 0;
        for (size_t k = 0; k < 3; k++)
            y[k] = x[k] + 1.6 * (brio_rng_double(&rng) - 0.5), own += (y[k] - x[k]) * (y[k] - x[k]);
        for (size_t i = 0; i < n; i++) {
            double square = 0;
            for (size_t k = 0; k < 3; k++) square += (y[k] - p[3 * i + k]) * (y[k] - p[3 * i + k]);
            if (square < best) best = square, nearest = i;
        }
        if (own >= best) continue;
        share[nearest]++;
        hits++;
    }
    for (size_t i = 0; i < n; i++) share[i] /= (double)trials;
}

static void coordinates_are_shares_of_the_cell(void) {
    enum { POINTS = 40, TRIALS = 5000 };
    static double p[3 * POINTS], unit[POINTS * POINTS], share[POINTS], results[POINTS];
    const double queries[][3] = {{0.5, 0.5, 0.5}, {0.45, 0.55, 0.6}, {0.6, 0.4, 0.5}};
    uniform_points(12, POINTS, p);
    for (size_t i = 0; i < POINTS; i++) unit[POINTS * i + i] = 1;
    fixture f = fixture_new(p, NULL, POINTS);
    for (int q = 0; q < 3; q++) {
        count_shares(p, POINTS, queries[q], TRIALS, share);
        EXPECT(interpolate(&f, BRIO_INTERPOLATION_NATURAL, unit, POINTS, queries[q], 1, results) == BRIO_OK);
        for (size_t i = 0; i < POINTS; i++)
            EXPECT(fabs(results[i] - share[i]) < 5 * sqrt((share[i] + 1e-4) / TRIALS), "query %d, point %zu: %g, %g", q,
                   i, results[i], share[i]);
    }
    fixture_free(&f);
}

static void the_centre_of_a_cube_has_eight_equal_neighbours(void) {
    double p[27], unit[64] = {0}, results[8];
    for (size_t i = 0; i < 24; i++) p[i] = (double)(i / 3 >> i % 3 & 1);
    for (size_t i = 0; i < 8; i++) unit[8 * i + i] = 1;
    fixture f = fixture_new(p, NULL, 8);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_NATURAL, unit, 8, (const double[3]){0.5, 0.5, 0.5}, 1, results) ==
           BRIO_OK);
    for (int i = 0; i < 8; i++) EXPECT(fabs(results[i] - 0.125) < 1e-15, "%d: %.17g", i, results[i]);
    fixture_free(&f);
}

/* Where rounding drowns the volumes, the values are linear ones: that must be rare inside. */
static void natural_values_are_seldom_linear(void) {
    static double p[3 * N], x[3 * Q], values[N], natural[Q], linear[Q];
    size_t inside = 0, same = 0;
    uniform_points(1, N, p);
    uniform_points(2, Q, x);
    for (size_t i = 0; i < N; i++) values[i] = p[3 * i] * p[3 * i] + p[3 * i + 1] * p[3 * i + 2];
    fixture f = fixture_new(p, NULL, N);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_NATURAL, values, 1, x, Q, natural) == BRIO_OK);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_LINEAR, values, 1, x, Q, linear) == BRIO_OK);
    for (size_t i = 0; i < Q; i++) inside += !isnan(linear[i]), same += natural[i] == linear[i];
    EXPECT(inside > Q / 2 && same <= inside / 500, "%zu of %zu", same, inside);
    fixture_free(&f);
}

/* Values at both ends of the doubles: a constant stays, and what is linear stays linear. */
static void means_of_values_at_the_ends_of_doubles_stay_between_them(void) {
    static const double ends[] = {0x1p-1074, -0x1p-1074, 0x1.fffffffffffffp1023, -0x1.fffffffffffffp1023};
    static double p[3 * N], x[3 * Q], values[5 * N], results[5 * Q];
    uniform_points(1, N, p);
    uniform_points(2, Q, x);
    for (size_t i = 0; i < 5 * N; i++) values[i] = i % 5 < 4 ? ends[i % 5] : floor(p[3 * (i / 5)] * 1000) * 0x1p-1074;
    fixture f = fixture_new(p, NULL, N);
    for (int method = 0; method < 2; method++) {
        EXPECT(interpolate(&f, method, values, 5, x, Q, results) == BRIO_OK);
        for (size_t i = 0; i < Q; i++) {
            if (isnan(results[5 * i])) continue;
            for (size_t k = 0; k < 4; k++)
                EXPECT(results[5 * i + k] == ends[k], "method %d: %.17g", method, results[5 * i + k]);
            EXPECT(fabs(results[5 * i + 4] / 0x1p-1074 - x[3 * i] * 1000) <= 1.5, "method %d: %g", method,
                   results[5 * i + 4]);
        }
    }
    fixture_free(&f);
}

/* Points of a plane were answered NaN. Planes of decimals: up to rounding, but not exactly, the points are in the plane. */
static void points_in_a_plane_are_interpolated_in_it(void) {
    enum { SIDE = 7, POINTS = SIDE * SIDE, PLACES = 500 };
    static const double axes[][2][3] = {{{1, 0, 0}, {0, 1, 0}},   {{0, 1, 0}, {0, 0, 1}},
                                        {{1, 0, 0}, {0, 0, 1}},   {{0.1, 0.2, 0.3}, {0.7, -0.1, 0.2}},
                                        {{1, 1, 0}, {0, 0.3, 1}}, {{1e200, 0, 2e200}, {0, 1e200, 1e200}}};
    brio_rng rng = brio_rng_new(4);
    for (size_t a = 0; a < sizeof axes / sizeof *axes; a++) {
        double p[3 * POINTS], x[3 * PLACES], values[POINTS], rows[PLACES], wanted[PLACES], normal[3];
        brio_cross(axes[a][0], axes[a][1], normal);
        for (int i = 0; i < POINTS; i++) {
            int u = i % SIDE, v = i / SIDE;
            for (int k = 0; k < 3; k++) p[3 * i + k] = u * axes[a][0][k] + v * axes[a][1][k];
            values[i] = 2 * u - v;
        }
        for (int q = 0; q < PLACES; q++) {
            double u = 0.01 + 5.98 * brio_rng_double(&rng), v = 0.01 + 5.98 * brio_rng_double(&rng), off = q % 3;
            for (int k = 0; k < 3; k++)
                x[3 * q + k] = u * axes[a][0][k] + v * axes[a][1][k] + (fabs(normal[k]) < 1e100 ? off * normal[k] : 0);
            wanted[q] = 2 * u - v;
        }
        fixture f = fixture_new(p, NULL, POINTS);
        for (int method = 0; method < 2; method++) {
            EXPECT(interpolate(&f, method, values, 1, x, PLACES, rows) == BRIO_OK, "%s", brio_message(f.ctx));
            for (int q = 0; q < PLACES; q++)
                EXPECT(fabs(rows[q] - wanted[q]) < 1e-10, "plane %zu, place %d: %g, not %g", a, q, rows[q], wanted[q]);
        }
        x[4] = NAN;
        EXPECT(interpolate(&f, 0, values, 1, x, PLACES, rows) == BRIO_ERR_NOT_FINITE);
        EXPECT(strstr(brio_message(f.ctx), "query 1") != NULL, "%s", brio_message(f.ctx));
        fixture_free(&f);
    }
}

static void points_of_a_line_and_of_one_position(void) {
    const double p[] = {0, 0, 0, 0.1, 0.2, 0.3, 0.2, 0.4, 0.6, 0.7, 1.4, 2.1}, values[] = {0, 1, 2, 7};
    const double x[] = {0.15, 0.3, 0.45, 0.5, 1, 1.5, 1, 2, 3};
    double rows[3];
    fixture f = fixture_new(p, NULL, 4), one = fixture_new(p, NULL, 1);
    for (int method = 0; method < 2; method++) {
        EXPECT(interpolate(&f, method, values, 1, x, 3, rows) == BRIO_OK, "%s", brio_message(f.ctx));
        EXPECT(fabs(rows[0] - 1.5) < 1e-12 && fabs(rows[1] - 5) < 1e-12 && isnan(rows[2]), "%g %g %g", rows[0], rows[1],
               rows[2]);
        EXPECT(interpolate(&one, method, values, 1, x, 3, rows) == BRIO_ERR_NO_ANSWER);
    }
    fixture_free(&f);
    fixture_free(&one);
}

/* The frame is that of the points, in any order, and of least squares where they are in no plane. */
static void planes_of_points(void) {
    enum { POINTS = 300 };
    double p[3 * POINTS], turned[3 * POINTS];
    brio_context *ctx = new_context();
    brio_plane_frame f = {0}, g = {0};
    uniform_points(6, POINTS, p);
    for (int i = 0; i < POINTS; i++) p[3 * i + 2] = 0.5 * p[3 * i] + 2 + 0.01 * (p[3 * i + 2] - 0.5);
    for (int i = 0; i < POINTS; i++) memcpy(turned + 3 * i, p + 3 * (POINTS - 1 - i), 3 * sizeof *p);
    EXPECT(brio_plane_fit(ctx, p, POINTS, &f) == BRIO_OK && brio_plane_fit(ctx, turned, POINTS, &g) == BRIO_OK);
    EXPECT(!memcmp(&f, &g, sizeof f) && f.dimension == 3 && f.thickness < 0.006 && f.thickness > 0.003, "%g",
           f.thickness);
    EXPECT(fabs(brio_dot(f.axis[0], f.axis[1])) < 1e-15);
    double normal[3];
    brio_cross(f.axis[0], f.axis[1], normal);
    EXPECT(fabs(normal[0] / normal[2] + 0.5) < 0.01 && fabs(normal[1] / normal[2]) < 0.01, "%g %g", normal[0],
           normal[2]);
    for (int i = 0; i < POINTS; i++) p[3 * i + 1] = 7;
    EXPECT(brio_plane_fit(ctx, p, POINTS, &f) == BRIO_OK && f.dimension == 2);
    brio_plane_project(&f, p, POINTS, turned);
    for (int i = 0; i < POINTS; i++) EXPECT(turned[2 * i] == p[3 * i + 2] && turned[2 * i + 1] == p[3 * i]);
    EXPECT(brio_plane_fit(ctx, p, 1, &f) == BRIO_OK && f.dimension == 0);
    EXPECT(brio_plane_fit(ctx, p, 2, &f) == BRIO_OK && f.dimension == 1);
    EXPECT(brio_plane_fit(ctx, NULL, 0, &f) == BRIO_OK && f.dimension == -1);
    p[5] = INFINITY;
    EXPECT(brio_plane_fit(ctx, p, POINTS, &f) == BRIO_ERR_NOT_FINITE);
    brio_plane_frame unset = {.size = 4};
    EXPECT(brio_plane_fit(ctx, p, 1, &unset) == BRIO_ERR_ARGUMENT);
    brio_context_free(ctx);
}

static void refusals(void) {
    static double p[3 * 100], w[100] = {0}, result;
    uniform_points(7, 100, p);
    fixture f = fixture_new(p, w, 100);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_NATURAL, p, 1, p, 1, &result) == BRIO_ERR_ARGUMENT);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_END, p, 1, p, 1, &result) == BRIO_ERR_ARGUMENT);
    EXPECT(interpolate(&f, BRIO_INTERPOLATION_LINEAR, NULL, 1, p, 1, &result) == BRIO_ERR_ARGUMENT);
    fixture_free(&f);
}

SUITE(test_interpolate) {
    RUN(linear_functions_are_reproduced);
    RUN(linear_functions_in_slivers);
    RUN(queries_near_vertices);
    RUN(values_at_vertices_are_exact);
    RUN(coordinates_are_shares_of_the_cell);
    RUN(the_centre_of_a_cube_has_eight_equal_neighbours);
    RUN(natural_values_are_seldom_linear);
    RUN(means_of_values_at_the_ends_of_doubles_stay_between_them);
    RUN(points_in_a_plane_are_interpolated_in_it);
    RUN(points_of_a_line_and_of_one_position);
    RUN(planes_of_points);
    RUN(refusals);
    return harness_end();
}
