/* Memory estimates against what the context counts. Estimates are of the memory that is touched; the context also counts
 * room that is set aside for growth, which threads do for themselves. */
#include "brio/testdata.h"
#include "brio/laboratory.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include <limits.h>
#include <math.h>
#include <string.h>

enum { N = SHORT_TESTS ? 20000 : 40000, LARGEST = 200000 };

static double points[3 * LARGEST], weights[N];

/* The most bytes that the context held, beyond what it held before. */
static double peak_of_delaunay(const double *w, int threads, const brio_laboratory_options *o) {
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_laboratory *lab = NULL;
    brio_context_set_threads(ctx, threads);
    if (o) EXPECT(brio_laboratory_new(ctx, o, &lab) == BRIO_OK);
    EXPECT(brio_delaunay(ctx, points, w, N, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    double peak = (double)brio_context_memory_peak(ctx);
    brio_laboratory_free(lab);
    brio_triangulation_free(t);
    brio_context_free(ctx);
    return peak;
}

static void triangulations_take_what_was_estimated(void) {
    for (int set = 0; set < 4; set++) {
        if (set == 0) uniform_points(1, N, points);
        if (set == 1) clustered_points(2, N, points);
        if (set == 2) integer_points(3, N, 40, points);
        if (set == 3) sphere_points(4, N, points);
        integer_weights(7, N, 5, weights);
        for (size_t i = 0; i < N; i++) weights[i] *= 1e-6;
        for (int way = 0; way < 4; way++) {
            const double *w = way % 2 ? weights : NULL;
            brio_context *ctx = new_context();
            uint64_t bytes;
            brio_context_set_threads(ctx, 1 + way / 2);
            EXPECT(brio_estimate_delaunay(ctx, points, w, N, NULL, &bytes) == BRIO_OK);
            EXPECT(brio_context_memory(ctx) == 0 && brio_context_threads(ctx) == 1 + way / 2);
            brio_context_free(ctx);
            double ratio = (double)bytes / peak_of_delaunay(w, 1 + way / 2, NULL);
            EXPECT(ratio > (way < 2 ? 0.8 : 0.6) && ratio < 1.3, "set %d, way %d: %g", set, way, ratio);
        }
    }
}

static void triangulations_that_repeat_take_what_was_estimated(void) {
    static const double CUBE[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    uniform_points(1, N, points);
    integer_weights(7, N, 5, weights);
    for (size_t i = 0; i < N; i++) weights[i] *= 1e-6;
    for (int way = 0; way < 4; way++) {
        const brio_periodic_options o = {.size = sizeof o, .cell = CUBE};
        const double *w = way % 2 ? weights : NULL;
        brio_context *ctx = new_context(), *own = new_context();
        brio_periodic *t = NULL;
        uint64_t bytes;
        brio_context_set_threads(ctx, 1 + way / 2);
        brio_context_set_threads(own, 1 + way / 2);
        EXPECT(brio_estimate_periodic(ctx, points, w, N, &o, &bytes) == BRIO_OK && brio_context_memory(ctx) == 0);
        EXPECT(brio_delaunay_periodic(own, points, w, N, &o, &t) == BRIO_OK, "%s", brio_message(own));
        double ratio = (double)bytes / (double)brio_context_memory_peak(own);
        EXPECT(ratio > (way < 2 ? 0.8 : 0.6) && ratio < 1.3, "way %d: %g", way, ratio);
        brio_periodic_free(t);
        brio_context_free(own);
        brio_context_free(ctx);
    }
}

/* Returns the estimate of some of the points, and the ratio to what the work held. */
static double ratio_of_estimate(size_t count, const double *cell, const int *open, int threads) {
    brio_context *ctx = new_context(), *own = new_context();
    brio_triangulation *t = NULL;
    brio_periodic *p = NULL;
    uint64_t bytes = 0;
    brio_context_set_threads(ctx, threads);
    brio_context_set_threads(own, threads);
    if (cell) {
        const brio_periodic_options o = {.size = sizeof o, .cell = cell, .open = {open[0], open[1], open[2]}};
        EXPECT(brio_estimate_periodic(ctx, points, NULL, count, &o, &bytes) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_delaunay_periodic(own, points, NULL, count, &o, &p) == BRIO_OK, "%s", brio_message(own));
    } else {
        EXPECT(brio_estimate_delaunay(ctx, points, NULL, count, NULL, &bytes) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_delaunay(own, points, NULL, count, NULL, &t) == BRIO_OK, "%s", brio_message(own));
    }
    EXPECT(brio_context_memory(ctx) == 0 && brio_context_threads(ctx) == threads);
    double ratio = (double)bytes / (double)brio_context_memory_peak(own);
    brio_triangulation_free(t);
    brio_periodic_free(p);
    brio_context_free(own);
    brio_context_free(ctx);
    return ratio;
}

/* What is there whatever the number of points was in no estimate: those of ten points were a hundredth of the peak. */
static void few_points_take_what_was_estimated(void) {
    static const size_t counts[] = {0, 1, 3, 10, 100, 1000, 4000};
    static const double CUBE[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int flat = 0; flat < 2; flat++)
        for (int way = 0; way < 4; way++)
            for (int k = 0; k < 7; k++) {
                uniform_points(1, counts[k], points);
                for (size_t i = 0; i < counts[k] && flat; i++) points[3 * i + 2] = 0;
                double ratio = ratio_of_estimate(counts[k], way % 2 ? CUBE : NULL, (int[]){0, 0, flat}, 1 + way / 2);
                EXPECT(ratio >= 0.98 && ratio < 1.35, "%zu points, way %d, flat %d: %g", counts[k], way, flat, ratio);
            }
}

/* Points in space that repeats, with gaps: a slab, a sheet, a wire, a shell, clusters. */
static void gappy_points(int set, size_t count) {
    static const double side[3][3] = {{1, 1, 0.2}, {1, 1, 0.02}, {1, 0.05, 0.05}};
    double centre[3 * 64];
    uniform_points(1, count, points);
    uniform_points(2, 64, centre);
    for (size_t i = 0; i < count; i++) {
        double *p = points + 3 * i, q[3] = {p[0] - 0.5, p[1] - 0.5, p[2] - 0.5};
        double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
        for (int j = 0; j < 3; j++) {
            if (set < 3) p[j] *= side[set][j];
            if (set == 3) p[j] = 0.5 + (0.43 + 0.01 * length) * q[j] / length;
            if (set == 4) p[j] = centre[3 * (i % 8) + (size_t)j] + 0.15 * q[j];
            if (set == 5) p[j] = centre[3 * (i % 64) + (size_t)j] + 0.075 * q[j];
        }
    }
}

/* Points that are completed were in no estimate, which was half of the peak for a shell. */
static void gaps_in_space_that_repeats_are_estimated(void) {
    static const double CUBE[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const size_t counts[] = {100, 2000, 10000};
    for (int set = 0; set < 6; set++)
        for (int k = 0; k < 3; k++) {
            gappy_points(set, counts[k]);
            double ratio = ratio_of_estimate(counts[k], CUBE, (int[]){0, 0, 0}, 1);
            EXPECT(ratio >= 0.98 && ratio < 1.35, "set %d of %zu points: %g", set, counts[k], ratio);
        }
}

/* A ball and the ball of half its radius had all of a cluster: the estimate was infinite. */
static void clusters_that_fit_a_ball_are_estimated(void) {
    enum { CLUSTERED = 8000 };
    gappy_points(4, CLUSTERED);
    for (size_t i = 0; i < 3 * CLUSTERED; i++) points[i] = points[i] + 1000 * (double)(i / 3 % 8);
    double ratio = ratio_of_estimate(CLUSTERED, NULL, NULL, 1);
    EXPECT(ratio > 0.8 && ratio < 1.3, "%g", ratio);
}

static void points_on_two_lines(size_t count) {
    for (size_t i = 0; i < count; i++) {
        double at = (double)i / (double)count;
        points[3 * i] = i % 2 ? at : 0.5, points[3 * i + 1] = i % 2 ? 0.5 : at, points[3 * i + 2] = i % 2 ? 0.2 : 0.7;
    }
}

/* Small surroundings of points on two lines have points of one line alone, and no tetrahedra: the growth from none was
 * infinite, and so was the estimate. Then it was a ninth of n^2 / 4, and less of more points. */
static void points_on_two_lines_had_an_infinite_estimate(void) {
    static const size_t counts[] = {1000, 1500, 5000, 16000};
    for (int k = 0; k < 4; k++) {
        brio_context *ctx = new_context();
        uint64_t tetrahedra = 0;
        double n = (double)counts[k];
        points_on_two_lines(counts[k]);
        EXPECT(brio_estimate_tetrahedra(ctx, points, NULL, counts[k], &tetrahedra) == BRIO_OK);
        double ratio = (double)tetrahedra / (n * n / 4);
        EXPECT(ratio > 0.8 && ratio < 1.3, "%g points: %g", n, ratio);
        brio_context_free(ctx);
    }
}

/* Turns points, so that lines along an axis become lines up to rounding. */
static void turn_points(size_t count) {
    for (size_t i = 0; i < count; i++) {
        double *p = points + 3 * i, x = p[0], y = p[1], z = p[2];
        p[0] = 0.48 * x - 0.64 * y + 0.6 * z, p[1] = 0.8 * x + 0.6 * y, p[2] = -0.36 * x + 0.48 * y + 0.8 * z;
    }
}

/* The estimate of more than 16,384 points on two lines grew as they do, and points on lines up to rounding have
 * tetrahedra in their surroundings, too: it was a ten thousandth of n^2 / 4. */
static void many_points_on_two_lines_had_few_tetrahedra(void) {

    for (int turned = 0; turned < 2; turned++)
        for (size_t count = 20000; count <= LARGEST; count *= 10) {
            brio_context *ctx = new_context();
            uint64_t tetrahedra = 0;
            points_on_two_lines(count);
            if (turned) turn_points(count);
            EXPECT(brio_estimate_tetrahedra(ctx, points, NULL, count, &tetrahedra) == BRIO_OK);
            double ratio = (double)tetrahedra / ((double)count * (double)count / 4);
            EXPECT(ratio > 0.5 && ratio < 2, "%zu points, turned %d: %g", count, turned, ratio);
            brio_context_free(ctx);
        }
}

/* Surroundings of points of a spring hold parts of several windings, and grow faster than the whole does: the estimate
 * was four times as large. */
static void points_of_a_spring_had_too_many_tetrahedra(void) {
    enum { SPRING = 8000 };
    brio_context *ctx = new_context();
    brio_triangulation *t = NULL;
    uint64_t tetrahedra = 0;
    for (size_t i = 0; i < SPRING; i++) {
        double angle = 125.0 * (double)i / SPRING;
        points[3 * i] = cos(angle), points[3 * i + 1] = sin(angle), points[3 * i + 2] = angle / 10;
    }
    EXPECT(brio_estimate_tetrahedra(ctx, points, NULL, SPRING, &tetrahedra) == BRIO_OK);
    EXPECT(brio_delaunay(ctx, points, NULL, SPRING, NULL, &t) == BRIO_OK);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    double ratio = (double)tetrahedra / (double)(s->tetrahedra + s->hull_facets);
    EXPECT(ratio > 0.5 && ratio < 3, "%g", ratio);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

/* Surroundings of points of two planes have no tetrahedra: the estimate was of none. */
static void points_of_two_planes_had_no_tetrahedra(void) {
    enum { ON_PLANES = 16000 };
    brio_context *ctx = new_context();
    brio_triangulation *t = NULL;
    uint64_t tetrahedra = 0;
    uniform_points(8, ON_PLANES, points);
    for (size_t i = 0; i < ON_PLANES; i++) points[3 * i + 2] = (double)(i % 2);
    EXPECT(brio_estimate_tetrahedra(ctx, points, NULL, ON_PLANES, &tetrahedra) == BRIO_OK);
    EXPECT(brio_delaunay(ctx, points, NULL, ON_PLANES, NULL, &t) == BRIO_OK);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    double ratio = (double)tetrahedra / (double)(s->tetrahedra + s->hull_facets);
    EXPECT(ratio > 0.8 && ratio < 1.3, "%g", ratio);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

static int count_balls(const char *stage, double fraction, void *user) {
    (void)fraction;
    *(size_t *)user += !strcmp(stage, "estimate");
    return 0;
}

/* `brio info` of 20,000 points on a line took over ten seconds without optimization: twelve balls of exact arithmetic. */
static void points_on_a_line_take_few_balls(void) {
    enum { LINE = 20000, MOST = 24 }; /* a ball is told three or four times: at its beginning, and by looks in it */
    brio_context *ctx = new_context();
    size_t balls = 0;
    uint64_t tetrahedra = 0;
    for (size_t i = 0; i < 3 * LINE; i++) points[i] = 0.1 * (double)(i / 3);
    brio_context_set_progress(ctx, count_balls, &balls);
    EXPECT(brio_estimate_tetrahedra(ctx, points, NULL, LINE, &tetrahedra) == BRIO_OK);
    EXPECT(balls > 0 && balls <= MOST, "%zu times", balls);
    brio_context_free(ctx);
}

/* The estimate triangulated all of a curve, for minutes, and had half as many tetrahedra as there are. */
static void tetrahedra_on_curves_are_estimated(void) {
    static const brio_kind kinds[] = {BRIO_KIND_MOMENT, BRIO_KIND_TORUS, BRIO_KIND_CYLINDER, BRIO_KIND_BALL};
    static const size_t sizes[] = {1200, 20000, 20000, 1200};
    for (int k = 0; k < 4; k++) {
        brio_context *ctx = new_context();
        brio_mesh *mesh = NULL;
        brio_triangulation *t = NULL;
        uint64_t tetrahedra = 0;
        EXPECT(brio_generate(ctx, kinds[k], sizes[k], NULL, &mesh) == BRIO_OK);
        EXPECT(brio_delaunay(ctx, mesh->vertices, NULL, sizes[k], NULL, &t) == BRIO_OK);
        size_t before = brio_context_memory(ctx);
        EXPECT(brio_estimate_tetrahedra(ctx, mesh->vertices, NULL, sizes[k], &tetrahedra) == BRIO_OK);
        EXPECT(brio_context_memory(ctx) == before);
        const brio_delaunay_stats *s = brio_triangulation_stats(t);
        double ratio = (double)tetrahedra / (double)(s->tetrahedra + s->hull_facets);
        EXPECT(ratio > 0.8 && ratio < 1.3, "kind %d: %g", k, ratio);
        brio_triangulation_free(t);
        brio_mesh_free(mesh);
        brio_context_free(ctx);
    }
}

/* Writes points, and their weights, times 2^exponent, and the square of that. */
static void scale_set(size_t count, int exponent, double *p, double *w) {
    for (size_t i = 0; i < 3 * count; i++) p[i] = ldexp(points[i], exponent);
    for (size_t i = 0; i < count; i++) w[i] = ldexp(weights[i], 2 * exponent);
}

static uint64_t tetrahedra_of(const double *p, const double *w, size_t count) {
    brio_context *ctx = new_context();
    uint64_t tetrahedra = 0;
    EXPECT(brio_estimate_tetrahedra(ctx, p, w, count, &tetrahedra) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return tetrahedra;
}

/* Beyond 1e154 all squares were infinite, below 1e-162 all 0: the estimate was 6.8 tetrahedra a point, after many seconds
 * of exact arithmetic. The coordinates have 20 bits, so that small ones are exact, too. */
static void estimates_are_the_same_at_every_scale(void) {
    static double p[3 * N], w[N];
    static const int exponents[] = {-1050, -1000, -600, -500, -100, 100, 300, 480, 500, 600, 1023};
    static const int weighted_exponents[] = {-500, -300, 300, 500};
    static const size_t counts[] = {3000, SHORT_TESTS ? 4000 : 9000};
    for (int set = 0; set < 4; set++) {
        size_t count = counts[set % 2];
        if (set / 2 == 0) uniform_points(1, count, points);
        if (set / 2 == 1) clustered_points(2, count, points);
        for (size_t i = 0; i < 3 * count; i++) points[i] = rint(points[i] * 0x1p20) * 0x1p-21;
        integer_weights(7, count, 5, weights);
        for (size_t i = 0; i < count; i++) weights[i] *= 0x1p-10;
        uint64_t plain = tetrahedra_of(points, NULL, count), weighted = tetrahedra_of(points, weights, count);
        EXPECT(plain != (uint64_t)(6.8 * (double)count) && weighted != plain);
        for (int k = 0; k < 11; k += SHORT_TESTS ? 5 : 1) {
            scale_set(count, exponents[k], p, w);
            EXPECT(tetrahedra_of(p, NULL, count) == plain, "set %d, 2^%d", set, exponents[k]);
        }
        for (int k = 0; k < 4; k++) {
            scale_set(count, weighted_exponents[k], p, w);
            EXPECT(tetrahedra_of(p, w, count) == weighted, "set %d, 2^%d, weighted", set, weighted_exponents[k]);
        }
    }
}

/* Weights and points far out stay finite where the other points are brought near 1. */
static void estimates_of_wide_ranges(void) {
    enum { COUNT = 3000 };
    uniform_points(1, COUNT, points);
    uint64_t plain = tetrahedra_of(points, NULL, COUNT);
    for (size_t i = 0; i < 3 * COUNT; i++) points[i] = ldexp(points[i], -900);
    for (size_t i = 0; i < COUNT; i++) weights[i] = 0x1p900;
    EXPECT(tetrahedra_of(points, weights, COUNT) > 0);
    points[0] = 0x1p1000;
    uint64_t stray = tetrahedra_of(points, NULL, COUNT);
    EXPECT(stray > plain / 2 && stray < 2 * plain, "%g", (double)stray);
}

static void every_way_of_location_takes_what_was_estimated(void) {
    static uint32_t edges[2 * N];
    uniform_points(1, N, points);
    for (uint32_t i = 0; i < N; i++) edges[2 * i] = i, edges[2 * i + 1] = (i + 1) % N;
    for (int way = BRIO_LOCATION_WALK; way < BRIO_LOCATION_END; way++) {
        brio_context *ctx = new_context();
        brio_laboratory_options o = {.locate = (brio_location)way};
        brio_laboratory *lab;
        uint64_t bytes, counted;
        if (way == BRIO_LOCATION_TRACE || way == BRIO_LOCATION_NEIGHBOUR) o.edges = edges, o.num_edges = N;
        EXPECT(brio_laboratory_new(ctx, &o, &lab) == BRIO_OK);
        brio_context_set_threads(ctx, 1);
        EXPECT(brio_estimate_delaunay(ctx, points, NULL, N, NULL, &bytes) == BRIO_OK, "%s", brio_message(ctx));
        brio_laboratory_free(lab);
        double ratio = (double)bytes / peak_of_delaunay(NULL, 1, &o);
        EXPECT(ratio > 0.8 && ratio < 1.3, "way %d: %g", way, ratio);
        o.edges = NULL; /* their number is enough */
        EXPECT(brio_laboratory_new(ctx, &o, &lab) == BRIO_OK);
        EXPECT(brio_estimate_delaunay(ctx, points, NULL, N, NULL, &counted) == BRIO_OK && counted == bytes);
        brio_laboratory_free(lab);
        brio_context_free(ctx);
    }
}

static void surfaces_take_what_was_estimated(void) {
    brio_context *scanner = new_context();
    brio_mesh *scan;
    EXPECT(brio_generate(scanner, BRIO_KIND_SCAN, N, NULL, &scan) == BRIO_OK);
    const double *p = scan->vertices;
    size_t n = scan->num_vertices;
    for (int method = 0; method < 4; method++) {
        brio_context *ctx = new_context();
        brio_mesh *mesh = NULL;
        uint64_t bytes = 0;
        brio_context_set_threads(ctx, 1);
        if (method == 0) {
            EXPECT(brio_estimate_surface(ctx, n, &(brio_surface_options)CRUST_OPTIONS, &bytes) == BRIO_OK);
            EXPECT(make_crust(ctx, p, n, NULL, &mesh, NULL, NULL) == BRIO_OK);
        } else if (method == 1) {
            EXPECT(brio_estimate_surface(ctx, n, &(brio_surface_options)OFFSET_OPTIONS, &bytes) == BRIO_OK);
            EXPECT(make_offset(ctx, p, n, 0.02, NULL, &mesh, NULL) == BRIO_OK);
        } else if (method == 2) {
            EXPECT(brio_estimate_power_shape(ctx, n, NULL, &bytes) == BRIO_OK);
            EXPECT(brio_power_shape(ctx, p, n, NULL, &mesh, NULL, NULL) == BRIO_OK);
        } else {
            EXPECT(brio_estimate_surface(ctx, n, &(brio_surface_options)COCONE_OPTIONS, &bytes) == BRIO_OK);
            EXPECT(make_cocone(ctx, p, n, NULL, &mesh, NULL) == BRIO_OK);
        }
        double ratio = (double)bytes / (double)brio_context_memory_peak(ctx);
        EXPECT(ratio > 0.8 && ratio < 1.7, "method %d: %g", method, ratio);
        brio_mesh_free(mesh);
        brio_context_free(ctx);
    }
    brio_mesh_free(scan);
    brio_context_free(scanner);
}

/* An estimate that did not count the pieces refused work that has the memory, so that the advice to work in pieces failed
 * like the work itself. */
static void pieces_of_the_cocone_count(void) {
    brio_context *scanner = new_context();
    brio_mesh *scan = NULL;
    EXPECT(brio_generate(scanner, BRIO_KIND_SCAN, N, NULL, &scan) == BRIO_OK);
    const size_t pieces[] = {2, 10, 40};
    uint64_t whole = 0, in_pieces = 0;
    for (int i = 0; i < (SHORT_TESTS ? 1 : 3) && scan; i++) {
        brio_context *ctx = new_context();
        brio_surface_options o = COCONE_OPTIONS;
        brio_mesh *mesh = NULL;
        uint64_t bytes = 0;
        brio_context_set_threads(ctx, 1);
        o.pieces = pieces[i];
        EXPECT(brio_estimate_surface(ctx, scan->num_vertices, &o, &bytes) == BRIO_OK);
        EXPECT(make_cocone(ctx, scan->vertices, scan->num_vertices, &o, &mesh, NULL) == BRIO_OK);
        double ratio = (double)bytes / (double)brio_context_memory_peak(ctx);
        EXPECT(ratio > 0.8 && ratio < 2.5, "%zu pieces: %g", pieces[i], ratio);
        brio_mesh_free(mesh);
        brio_context_free(ctx);
    }
    brio_surface_options o = COCONE_OPTIONS;
    o.pieces = 30;
    EXPECT(brio_estimate_surface(scanner, 1000000, &(brio_surface_options)COCONE_OPTIONS, &whole) == BRIO_OK);
    EXPECT(brio_estimate_surface(scanner, 1000000, &o, &in_pieces) == BRIO_OK && in_pieces < whole / 2);
    brio_mesh_free(scan);
    brio_context_free(scanner);
}

static void wrong_arguments_are_refused(void) {
    brio_context *ctx = new_context();
    uint64_t bytes = 77;
    uniform_points(1, 5000, points);
    points[3 * 4000] = NAN;
    EXPECT(brio_estimate_delaunay(ctx, points, NULL, 5000, NULL, &bytes) == BRIO_ERR_NOT_FINITE && bytes == 0);
    EXPECT(brio_estimate_delaunay(ctx, points, NULL, 50, &(brio_delaunay_options){.size = 4}, &bytes) ==
           BRIO_ERR_ARGUMENT);
    EXPECT(brio_estimate_delaunay(ctx, NULL, NULL, 0, NULL, &bytes) == BRIO_OK && bytes < 1 << 20);
    EXPECT(brio_estimate_surface(ctx, 9, &(brio_surface_options){.size = 4}, &bytes) == BRIO_ERR_ARGUMENT &&
           bytes == 0);
    EXPECT(brio_estimate_generate(SIZE_MAX) > SIZE_MAX / 2 && brio_estimate_mesh_subdivide(1000, 2) > 64000);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* 2 * levels overflowed. */
static void estimates_of_levels_out_of_range_are_those_of_the_nearest_level(void) {
    EXPECT(brio_estimate_mesh_subdivide(10, INT_MAX) == brio_estimate_mesh_subdivide(10, 15));
    EXPECT(brio_estimate_mesh_subdivide(10, INT_MIN) == brio_estimate_mesh_subdivide(10, 1));
    EXPECT(brio_estimate_mesh_subdivide(10, 0) == brio_estimate_mesh_subdivide(10, 1));
    EXPECT(brio_estimate_mesh_subdivide(10, 15) > brio_estimate_mesh_subdivide(10, 14));
}

/* Memory was estimated of triangulations that brio_delaunay refuses to make. */
static void options_that_are_refused_have_no_estimate(void) {
    const uint32_t edge[2] = {0, 50};
    brio_delaunay_options wrong[4];
    brio_laboratory *lab;
    brio_context *ctx = new_context();
    uniform_points(1, 50, points);
    for (int i = 0; i < 4; i++) wrong[i] = (brio_delaunay_options){0};
    wrong[0].order = (brio_order)99;
    wrong[1].round_ratio = 1;
    wrong[2].max_tetrahedra = UINT32_MAX;
    for (int i = 0; i < 4; i++) {
        bool leads_nowhere = i == 3; /* an edge */
        brio_laboratory_options o = {.edges = leads_nowhere ? edge : NULL,
                                     .num_edges = leads_nowhere,
                                     .locate = leads_nowhere ? BRIO_LOCATION_NEIGHBOUR : BRIO_LOCATION_WALK};
        EXPECT(brio_laboratory_new(ctx, &o, &lab) == BRIO_OK);
        brio_triangulation *t;
        char message[256];
        uint64_t bytes = 77;
        EXPECT(brio_delaunay(ctx, points, NULL, 50, &wrong[i], &t) == BRIO_ERR_ARGUMENT, "%d", i);
        snprintf(message, sizeof message, "%s", brio_message(ctx));
        EXPECT(brio_estimate_delaunay(ctx, points, NULL, 50, &wrong[i], &bytes) == BRIO_ERR_ARGUMENT, "%d", i);
        EXPECT(bytes == 0 && !strcmp(brio_message(ctx), message), "%d: %s", i, brio_message(ctx));
        brio_laboratory_free(lab);
    }
    brio_context_free(ctx);
}

static int cancel_at_once(const char *stage, double fraction, void *user) {
    (void)stage;
    EXPECT(fraction == 0);
    return ++*(int *)user > 3;
}

static void estimates_can_be_cancelled(void) {
    brio_context *ctx = new_context();
    uint64_t bytes;
    int calls = 0;
    uniform_points(1, N, points);
    brio_context_set_progress(ctx, cancel_at_once, &calls);
    EXPECT(brio_estimate_delaunay(ctx, points, NULL, N, NULL, &bytes) == BRIO_ERR_CANCELLED && bytes == 0);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_estimate) {
    RUN(triangulations_take_what_was_estimated);
    RUN(triangulations_that_repeat_take_what_was_estimated);
    RUN(few_points_take_what_was_estimated);
    RUN(gaps_in_space_that_repeats_are_estimated);
    RUN(clusters_that_fit_a_ball_are_estimated);
    RUN(points_on_two_lines_had_an_infinite_estimate);
    RUN(many_points_on_two_lines_had_few_tetrahedra);
    RUN(points_of_a_spring_had_too_many_tetrahedra);
    RUN(points_of_two_planes_had_no_tetrahedra);
    RUN(points_on_a_line_take_few_balls);
    RUN(tetrahedra_on_curves_are_estimated);
    RUN(estimates_are_the_same_at_every_scale);
    RUN(estimates_of_wide_ranges);
    RUN(every_way_of_location_takes_what_was_estimated);
    RUN(surfaces_take_what_was_estimated);
    RUN(pieces_of_the_cocone_count);
    RUN(wrong_arguments_are_refused);
    RUN(estimates_of_levels_out_of_range_are_those_of_the_nearest_level);
    RUN(options_that_are_refused_have_no_estimate);
    RUN(estimates_can_be_cancelled);
    return harness_end();
}
