/* The triangulation against brute force, against itself under everything that must not matter, and at its limits. */
#include "brio/testdata.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "trial.h"
#include <math.h>

enum { MOST = 4096 };

/* --- brute force: all quadruples whose perturbed sphere holds no other point --- */

typedef struct {
    size_t tetrahedra;
    bool is_vertex[32];
} brute;

static bool same_position(const double *p, const double *q) {
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Whether j represents i's position before i does: heavier, or as heavy and earlier. */
static bool is_duplicate(const double *p, const double *w, size_t n, size_t i) {
    for (size_t j = 0; j < n; j++) {
        if (j == i || !same_position(p + 3 * i, p + 3 * j)) continue;
        double wi = w ? w[i] : 0, wj = w ? w[j] : 0;
        if (wj > wi || (wj == wi && j < i)) return true;
    }
    return false;
}

static bool empty_sphere(const double *p, const double *w, size_t n, const size_t q[4]) {
    for (size_t e = 0; e < n; e++) {
        if (e == q[0] || e == q[1] || e == q[2] || e == q[3] || is_duplicate(p, w, n, e)) continue;
        double five[5] = {0};
        if (w)
            for (int i = 0; i < 5; i++) five[i] = w[i < 4 ? q[i] : e];
        if (brio_insphere_perturbed(p + 3 * q[0], p + 3 * q[1], p + 3 * q[2], p + 3 * q[3], p + 3 * e,
                                    w ? five : NULL) > 0)
            return false;
    }
    return true;
}

static void brute_force(const double *p, const double *w, size_t n, brute *b) {
    memset(b, 0, sizeof *b);
    size_t q[4];
    for (q[0] = 0; q[0] < n; q[0]++)
        for (q[1] = q[0] + 1; q[1] < n; q[1]++)
            for (q[2] = q[1] + 1; q[2] < n; q[2]++)
                for (q[3] = q[2] + 1; q[3] < n; q[3]++) {
                    size_t t[4] = {q[0], q[1], q[2], q[3]};
                    int sign = brio_orient3d(p + 3 * t[0], p + 3 * t[1], p + 3 * t[2], p + 3 * t[3]);
                    if (sign == 0) continue;
                    if (sign < 0) t[0] = q[1], t[1] = q[0];
                    bool duplicate = false;
                    for (int i = 0; i < 4; i++) duplicate |= is_duplicate(p, w, n, t[i]);
                    if (duplicate || !empty_sphere(p, w, n, t)) continue;
                    b->tetrahedra++;
                    for (int i = 0; i < 4; i++) b->is_vertex[t[i]] = true;
                }
}

static double power_distance(const double *p, const double *w, size_t i, size_t v) {
    double x = p[3 * i] - p[3 * v], y = p[3 * i + 1] - p[3 * v + 1], z = p[3 * i + 2] - p[3 * v + 2];
    return x * x + y * y + z * z - (w ? w[v] : 0);
}

static int lexicographic(const double *p, const double *q) {
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Representatives by their definition. Small integers: exact in doubles. */
static void expect_representatives(const double *p, const double *w, size_t n, const brio_triangulation *t) {
    const uint32_t *r = brio_triangulation_representatives(t);
    for (size_t i = 0; i < n; i++) {
        if (r[i] == i) continue;
        for (size_t v = 0; v < n; v++) {
            if (r[v] != v) continue;
            double d = power_distance(p, w, i, v), best = power_distance(p, w, i, r[i]);
            EXPECT(!same_position(p + 3 * i, p + 3 * v) || r[i] == v, "duplicate %zu of %zu got %u", i, v, r[i]);
            if (same_position(p + 3 * i, p + 3 * r[i])) continue;
            EXPECT(best < d || (best == d && lexicographic(p + 3 * r[i], p + 3 * v) <= 0), "%zu: %u not %zu", i, r[i],
                   v);
        }
    }
}

static void compare_with_brute_force(const double *p, const double *w, size_t n, uint64_t trial) {
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brute b;
    EXPECT(brio_delaunay(ctx, p, w, n, NULL, &t) == BRIO_OK);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    EXPECT(brio_triangulation_check(ctx, t, p, w, n) == BRIO_OK, "trial %llu: %s", (unsigned long long)trial,
           brio_message(ctx));
    if (s->dimension == 3) {
        brute_force(p, w, n, &b);
        EXPECT(s->tetrahedra == b.tetrahedra, "trial %llu: %zu, not %zu", (unsigned long long)trial, s->tetrahedra,
               b.tetrahedra);
        for (size_t i = 0; i < n; i++) EXPECT((brio_triangulation_representatives(t)[i] == i) == b.is_vertex[i]);
    }
    expect_representatives(p, w, n, t);
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void small_grids_match_brute_force(void) {
    double p[3 * 14], w[14];
    for (uint64_t trial = 0; trial < 1500; trial++) {
        size_t n = 4 + trial % 11;
        integer_points(trial, n, 2 + (uint32_t)(trial / 11 % 3), p);
        integer_weights(trial, n, 1 + (uint32_t)(trial % 7), w);
        compare_with_brute_force(p, trial % 2 ? w : NULL, n, trial);
    }
}

/* --- what must not matter --- */

static uint64_t checksum_of(brio_context *ctx, const double *p, const double *w, size_t n, const trial_options *o) {
    brio_triangulation *t;
    uint64_t sum = 0;
    EXPECT(trial_delaunay(ctx, p, w, n, o, &t, NULL) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_triangulation_checksum(ctx, t, p, &sum) == BRIO_OK);
    brio_triangulation_free(t);
    return sum;
}

static void expect_one_answer(const double *p, const double *w, size_t n) {
    static double q[3 * MOST], v[MOST];
    static size_t to[MOST];
    brio_context *ctx = new_context();
    uint64_t sum = checksum_of(ctx, p, w, n, NULL);
    for (int order = 0; order < TRIAL_ORDERS; order++) {
        trial_options o = {0};
        o.order = order;
        o.block_size = 64; /* many blocks, also of few points */
        o.seed = 5;
        EXPECT(checksum_of(ctx, p, w, n, &o) == sum, "order %d", order);
    }
    shuffle_points(3, n, p, q, to);
    for (size_t i = 0; w && i < n; i++) v[to[i]] = w[i];
    EXPECT(checksum_of(ctx, q, w ? v : NULL, n, NULL) == sum, "shuffled");
    for (size_t i = 0; i < 3 * n; i++) q[i] = p[i] * 0x1p-30;
    for (size_t i = 0; w && i < n; i++) v[i] = w[i] * 0x1p-60;
    EXPECT(checksum_of(ctx, q, w ? v : NULL, n, NULL) == sum, "scaled");
    brio_context_free(ctx);
}

static void order_shuffle_and_scale_do_not_matter(void) {
    static double p[3 * MOST], w[MOST];
    integer_points(1, 2000, 12, p);
    integer_weights(1, 2000, 9, w);
    expect_one_answer(p, NULL, 2000);
    expect_one_answer(p, w, 2000);
    uniform_points(2, 3000, p);
    for (size_t i = 0; i < 3000; i++) w[i] = 0.01 * p[(7 * i) % 3000];
    expect_one_answer(p, NULL, 3000);
    expect_one_answer(p, w, 3000);
    sphere_points(3, 1500, p);
    expect_one_answer(p, NULL, 1500);
    clustered_points(4, 2000, p);
    expect_one_answer(p, NULL, 2000);
    depth_points(5, 50, p);
    expect_one_answer(p, NULL, 2500);
    for (size_t i = 0; i < 2500; i++) w[i] = 1e-4 * p[(7 * i) % 2500];
    expect_one_answer(p, w, 2500);
}

static void nothing_matters_on_a_scan_either(void) {
    static double w[MOST];
    brio_context *ctx = new_context();
    brio_mesh *scan;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, 2500, NULL, &scan) == BRIO_OK && scan->num_vertices < MOST);
    for (size_t i = 0; i < scan->num_vertices; i++) w[i] = ldexp((double)(i * 7919 % 1000), -20);
    expect_one_answer(scan->vertices, NULL, scan->num_vertices);
    expect_one_answer(scan->vertices, w, scan->num_vertices);
    brio_mesh_free(scan);
    brio_context_free(ctx);
}

static void equal_weights_change_nothing(void) {
    static double p[3 * 1000], w[1000];
    brio_context *ctx = new_context();
    integer_points(9, 1000, 8, p);
    for (size_t i = 0; i < 1000; i++) w[i] = 42;
    EXPECT(checksum_of(ctx, p, NULL, 1000, NULL) == checksum_of(ctx, p, w, 1000, NULL));
    brio_context_free(ctx);
}

static void output_order_repeats(void) {
    static double p[3 * 2000];
    brio_context *ctx = new_context();
    uniform_points(5, 2000, p);
    brio_triangulation *s, *t;
    EXPECT(brio_delaunay(ctx, p, NULL, 2000, NULL, &s) == BRIO_OK);
    EXPECT(brio_delaunay(ctx, p, NULL, 2000, NULL, &t) == BRIO_OK);
    size_t bytes =
        sizeof(brio_tetrahedron) * (brio_triangulation_stats(s)->tetrahedra + brio_triangulation_stats(s)->hull_facets);
    EXPECT(!memcmp(brio_triangulation_tetrahedra(s), brio_triangulation_tetrahedra(t), bytes));
    brio_triangulation_free(s);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

/* --- large cavities and hidden points in them --- */

static void many_points_hidden_at_once(void) {
    /* a heavy point in the middle, last in the input, swallows a whole grid but the points on its hull */
    static double p[3 * 1001], w[1001];
    for (size_t i = 0; i < 1000; i++) {
        p[3 * i] = (double)(i % 10), p[3 * i + 1] = (double)(i / 10 % 10), p[3 * i + 2] = (double)(i / 100);
        w[i] = 0;
    }
    p[3000] = p[3001] = p[3002] = 4.5;
    w[1000] = 1000;
    brio_delaunay_options o = {0};
    o.order = BRIO_ORDER_INPUT;
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, w, 1001, &o, &t) == BRIO_OK);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    EXPECT(s->vertices == 489 && s->hidden == 512 && s->tetrahedra == 972, "%zu %zu %zu", s->vertices, s->hidden,
           s->tetrahedra);
    EXPECT(brio_triangulation_check(ctx, t, p, w, 1001) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

static void star_of_a_sphere_uses_the_hash_table(void) {
    /* the centre, inserted last, sees the whole hull of points on a sphere: a border of 3000 facets */
    static double p[3 * 1501];
    sphere_points(11, 1500, p);
    p[4500] = p[4501] = p[4502] = 0.001;
    brio_delaunay_options o = {0};
    o.order = BRIO_ORDER_INPUT;
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, NULL, 1501, &o, &t) == BRIO_OK);
    EXPECT(brio_triangulation_check(ctx, t, p, NULL, 1501) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

static void moment_curve_is_quadratic_and_right(void) {
    static double p[3 * 120];
    for (size_t i = 0; i < 120; i++) {
        double s = (double)i;
        p[3 * i] = s, p[3 * i + 1] = s * s, p[3 * i + 2] = s * s * s;
    }
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, NULL, 120, NULL, &t) == BRIO_OK);
    EXPECT(brio_triangulation_check(ctx, t, p, NULL, 120) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_triangulation_stats(t)->tetrahedra > 5000);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

/* --- few dimensions --- */

static void expect_flat(const double *p, const double *w, size_t n, int dimension, size_t vertices, size_t duplicates,
                        size_t hidden) {
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, w, n, NULL, &t) == BRIO_OK);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    EXPECT(s->dimension == dimension && s->vertices == vertices && s->duplicates == duplicates && s->hidden == hidden &&
               s->tetrahedra == 0 && s->hull_facets == 0,
           "dimension %d: %zu vertices, %zu duplicates, %zu hidden", s->dimension, s->vertices, s->duplicates,
           s->hidden);
    EXPECT(brio_triangulation_check(ctx, t, p, w, n) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

static void flat_inputs_are_answered(void) {
    const double same[15] = {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3};
    const double line[15] = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 1, 1, 1};
    const double plane[15] = {0, 0, 5, 1, 0, 5, 0, 1, 5, 1, 1, 5, 0, 0, 5};
    const double heavy_middle[5] = {0, 9, 0, 0, 0}, rising[5] = {1, 2, 3, 4, 5};
    expect_flat(NULL, NULL, 0, -1, 0, 0, 0);
    expect_flat(same, NULL, 1, 0, 1, 0, 0);
    expect_flat(same, NULL, 5, 0, 1, 4, 0);
    expect_flat(same, rising, 5, 0, 1, 4, 0);
    expect_flat(line, NULL, 2, 1, 2, 0, 0);
    expect_flat(line, NULL, 5, 1, 4, 1, 0);
    expect_flat(line, heavy_middle, 5, 1, 3, 1, 1);
    expect_flat(plane, NULL, 3, 2, 3, 0, 0);
    expect_flat(plane, NULL, 5, 2, 4, 1, 0);
}

