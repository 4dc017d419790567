/* Triangulations of the plane against brute force over all triples, on small integer grids, where ties abound; then large
 * and hostile sets by their exact check, orders of points, points of planes in space, and memory that runs out. */
#include "failing_allocator.h"
#include "plane_compare.h"
#include "points.h"
#include <fenv.h>
#include <float.h>

/* --- brute force --- */

static void brute_force_on_grids(void) {
    for (uint64_t trial = 0; trial < 3000; trial++) {
        brio_rng rng = brio_rng_new(trial);
        plane_set s = {.n = brio_rng_below(&rng, 22), .weighted = trial % 2};
        uint32_t side = 2 + brio_rng_below(&rng, 5), tall = trial % 7 == 0 ? 1 : side, heavy = trial % 4 == 1 ? 4 : 30;
        for (size_t i = 0; i < s.n; i++) {
            s.p[i].x = brio_rng_below(&rng, side), s.p[i].y = brio_rng_below(&rng, tall);
            if (trial % 21 == 0) s.p[i].y = 3 - 2 * s.p[i].x; /* on a slanted line */
            s.p[i].w = brio_rng_below(&rng, heavy);
        }
        compare_with_brute(&s, trial);
    }
}

/* --- large and hostile sets --- */

typedef void (*point_maker)(brio_rng *, size_t n, double *points);

static void make_uniform(brio_rng *rng, size_t n, double *p) {
    for (size_t i = 0; i < 2 * n; i++) p[i] = brio_rng_double(rng);
}
static void make_grid(brio_rng *rng, size_t n, double *p) {
    size_t side = (size_t)sqrt((double)n);
    (void)rng;
    for (size_t i = 0; i < n; i++) p[2 * i] = (double)(i % side), p[2 * i + 1] = (double)(i / side);
}
static void make_decimal_grid(brio_rng *rng, size_t n, double *p) {
    make_grid(rng, n, p);
    for (size_t i = 0; i < 2 * n; i++) p[i] *= 0.1;
}
static void make_duplicates(brio_rng *rng, size_t n, double *p) {
    for (size_t i = 0; i < 2 * n; i++) p[i] = brio_rng_below(rng, 30);
}
static void make_circle(brio_rng *rng, size_t n, double *p) {
    for (size_t i = 0; i < n; i++) {
        double a = 6.283185307179586 * brio_rng_double(rng);
        p[2 * i] = cos(a), p[2 * i + 1] = sin(a);
    }
}
static void make_line(brio_rng *rng, size_t n, double *p) {
    for (size_t i = 0; i < n; i++) {
        double x = brio_rng_below(rng, 1u << 20);
        p[2 * i] = x, p[2 * i + 1] = 3 * x - 7;
    }
}
static void make_almost_line(brio_rng *rng, size_t n, double *p) {
    make_line(rng, n, p);
    p[1] = nextafter(p[1], INFINITY);
}
static void make_clusters(brio_rng *rng, size_t n, double *p) {
    double c[2] = {0, 0};
    for (size_t i = 0; i < n; i++) {
        if (brio_rng_below(rng, 50) == 0) c[0] = brio_rng_double(rng), c[1] = brio_rng_double(rng);
        double scale = pow(10, -12 * brio_rng_double(rng));
        for (size_t k = 0; k < 2; k++) p[2 * i + k] = c[k] + scale * (brio_rng_double(rng) - 0.5);
    }
}
static void make_huge(brio_rng *rng, size_t n, double *p) {
    for (size_t i = 0; i < 2 * n; i++) p[i] = (brio_rng_double(rng) - 0.5) * DBL_MAX * 2;
}
static void make_tiny(brio_rng *rng, size_t n, double *p) {
    for (size_t i = 0; i < 2 * n; i++) p[i] = brio_rng_below(rng, 100) * 0x1p-1074;
}
static void make_every_exponent(brio_rng *rng, size_t n, double *p) {
    for (size_t i = 0; i < 2 * n; i++) p[i] = ldexp(brio_rng_double(rng) - 0.5, (int)brio_rng_below(rng, 2000) - 1000);
}
static void make_two_lines(brio_rng *rng, size_t n, double *p) {
    for (size_t i = 0; i < n; i++) p[2 * i] = i % 2, p[2 * i + 1] = brio_rng_double(rng);
}
static void make_halving(brio_rng *rng, size_t n, double *p) {
    (void)rng;
    for (size_t i = 0; i < n; i++) p[2 * i] = ldexp(1, -(int)(i % 1070)), p[2 * i + 1] = ldexp(1, -(int)(i / 2 % 1070));
}

static const struct {
    const char *name;
    point_maker make;
    size_t n;
} SETS[] = {{"uniform", make_uniform, 30000},
            {"grid", make_grid, 10000},
            {"decimal grid", make_decimal_grid, 10000},
            {"duplicates", make_duplicates, 5000},
            {"circle", make_circle, 3000},
            {"line", make_line, 3000},
            {"almost a line", make_almost_line, 3000},
            {"clusters", make_clusters, 10000},
            {"huge", make_huge, 1500},
            {"tiny", make_tiny, 3000},
            {"every exponent", make_every_exponent, 300},
            {"two lines", make_two_lines, 3000},
            {"halving", make_halving, 1000}};
enum { NUM_SETS = sizeof SETS / sizeof *SETS, SET_MOST = 30000 };

/* Weights about as large as squared distances of neighbours, so that some points are hidden. */
static void make_weights(brio_rng *rng, size_t n, const double *p, double *w) {
    double most = 0;
    for (size_t i = 0; i < 2 * n; i++) most = fmax(most, fabs(p[i]));
    double unit = fmin(most / sqrt((double)n), 1e150);
    for (size_t i = 0; i < n; i++) w[i] = brio_rng_below(rng, 8) * unit * unit * 0.25;
}

static void expect_euler(const brio_delaunay2_stats *s, const char *name) {
    if (s->dimension == 2) EXPECT(s->triangles + 2 + s->hull_edges == 2 * s->vertices, "%s", name);
    EXPECT(s->points == s->vertices + s->duplicates + s->hidden, "%s", name);
}

/* Each set passes its check; a shuffled copy, another seed and other rounds give the same triangles. */
static void check_set(int which, bool weighted) {
    static double p[2 * SET_MOST], w[SET_MOST], q[2 * SET_MOST], v[SET_MOST];
    size_t n = SETS[which].n;
    const char *name = SETS[which].name;
    brio_rng rng = brio_rng_new(100 + (uint64_t)which);
    SETS[which].make(&rng, n, p);
    make_weights(&rng, n, p, w);
    memcpy(q, p, sizeof q), memcpy(v, w, sizeof v);
    for (size_t i = n; i > 1; i--) {
        size_t j = brio_rng_below(&rng, (uint32_t)i);
        double x = q[2 * i - 2], y = q[2 * i - 1], z = v[i - 1];
        q[2 * i - 2] = q[2 * j], q[2 * i - 1] = q[2 * j + 1], v[i - 1] = v[j];
        q[2 * j] = x, q[2 * j + 1] = y, v[j] = z;
    }
    brio_context *ctx = new_context();
    brio_triangulation2 *t = NULL, *u = NULL;
    brio_delaunay2_options o = {0};
    uint64_t first = 0, second = 1;
    EXPECT(brio_delaunay2(ctx, p, weighted ? w : NULL, n, &o, &t) == BRIO_OK, "%s: %s", name, brio_message(ctx));
    EXPECT(brio_triangulation2_check(ctx, t, p, weighted ? w : NULL, n) == BRIO_OK, "%s: %s", name, brio_message(ctx));
    o.seed = 7, o.round_ratio = 0.5;
    EXPECT(brio_delaunay2(ctx, q, weighted ? v : NULL, n, &o, &u) == BRIO_OK, "%s: %s", name, brio_message(ctx));
    EXPECT(brio_triangulation2_checksum(ctx, t, p, &first) == BRIO_OK);
    EXPECT(brio_triangulation2_checksum(ctx, u, q, &second) == BRIO_OK);
    EXPECT(first == second, "%s", name);
    expect_euler(brio_triangulation2_stats(t), name);
    EXPECT(brio_triangulation2_stats(t)->hidden == brio_triangulation2_stats(u)->hidden, "%s", name);
    brio_triangulation2_free(t);
    brio_triangulation2_free(u);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void hostile_sets_pass_their_check(void) {
    for (int i = 0; i < NUM_SETS; i++) check_set(i, false);
}
static void weighted_hostile_sets_pass_their_check(void) {
    for (int i = 0; i < NUM_SETS; i++) check_set(i, true);
}

static void rounding_mode_does_not_matter(void) {
    enum { N = 2000 };
    static double p[2 * N];
    brio_rng rng = brio_rng_new(3);
    brio_context *ctx = new_context();
    uint64_t sum[2] = {0, 1};
    make_decimal_grid(&rng, N, p);
    for (int i = 0; i < 2; i++) {
        brio_triangulation2 *t;
        fesetround(i ? FE_UPWARD : FE_TONEAREST);
        EXPECT(brio_delaunay2(ctx, p, NULL, N, NULL, &t) == BRIO_OK);
        EXPECT(brio_triangulation2_check(ctx, t, p, NULL, N) == BRIO_OK);
        EXPECT(brio_triangulation2_checksum(ctx, t, p, &sum[i]) == BRIO_OK);
        fesetround(FE_TONEAREST);
        brio_triangulation2_free(t);
    }
    EXPECT(sum[0] == sum[1]);
    brio_context_free(ctx);
}

/* --- planes in space --- */

typedef struct {
    size_t n;
    bool weighted;
    double p[3 * 64], w[64];
} flat_set;

/* Integer points of the plane through the origin that u and v span. */
static void make_flat(uint64_t trial, flat_set *s) {
    brio_rng rng = brio_rng_new(trial);
    int u[3], v[3], at[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (int)brio_rng_below(&rng, 5) - 2, v[k] = (int)brio_rng_below(&rng, 5) - 2;
        at[k] = (int)brio_rng_below(&rng, 9) - 4;
    }
    s->n = 3 + brio_rng_below(&rng, 50), s->weighted = trial % 2;
    for (size_t i = 0; i < s->n; i++) {
        int a = (int)brio_rng_below(&rng, 7), b = (int)brio_rng_below(&rng, 7);
        for (size_t k = 0; k < 3; k++) s->p[3 * i + k] = at[k] + a * u[k] + b * v[k];
        s->w[i] = brio_rng_below(&rng, 8);
    }
}

/* The hull facets in the plane of the tetrahedra of the points and one point off their plane, as sorted triples. */
static size_t hull_triples(const brio_triangulation *t, uint32_t apex, uint32_t (*out)[3]) {
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    size_t count = 0;
    for (size_t i = s->tetrahedra; i < s->tetrahedra + s->hull_facets; i++) {
        const uint32_t *v = tet[i].vertex;
        if (v[0] == apex || v[1] == apex || v[2] == apex) continue;
        memcpy(out[count++], v, 3 * sizeof *v);
    }
    return count;
}

static void sort_triple(uint32_t *v) {
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && v[j] < v[j - 1]; j--) {
            uint32_t swap = v[j];
            v[j] = v[j - 1], v[j - 1] = swap;
        }
}