static void zeros_of_both_signs_coincide(void) {
    const double p[15] = {0.0, 0, 0, -0.0, 0, -0.0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, NULL, 5, NULL, &t) == BRIO_OK);
    EXPECT(brio_triangulation_stats(t)->duplicates == 1);
    EXPECT(brio_triangulation_representatives(t)[1] == 0);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

static void extreme_magnitudes_are_exact(void) {
    static double p[3 * 60];
    brio_rng rng = brio_rng_new(21);
    for (size_t i = 0; i < 180; i++) {
        double magnitude = pow(10, 300 * brio_rng_double(&rng) - 150);
        p[i] = (brio_rng_double(&rng) - 0.5) * magnitude;
    }
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, NULL, 60, NULL, &t) == BRIO_OK);
    EXPECT(brio_triangulation_stats(t)->vertices == 60);
    EXPECT(brio_triangulation_check(ctx, t, p, NULL, 60) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

/* --- refusals and limits --- */

static void bad_input_names_the_point(void) {
    double p[12] = {0, 0, 0, 1, 0, 0, 0, NAN, 0, 0, 0, INFINITY}, w[4] = {0, INFINITY, 0, 0};
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, NULL, 4, NULL, &t) == BRIO_ERR_NOT_FINITE && t == NULL);
    EXPECT(!strcmp(brio_message(ctx), "point 2: y is NaN (2 such points in all)"), "%s", brio_message(ctx));
    p[7] = 0, p[11] = 1;
    EXPECT(brio_delaunay(ctx, p, w, 4, NULL, &t) == BRIO_ERR_NOT_FINITE);
    EXPECT(!strcmp(brio_message(ctx), "point 1: weight is infinite (1 such point in all)"), "%s", brio_message(ctx));
    brio_delaunay_options o = {0};
    o.round_ratio = 1;
    EXPECT(brio_delaunay(ctx, p, NULL, 4, &o, &t) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void too_many_tetrahedra_is_a_status(void) {
    static double p[3 * 500];
    uniform_points(6, 500, p);
    brio_delaunay_options o = {0};
    o.max_tetrahedra = 1000;
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, NULL, 500, &o, &t) == BRIO_ERR_TOO_LARGE && t == NULL);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static int cancel_at(const char *stage, double fraction, void *user) {
    (void)stage;
    return fraction > *(double *)user;
}