/* A point off the plane of the first points in general position; false if the points are on a line. */
static bool point_off_plane(const flat_set *s, double *apex) {
    for (size_t i = 1; i < s->n; i++)
        for (size_t j = 1; j < i; j++)
            for (int k = 0; k < 3; k++) {
                memcpy(apex, s->p, 3 * sizeof *apex);
                apex[k] += 64;
                if (brio_orient3d(s->p, s->p + 3 * i, s->p + 3 * j, apex)) return true;
            }
    return false;
}

static void compare_with_solid(brio_context *ctx, flat_set *s, const brio_triangulation2 *t, uint64_t trial) {
    static uint32_t solid_triple[256][3], flat_triple[256][3];
    brio_triangulation *solid = NULL;
    if (!point_off_plane(s, s->p + 3 * s->n)) return;
    s->w[s->n] = 0;
    EXPECT(brio_delaunay(ctx, s->p, s->weighted ? s->w : NULL, s->n + 1, NULL, &solid) == BRIO_OK);
    size_t count = hull_triples(solid, (uint32_t)s->n, solid_triple), n = triples_of(t, flat_triple);
    EXPECT(count == n, "trial %llu: %zu, not %zu", (unsigned long long)trial, n, count);
    for (size_t i = 0; i < n; i++) sort_triple(flat_triple[i]);
    for (size_t i = 0; i < count; i++) sort_triple(solid_triple[i]);
    qsort(flat_triple, n, sizeof *flat_triple, compare_triples);
    qsort(solid_triple, count, sizeof *solid_triple, compare_triples);
    EXPECT(n != count || memcmp(flat_triple, solid_triple, n * sizeof *flat_triple) == 0, "trial %llu",
           (unsigned long long)trial);
    brio_triangulation_free(solid);
}