static void cancelled_work_frees_everything(void) {
    static double p[3 * 40000];
    double limit = 0.5;
    uniform_points(6, 40000, p);
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_context_set_progress(ctx, cancel_at, &limit);
    EXPECT(brio_delaunay(ctx, p, NULL, 40000, NULL, &t) == BRIO_ERR_CANCELLED && t == NULL);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static brio_status triangulate_and_check(brio_context *ctx) {
    double p[3 * 200], w[200];
    brio_triangulation *t = NULL;
    uint64_t sum;
    integer_points(5, 200, 5, p);
    integer_weights(5, 200, 4, w);
    brio_status status = brio_delaunay(ctx, p, w, 200, NULL, &t);
    if (status == BRIO_OK) status = brio_triangulation_check(ctx, t, p, w, 200);
    if (status == BRIO_OK) status = brio_triangulation_checksum(ctx, t, p, &sum);
    if (status == BRIO_OK)
        status = brio_tetrahedra_check(ctx, p, w, 200, (const uint32_t *)brio_triangulation_tetrahedra(t), 8,
                                       brio_triangulation_stats(t)->tetrahedra, NULL);
    brio_triangulation_free(t);
    return status;
}

static brio_status triangulate_flat(brio_context *ctx) {
    double p[3 * 60], w[60];
    brio_triangulation *t = NULL;
    integer_points(5, 60, 5, p);
    integer_weights(5, 60, 4, w);
    for (int i = 0; i < 60; i++) p[3 * i + 1] = 2;
    brio_status status = brio_delaunay(ctx, p, w, 60, NULL, &t);
    if (status == BRIO_OK) status = brio_triangulation_check(ctx, t, p, w, 60);
    brio_triangulation_free(t);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(triangulate_and_check);
    expect_clean_failures(triangulate_flat);
}

static void every_memory_limit_is_a_status(void) {
    static double p[3 * 20000];
    uniform_points(6, 20000, p);
    int refused = 0;
    for (size_t limit = 1 << 16; limit < (size_t)1 << 26; limit += limit / (BRIEF_TESTS ? 3 : 8)) {
        brio_context *ctx = new_context();
        brio_triangulation *t;
        brio_context_set_memory_limit(ctx, limit);
        brio_status status = brio_delaunay(ctx, p, NULL, 20000, NULL, &t);
        EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_MEMORY && !t));
        refused += status != BRIO_OK;
        brio_triangulation_free(t);
        EXPECT(brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
    EXPECT(refused > 10);
}

/* --- the check finds faults --- */

static void check_refuses_what_is_wrong(void) {
    static double p[3 * 300];
    uniform_points(8, 300, p);
    brio_context *ctx = new_context();
    brio_triangulation *t;
    EXPECT(brio_delaunay(ctx, p, NULL, 300, NULL, &t) == BRIO_OK);
    size_t n = brio_triangulation_stats(t)->tetrahedra;
    uint32_t *v = malloc(32 * n);
    memcpy(v, brio_triangulation_tetrahedra(t), 32 * n);
    int canonical = 0;
    EXPECT(brio_tetrahedra_check(ctx, p, NULL, 300, v, 8, n, &canonical) == BRIO_OK && canonical);
    EXPECT(brio_tetrahedra_check(ctx, p, NULL, 300, v, 8, n - 1, NULL) == BRIO_ERR_CHECK); /* one missing */
    memcpy(v, v + 8, 32);
    EXPECT(brio_tetrahedra_check(ctx, p, NULL, 300, v, 8, n, NULL) == BRIO_ERR_CHECK); /* one twice */
    memcpy(v, brio_triangulation_tetrahedra(t), 32 * n);
    v[0] = 300;
    EXPECT(brio_tetrahedra_check(ctx, p, NULL, 300, v, 8, n, NULL) == BRIO_ERR_CHECK); /* out of range */
    v[0] = v[1];
    EXPECT(brio_tetrahedra_check(ctx, p, NULL, 300, v, 8, n, NULL) == BRIO_ERR_CHECK); /* flat */
    double q[900];
    memcpy(q, p, sizeof q);
    q[3 * 17] += 0.05; /* a point moved: spheres or orientations fail */
    EXPECT(brio_triangulation_check(ctx, t, q, NULL, 300) == BRIO_ERR_CHECK);
    free(v);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

/* "536870912 tetrahedra; at most 2^29" was the message of 2^29 tetrahedra. */
static void the_check_names_the_most_tetrahedra_it_takes(void) {
    const double p[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const uint32_t v[4] = {0, 1, 2, 3};
    brio_context *ctx = new_context();
    EXPECT(brio_tetrahedra_check(ctx, p, NULL, 4, v, 4, (size_t)1 << 29, NULL) == BRIO_ERR_TOO_LARGE);
    EXPECT(strstr(brio_message(ctx), "at most 2^29 - 1"), "%s", brio_message(ctx));
    brio_context_free(ctx);
}

static void other_tie_breaks_pass_but_are_not_canonical(void) {
    /* a regular octahedron: three Delaunay triangulations, one of them canonical */
    const double p[18] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    brio_context *ctx = new_context();
    int sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        uint32_t a = (uint32_t)(2 * axis), b = a + 1, ring[4] = {(a + 2) % 6, (a + 4) % 6, (a + 3) % 6, (a + 5) % 6},
                 v[16];
        int canonical = 0;
        for (uint32_t i = 0; i < 4; i++) {
            uint32_t tet[4] = {a, b, ring[i], ring[(i + 1) % 4]};
            memcpy(v + 4 * i, tet, sizeof tet);
        }
        EXPECT(brio_tetrahedra_check(ctx, p, NULL, 6, v, 4, 4, &canonical) == BRIO_OK, "%s", brio_message(ctx));
        sum += canonical;
    }
    EXPECT(sum == 1);
    brio_context_free(ctx);
}

/* Eight tetrahedra that wind twice round the z axis: closed, positive, locally Delaunay, every inner point covered
 * twice. */
static void check_refuses_space_covered_twice(void) {
    const double p[30] = {0, 0,  5, 0, 0, -5, 5,  0, 0, 0,  5,  0, -5, 0,  0,
                          0, -5, 0, 3, 4, 0,  -4, 3, 0, -3, -4, 0, 4,  -3, 0};
    uint32_t v[32];
    for (uint32_t i = 0; i < 8; i++) {
        uint32_t tet[4] = {0, 1, 2 + i, 2 + (i + 1) % 8};
        memcpy(v + 4 * i, tet, sizeof tet);
    }
    brio_context *ctx = new_context();
    EXPECT(brio_tetrahedra_check(ctx, p, NULL, 10, v, 4, 8, NULL) == BRIO_ERR_CHECK);
    EXPECT(strstr(brio_message(ctx), "overlap") != NULL, "%s", brio_message(ctx));
    brio_context_free(ctx);
}

static brio_status checked(const double *p, size_t n, const uint32_t *v, size_t tets) {
    brio_context *ctx = new_context();
    brio_status status = brio_tetrahedra_check(ctx, p, NULL, n, v, 4, tets, NULL);
    brio_context_free(ctx);
    return status;
}

/* Sets that passed once: two tetrahedra on one side of the facet that they share, a dent beside them, and every sphere
 * empty. One vertex differs from a right set. */
static void check_refuses_two_tetrahedra_on_one_side_of_their_facet(void) {
    const double p[] = {1, 2, 0, 0, 2, 1, 2, 0, 1, 2, 0, 1, 0, 1, 2, 0, 0, 0, 0, 1, 1, 0, 2, 2, 0, 1, 0};
    const double q[] = {1, 1, 1, 1, 0, 1, 0, 1, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1, 1, 1, 0, 1, 0, 0, 0, 1, 1};
    uint32_t v[] = {6, 5, 8, 2, 6, 5, 2, 4, 0, 5, 2, 8, 0, 6, 8, 2, 0, 6,
                    2, 4, 0, 1, 8, 6, 0, 1, 6, 4, 0, 7, 4, 2, 0, 7, 1, 4};
    uint32_t w[] = {4, 2, 3, 5, 4, 2, 6, 3, 4, 1, 6, 2, 4, 1, 2, 5, 0, 1, 2, 6};
    EXPECT(checked(p, 9, v, 9) == BRIO_OK && checked(q, 9, w, 5) == BRIO_OK);
    v[22] = 7;
    w[7] = 0;
    EXPECT(checked(p, 9, v, 9) == BRIO_ERR_CHECK);
    EXPECT(checked(q, 9, w, 5) == BRIO_ERR_CHECK);
}

static void check_takes_each_position_under_one_index(void) {
    const double p[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 1, 0, 0};
    uint32_t v[] = {0, 1, 2, 3, 0, 1, 2, 4}; /* points 1 and 5 coincide */
    EXPECT(checked(p, 6, v, 2) == BRIO_OK);
    v[5] = 5;
    EXPECT(checked(p, 6, v, 2) == BRIO_ERR_CHECK);
    v[1] = 5;
    EXPECT(checked(p, 6, v, 2) == BRIO_OK);
}

static void check_of_no_tetrahedra_and_of_a_short_stride(void) {
    const double p[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const uint32_t v[] = {0, 1, 2, 3};
    brio_context *ctx = new_context();
    EXPECT(checked(p, 4, v, 1) == BRIO_OK);
    EXPECT(checked(p, 4, v, 0) == BRIO_ERR_CHECK); /* the points are not in a plane */
    EXPECT(checked(p, 3, v, 0) == BRIO_OK);
    EXPECT(checked(p, 3, v, 1) == BRIO_ERR_CHECK);
    EXPECT(brio_tetrahedra_check(ctx, p, NULL, 4, v, 3, 1, NULL) == BRIO_ERR_ARGUMENT);
    brio_context_free(ctx);
}

/* Thousands of hidden points behind few vertices, scaled until squared distances are subnormal: the same
 * representatives. */
static void representatives_survive_subnormal_distances(void) {
    enum { N = 2000, OUTER = 600, INNER = 3 };
    static double p[3 * N], w[N], q[3 * N], u[N];
    brio_context *ctx = new_context();
    brio_triangulation *s, *t;
    for (int e = SHORT_TESTS ? -542 : -543; e <= -542; e++) {
        for (size_t i = 0; i < N; i++) {
            brio_rng rng = brio_rng_new(i + 5);
            double d[3], length = 0;
            for (int k = 0; k < 3; k++) d[k] = brio_rng_double(&rng) - 0.5, length += d[k] * d[k];
            for (size_t k = 0; k < 3; k++)
                p[3 * i + k] = i < INNER ? (double)(i * (3 - k)) : rint(d[k] / sqrt(length) * (i < OUTER ? 2000 : 300));
            w[i] = i < OUTER ? 0 : -ldexp(100000, -1074 - 2 * e);
            for (size_t k = 0; k < 3; k++) q[3 * i + k] = ldexp(p[3 * i + k], e);
            u[i] = ldexp(w[i], 2 * e);
        }
        EXPECT(brio_delaunay(ctx, p, w, N, NULL, &s) == BRIO_OK && brio_delaunay(ctx, q, u, N, NULL, &t) == BRIO_OK);
        EXPECT(brio_triangulation_stats(s)->hidden > N / 2);
        EXPECT(brio_triangulation_stats(s)->hidden == brio_triangulation_stats(t)->hidden);
        for (size_t i = 0; i < N; i++)
            EXPECT(brio_triangulation_representatives(s)[i] == brio_triangulation_representatives(t)[i], "2^%d: %zu", e,
                   i);
        brio_triangulation_free(s);
        brio_triangulation_free(t);
    }
    brio_context_free(ctx);
}

SUITE(test_triangulation) {
    RUN(small_grids_match_brute_force);
    RUN(order_shuffle_and_scale_do_not_matter);
    RUN(nothing_matters_on_a_scan_either);
    RUN(equal_weights_change_nothing);
    RUN(output_order_repeats);
    RUN(many_points_hidden_at_once);
    RUN(star_of_a_sphere_uses_the_hash_table);
    RUN(moment_curve_is_quadratic_and_right);
    RUN(flat_inputs_are_answered);
    RUN(zeros_of_both_signs_coincide);
    RUN(extreme_magnitudes_are_exact);
    RUN(bad_input_names_the_point);
    RUN(too_many_tetrahedra_is_a_status);
    RUN(cancelled_work_frees_everything);
    RUN(every_failed_allocation_is_a_status);
    RUN(every_memory_limit_is_a_status);
    RUN(check_refuses_what_is_wrong);
    RUN(the_check_names_the_most_tetrahedra_it_takes);
    RUN(other_tie_breaks_pass_but_are_not_canonical);
    RUN(check_refuses_space_covered_twice);
    RUN(check_refuses_two_tetrahedra_on_one_side_of_their_facet);
    RUN(check_takes_each_position_under_one_index);
    RUN(check_of_no_tetrahedra_and_of_a_short_stride);
    RUN(representatives_survive_subnormal_distances);
    return harness_end();
}