static void planes_in_space_agree_with_tetrahedra(void) {
    brio_context *ctx = new_context();
    int flat = 0;
    for (uint64_t trial = 0; trial < 600; trial++) {
        flat_set s;
        brio_triangulation2 *t = NULL;
        brio_triangulation *none = NULL;
        make_flat(trial, &s);
        const double *w = s.weighted ? s.w : NULL;
        EXPECT(brio_delaunay2_flat(ctx, s.p, w, s.n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_triangulation2_check(ctx, t, s.p, w, s.n) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_delaunay(ctx, s.p, w, s.n, NULL, &none) == BRIO_OK);
        const brio_delaunay2_stats *stats = brio_triangulation2_stats(t);
        EXPECT(stats->dimension == brio_triangulation_stats(none)->dimension);
        EXPECT(memcmp(brio_triangulation2_representatives(t), brio_triangulation_representatives(none),
                      s.n * sizeof(uint32_t)) == 0);
        if (stats->dimension == 2) compare_with_solid(ctx, &s, t, trial);
        flat += stats->dimension == 2;
        brio_triangulation_free(none);
        brio_triangulation2_free(t);
    }
    EXPECT(flat > 300);
    brio_context_free(ctx);
}

/* A plane of constant z, y or x is seen as its coordinates xy, zx, yz are. */
static void planes_of_coordinates_keep_their_orientation(void) {
    enum { N = 200 };
    double p[2 * N], q[3 * N];
    brio_rng rng = brio_rng_new(11);
    brio_context *ctx = new_context();
    uint32_t a[2 * N][3], b[2 * N][3];
    for (int constant = 0; constant < 3; constant++) {
        brio_triangulation2 *t, *u;
        make_uniform(&rng, N, p);
        for (size_t i = 0; i < N; i++) {
            q[3 * i + (size_t)constant] = 5;
            q[3 * i + (size_t)((constant + 1) % 3)] = p[2 * i], q[3 * i + (size_t)((constant + 2) % 3)] = p[2 * i + 1];
        }
        EXPECT(brio_delaunay2(ctx, p, NULL, N, NULL, &t) == BRIO_OK);
        EXPECT(brio_delaunay2_flat(ctx, q, NULL, N, NULL, &u) == BRIO_OK);
        size_t n = triples_of(t, a);
        EXPECT(triples_of(u, b) == n && memcmp(a, b, n * sizeof *a) == 0);
        brio_triangulation2_free(t);
        brio_triangulation2_free(u);
    }
    brio_context_free(ctx);
}

/* --- arguments, memory, progress --- */

static void bad_input_is_refused_with_its_place(void) {
    brio_context *ctx = new_context();
    brio_triangulation2 *t;
    double p[] = {0, 0, 1, 0, 0, NAN, 1, 1}, solid[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 3, 2, 1},
           w[] = {0, 0, INFINITY};
    EXPECT(brio_delaunay2(ctx, p, NULL, 4, NULL, &t) == BRIO_ERR_NOT_FINITE && !t);
    EXPECT(!strcmp(brio_message(ctx), "point 2: y is NaN (1 such point in all)"), "%s", brio_message(ctx));
    EXPECT(brio_delaunay2(ctx, solid, w, 3, NULL, &t) == BRIO_ERR_NOT_FINITE && !t);
    EXPECT(!strcmp(brio_message(ctx), "point 2: weight is infinite (1 such point in all)"), "%s", brio_message(ctx));
    EXPECT(brio_delaunay2_flat(ctx, solid, NULL, 5, NULL, &t) == BRIO_ERR_NO_ANSWER && !t);
    EXPECT(!strcmp(brio_message(ctx), "point 4 is off the plane of points 0, 1 and 2"), "%s", brio_message(ctx));
    brio_delaunay2_options o = {0};
    o.round_ratio = 1;
    EXPECT(brio_delaunay2(ctx, solid, NULL, 4, &o, &t) == BRIO_ERR_ARGUMENT && !t);
    EXPECT(brio_delaunay2(ctx, solid, NULL, (size_t)1 << 29, NULL, &t) == BRIO_ERR_TOO_LARGE && !t);
    EXPECT(brio_delaunay2(ctx, NULL, NULL, 0, NULL, &t) == BRIO_OK);
    EXPECT(brio_triangulation2_stats(t)->dimension == -1);
    EXPECT(brio_triangulation2_check(ctx, t, NULL, NULL, 0) == BRIO_OK);
    EXPECT(brio_triangulation2_check(ctx, t, solid, NULL, 1) == BRIO_ERR_ARGUMENT);
    brio_triangulation2_free(t);
    brio_context_free(ctx);
}

/* The extent of no points was read before it was set: valgrind tells. */
static void no_points_in_space_have_no_plane(void) {
    brio_context *ctx = new_context();
    brio_triangulation2 *t;
    EXPECT(brio_delaunay2_flat(ctx, NULL, NULL, 0, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_triangulation2_stats(t)->dimension == -1);
    EXPECT(brio_triangulation2_check(ctx, t, NULL, NULL, 0) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation2_free(t);
    brio_context_free(ctx);
}

static brio_status build_and_check(brio_context *ctx, bool weighted, bool line) {
    enum { N = 300 };
    double p[2 * N], w[N];
    brio_triangulation2 *t = NULL;
    brio_rng rng = brio_rng_new(9);
    uint64_t sum;
    if (line)
        make_line(&rng, N, p);
    else
        make_duplicates(&rng, N, p);
    make_weights(&rng, N, p, w);
    brio_status status = brio_delaunay2(ctx, p, weighted ? w : NULL, N, NULL, &t);
    if (status == BRIO_OK) status = brio_triangulation2_check(ctx, t, p, weighted ? w : NULL, N);
    if (status == BRIO_OK) status = brio_triangulation2_checksum(ctx, t, p, &sum);
    brio_triangulation2_free(t);
    return status;
}
static brio_status work_plain(brio_context *ctx) {
    return build_and_check(ctx, false, false);
}
static brio_status work_weighted(brio_context *ctx) {
    return build_and_check(ctx, true, false);
}
static brio_status work_line(brio_context *ctx) {
    return build_and_check(ctx, true, true);
}

static void memory_that_runs_out_leaves_nothing(void) {
    expect_clean_failures(work_plain);
    expect_clean_failures(work_weighted);
    expect_clean_failures(work_line);
}

static int cancel_late(const char *stage, double fraction, void *user) {
    (void)stage;
    *(double *)user = fraction;
    return fraction > 0.5;
}

static void progress_rises_and_cancels(void) {
    enum { N = 60000 };
    double *p = malloc(2 * N * sizeof *p), last = 0;
    brio_rng rng = brio_rng_new(2);
    brio_context *ctx = new_context();
    brio_triangulation2 *t;
    make_uniform(&rng, N, p);
    brio_context_set_progress(ctx, cancel_late, &last);
    EXPECT(brio_delaunay2(ctx, p, NULL, N, NULL, &t) == BRIO_ERR_CANCELLED && !t);
    EXPECT(last > 0.5 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    free(p);
}

/* The estimate covers what is held, and not much more. */
static void estimate_is_close(void) {
    enum { N = 100000 };
    double *p = malloc(2 * N * sizeof *p), *w = malloc(N * sizeof *w);
    brio_rng rng = brio_rng_new(2);
    make_uniform(&rng, N, p);
    make_weights(&rng, N, p, w);
    for (int weighted = 0; weighted < 2; weighted++) {
        brio_context *ctx = new_context();
        brio_triangulation2 *t;
        EXPECT(brio_delaunay2(ctx, p, weighted ? w : NULL, N, NULL, &t) == BRIO_OK);
        double ratio = (double)brio_estimate_delaunay2(N, weighted) / (double)brio_context_memory_peak(ctx);
        EXPECT(ratio > 0.99 && ratio < 1.15, "%g", ratio);
        brio_triangulation2_free(t);
        brio_context_free(ctx);
    }
    free(p);
    free(w);
}

/* Half of the least double is 0: the axis along which such points differ must be found all the same. */
static void a_line_one_least_double_long_keeps_both_ends(void) {
    brio_context *ctx = new_context();
    for (size_t axis = 0; axis < 3; axis++)
        for (int far = 0; far < 2; far++) {
            double p[9] = {0};
            brio_triangulation2 *t;
            p[3 + axis] = p[6 + axis] = far ? 5e-324 : -5e-324;
            EXPECT(brio_delaunay2_flat(ctx, p, NULL, 3, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
            const brio_delaunay2_stats *stats = brio_triangulation2_stats(t);
            EXPECT(stats->dimension == 1 && stats->vertices == 2 && stats->duplicates == 1, "axis %zu: dimension %d",
                   axis, stats->dimension);
            EXPECT(brio_triangulation2_check(ctx, t, p, NULL, 3) == BRIO_OK, "%s", brio_message(ctx));
            brio_triangulation2_free(t);
        }
    brio_context_free(ctx);
}

SUITE(test_plane) {
    RUN(brute_force_on_grids);
    RUN(a_line_one_least_double_long_keeps_both_ends);
    RUN(hostile_sets_pass_their_check);
    RUN(weighted_hostile_sets_pass_their_check);
    RUN(rounding_mode_does_not_matter);
    RUN(planes_in_space_agree_with_tetrahedra);
    RUN(planes_of_coordinates_keep_their_orientation);
    RUN(bad_input_is_refused_with_its_place);
    RUN(no_points_in_space_have_no_plane);
    RUN(memory_that_runs_out_leaves_nothing);
    RUN(progress_rises_and_cancels);
    RUN(estimate_is_close);
    return harness_end();
}
