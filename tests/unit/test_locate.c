/* Queries of a locator against brute force: ties, hostile points, weights, every dimension. With file names: the points
 * of these files, too. BRIO_LOCATE_QUERIES sets the number of queries of each set. */
#include "failing_allocator.h"
#include "locate_brute.h"
#include "points.h"

enum { MOST = 1200, QUERIES_A_FILE = 60 };

static size_t queries_a_set = BRIEF_TESTS ? 120 : 600;

/* --- queries that make ties --- */

static void make_query(brio_rng *rng, const double *p, size_t n, const double box[6], double *x) {
    uint32_t kind = brio_rng_below(rng, 6);
    size_t chosen[4];
    for (int i = 0; i < 4; i++) chosen[i] = brio_rng_below(rng, (uint32_t)n);
    for (size_t k = 0; k < 3; k++) {
        double low = box[k], high = box[3 + k], extent = high - low;
        if (kind == 0)
            x[k] = p[3 * chosen[0] + k];
        else if (kind == 1)
            x[k] = 0.5 * p[3 * chosen[0] + k] + 0.5 * p[3 * chosen[1] + k];
        else if (kind == 2)
            x[k] = 0.25 * p[3 * chosen[0] + k] + 0.25 * p[3 * chosen[1] + k] + 0.5 * p[3 * chosen[2] + k];
        else if (kind == 3)
            x[k] = floor(low + (brio_rng_double(rng) * 1.5 - 0.25) * extent);
        else
            x[k] = low + (kind == 4 ? brio_rng_double(rng) : 3 * brio_rng_double(rng) - 1) * extent;
    }
}

static double *make_queries(uint64_t seed, const double *p, size_t n, size_t count) {
    double *x = malloc(3 * count * sizeof *x), box[6];
    brio_rng rng = brio_rng_new(seed);
    for (size_t k = 0; k < 6; k++) box[k] = p[k % 3];
    for (size_t i = 0; i < 3 * n; i++) box[i % 3] = fmin(box[i % 3], p[i]), box[3 + i % 3] = fmax(box[3 + i % 3], p[i]);
    for (size_t i = 0; i < count; i++) make_query(&rng, p, n, box, x + 3 * i);
    for (size_t i = 0; i < 3 * count; i++)
        if (!isfinite(x[i])) x[i] = 0;
    return x;
}

/* --- one set --- */

typedef struct {
    const char *name;
    const double *p, *w;
    size_t n;
} set;

static void expect_tetrahedra(brio_context *ctx, const set *s, const brio_triangulation *t, const brio_locator *l,
                              const double *x, size_t count) {
    uint32_t *found = malloc(count * sizeof *found);
    EXPECT(brio_locator_tetrahedra(ctx, l, x, count, found) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < count; i++) {
        uint32_t right = brute_tetrahedron(s->p, t, x + 3 * i);
        EXPECT(found[i] == right, "%s: query %zu (%a %a %a) got %u, not %u", s->name, i, x[3 * i], x[3 * i + 1],
               x[3 * i + 2], found[i], right);
    }
    free(found);
}

static void expect_nearest(brio_context *ctx, const set *s, const brio_triangulation *t, const brio_locator *l,
                           const double *x, size_t count) {
    enum { K = 5 };
    uint32_t *found = malloc(K * count * sizeof *found), *power = malloc(count * sizeof *power);
    size_t vertices = brio_triangulation_stats(t)->vertices;
    EXPECT(brio_locator_nearest(ctx, l, x, count, K, found) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_locator_least_power(ctx, l, x, count, power) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < count; i++) {
        const double at[4] = {x[3 * i], x[3 * i + 1], x[3 * i + 2], 0};
        EXPECT(number_before(s->p, s->w, t, at, power[i]) == 0, "%s: query %zu got %u", s->name, i, power[i]);
        for (size_t k = 0; k < K; k++) {
            uint32_t v = found[K * i + k];
            EXPECT((v == BRIO_INFINITE) == (k >= vertices), "%s: query %zu", s->name, i);
            if (v != BRIO_INFINITE)
                EXPECT(number_before(s->p, NULL, t, at, v) == k, "%s: query %zu, %zu", s->name, i, k);
        }
    }
    free(found);
    free(power);
}

static void check_set(const set *s) {
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_locator *l;
    double *x = make_queries(s->n, s->p, s->n, queries_a_set);
    EXPECT(brio_delaunay(ctx, s->p, s->w, s->n, NULL, &t) == BRIO_OK);
    EXPECT(brio_locator_new(ctx, t, s->p, s->w, s->n, &l) == BRIO_OK, "%s", brio_message(ctx));
    expect_tetrahedra(ctx, s, t, l, x, queries_a_set);
    expect_nearest(ctx, s, t, l, x, queries_a_set);
    expect_tetrahedra(ctx, s, t, l, x, 7); /* too few to be sorted */
    brio_locator_free(l);
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    free(x);
}

static void small_grids(void) {
    static double p[3 * MOST], w[MOST];
    for (uint64_t trial = 0; trial < 24; trial++) {
        size_t n = 1 + 9 * (size_t)trial;
        integer_points(trial, n, 2 + (uint32_t)(trial % 5), p);
        integer_weights(trial, n, 9, w);
        check_set(&(set){"grid", p, trial % 2 ? w : NULL, n});
    }
}

static void points_in_space(void) {
    static double p[3 * 400], w[400];
    uniform_points(1, 400, p);
    check_set(&(set){"uniform", p, NULL, 400});
    for (int i = 0; i < 400; i++) w[i] = p[3 * i] * p[3 * i + 1] * 0.1;
    check_set(&(set){"uniform, weighted", p, w, 400});
    clustered_points(2, 400, p);
    check_set(&(set){"clusters", p, NULL, 400});
    sphere_points(3, 200, p);
    check_set(&(set){"sphere", p, NULL, 200});
    for (int i = 0; i < 600; i++) p[i] *= 0x1p500;
    check_set(&(set){"large sphere", p, NULL, 200});
    for (int i = 0; i < 600; i++) p[i] *= 0x1p-1040;
    check_set(&(set){"small sphere", p, NULL, 200});
}

/* Squares of distances are rounded at a scale of the locator's own: weights beyond it, and points far out, are compared
 * exactly. */
static void ranges_beyond_the_scale_of_a_locator(void) {
    static const int exponents[] = {-1000, -530, -300, 300, 500, 1000};
    static double p[3 * 100], w[100];
    size_t usual = queries_a_set;
    queries_a_set = BRIEF_TESTS ? 15 : 60;
    for (int k = 0; k < 6; k++) {
        uniform_points(1, 100, p);
        for (int i = 0; i < 100; i++) w[i] = p[3 * i] * p[3 * i + 1] * 0.1;
        for (int i = 0; i < 300; i++) p[i] = ldexp(p[i], exponents[k]);
        check_set(&(set){"weights near 1", p, w, 100});
        for (int i = 0; i < 100; i++) w[i] = ldexp(w[i], exponents[k] < 500 ? 2 * exponents[k] : 1000);
        check_set(&(set){"weights at the scale", p, w, 100});
        p[0] = 0x1p1023, p[7] = -0x1p1000;
        check_set(&(set){"points far out", p, k % 2 ? w : NULL, 100});
    }
    queries_a_set = usual;
}

static void flat_points(void) {
    static double p[3 * 100], w[100];
    for (int dimension = 0; dimension < 3; dimension++) {
        integer_points(7, 100, 6, p);
        integer_weights(7, 100, 5, w);
        for (int i = 0; i < 300; i++)
            if (i % 3 >= dimension) p[i] = 2;
        check_set(&(set){"flat", p, dimension == 1 ? w : NULL, 100});
    }
}

/* --- what must not matter --- */

static void neither_threads_nor_order_change_an_answer(void) {
    enum { N = 3000, Q = 5000 };
    double *p = malloc(3 * N * sizeof *p), *shuffled = malloc(3 * Q * sizeof *shuffled);
    uint32_t *one = malloc(Q * sizeof *one), *four = malloc(Q * sizeof *four), *near = malloc(2 * Q * sizeof *near);
    size_t *to = malloc(Q * sizeof *to);
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_locator *l;
    integer_points(5, N, 24, p);
    double *x = make_queries(1, p, N, Q);
    shuffle_points(9, Q, x, shuffled, to);
    EXPECT(brio_delaunay(ctx, p, NULL, N, NULL, &t) == BRIO_OK);
    EXPECT(brio_locator_new(ctx, t, p, NULL, N, &l) == BRIO_OK);
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_locator_tetrahedra(ctx, l, x, Q, one) == BRIO_OK);
    EXPECT(brio_locator_nearest(ctx, l, x, Q, 1, near) == BRIO_OK);
    brio_context_set_threads(ctx, 4);
    EXPECT(brio_locator_tetrahedra(ctx, l, shuffled, Q, four) == BRIO_OK);
    EXPECT(brio_locator_nearest(ctx, l, shuffled, Q, 1, near + Q) == BRIO_OK);
    for (size_t i = 0; i < Q; i++) {
        EXPECT(one[i] == four[to[i]], "%zu: %u, %u", i, one[i], four[to[i]]);
        EXPECT(near[i] == near[Q + to[i]], "%zu: %u, %u", i, near[i], near[Q + to[i]]);
    }
    brio_locator_free(l);
    brio_triangulation_free(t);
    brio_context_free(ctx);
    free(p), free(x), free(shuffled), free(one), free(four), free(near), free(to);
}

static void values_have_the_same_bits_in_every_order(void) {
    enum { N = 400, Q = 1500 };
    static double p[3 * N], shuffled[3 * Q], one[Q], four[Q];
    static size_t to[Q];
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_locator *l;
    integer_points(6, N, 8, p);
    double *x = make_queries(2, p, N, Q);
    shuffle_points(3, Q, x, shuffled, to);
    EXPECT(brio_delaunay(ctx, p, NULL, N, NULL, &t) == BRIO_OK);
    EXPECT(brio_locator_new(ctx, t, p, NULL, N, &l) == BRIO_OK);
    for (int method = 0; method < 2; method++) {
        brio_interpolation o = {0};
        o.method = (brio_interpolation_method)method;
        o.values = p + N; /* any numbers */
        brio_context_set_threads(ctx, 1);
        EXPECT(brio_locator_interpolate(ctx, l, x, Q, &o, one) == BRIO_OK);
        brio_context_set_threads(ctx, 4);
        EXPECT(brio_locator_interpolate(ctx, l, shuffled, Q, &o, four) == BRIO_OK);
        for (size_t i = 0; i < Q; i++)
            EXPECT(!memcmp(&one[i], &four[to[i]], sizeof *one), "%zu: %.17g, %.17g", i, one[i], four[to[i]]);
    }
    brio_locator_free(l);
    brio_triangulation_free(t);
    brio_context_free(ctx);
    free(x);
}

/* --- refusals --- */

static void bad_input_is_refused(void) {
    double p[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, x[6] = {0, 0, 0, 0, NAN, 0}, value;
    uint32_t found[2];
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_locator *l;
    EXPECT(brio_delaunay(ctx, p, NULL, 5, NULL, &t) == BRIO_OK);
    EXPECT(brio_locator_new(ctx, t, p, NULL, 4, &l) == BRIO_ERR_ARGUMENT && !l);
    EXPECT(brio_locator_new(ctx, t, p, NULL, 5, &l) == BRIO_OK);
    EXPECT(brio_locator_tetrahedra(ctx, l, x, 2, found) == BRIO_ERR_NOT_FINITE);
    EXPECT(!strcmp(brio_message(ctx), "query 1: y is NaN"), "%s", brio_message(ctx));
    EXPECT(brio_locator_nearest(ctx, l, x, 1, 0, found) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_locator_interpolate(ctx, l, x, 1, NULL, &value) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_locator_tetrahedra(ctx, l, NULL, 0, NULL) == BRIO_OK);
    brio_locator_free(l);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

/* Room for `count` vertices was taken though there are five, and for no query at all. */
static void more_vertices_wanted_than_there_are_take_no_memory(void) {
    enum { WANTED = 1 << 20 };
    static uint32_t found[WANTED];
    const double p[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, x[3] = {0.9, 0.9, 0.9};
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_locator *l;
    EXPECT(brio_delaunay(ctx, p, NULL, 5, NULL, &t) == BRIO_OK && brio_locator_new(ctx, t, p, NULL, 5, &l) == BRIO_OK);
    brio_context_set_memory_limit(ctx, brio_context_memory(ctx) + 100000);
    EXPECT(brio_locator_nearest(ctx, l, NULL, 0, UINT32_MAX, NULL) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_locator_nearest(ctx, l, x, 1, WANTED, found) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(found[0] == 4 && found[4] != BRIO_INFINITE && found[5] == BRIO_INFINITE &&
           found[WANTED - 1] == BRIO_INFINITE);
    EXPECT(brio_locator_nearest(ctx, l, NULL, 0, 0, NULL) == BRIO_ERR_ARGUMENT);
    brio_locator_free(l);
    brio_triangulation_free(t);
    brio_context_set_memory_limit(ctx, 0);
    EXPECT(brio_delaunay(ctx, NULL, NULL, 0, NULL, &t) == BRIO_OK);
    EXPECT(brio_locator_new(ctx, t, NULL, NULL, 0, &l) == BRIO_OK);
    EXPECT(brio_locator_nearest(ctx, l, x, 1, WANTED, found) == BRIO_OK && found[0] == BRIO_INFINITE);
    brio_locator_free(l);
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

static brio_status query_everything(brio_context *ctx) {
    static double p[3 * 200], x[3 * 100], results[100];
    static uint32_t found[300];
    brio_triangulation *t = NULL;
    brio_locator *l = NULL;
    brio_interpolation o = {0};
    brio_incidences lists = {0};
    brio_edges edges = {0};
    uniform_points(4, 200, p);
    uniform_points(5, 100, x);
    o.values = p;
    o.components = 1;
    brio_status status = brio_delaunay(ctx, p, NULL, 200, NULL, &t);
    if (status == BRIO_OK) status = brio_locator_new(ctx, t, p, NULL, 200, &l);
    if (status == BRIO_OK) status = brio_locator_tetrahedra(ctx, l, x, 100, found);
    if (status == BRIO_OK) status = brio_locator_nearest(ctx, l, x, 100, 3, found);
    if (status == BRIO_OK) status = brio_locator_interpolate(ctx, l, x, 100, &o, results);
    if (status == BRIO_OK) status = brio_triangulation_neighbours(ctx, t, &lists);
    brio_incidences_free(&lists);
    if (status == BRIO_OK) status = brio_triangulation_edges(ctx, t, &edges);
    if (edges.ends) brio_edges_free(&edges);
    brio_locator_free(l);
    brio_triangulation_free(t);
    return status;
}

static void memory_may_run_out_anywhere(void) {
    expect_clean_failures(query_everything);
}

static void check_file(const char *path) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    EXPECT(brio_read(ctx, path, NULL, &mesh) == BRIO_OK, "%s", brio_message(ctx));
    const char *slash = strrchr(path, '/');
    if (mesh && mesh->num_vertices && mesh->num_vertices <= MOST)
        check_set(&(set){slash ? slash + 1 : path, mesh->vertices, NULL, mesh->num_vertices});
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

SUITE(test_locate) {
    if (argc > 1) queries_a_set = QUERIES_A_FILE;
    if (getenv("BRIO_LOCATE_QUERIES")) queries_a_set = (size_t)atol(getenv("BRIO_LOCATE_QUERIES"));
    for (int i = 1; i < argc; i++) check_file(argv[i]);
    if (argc > 1) return harness_end();
    RUN_ALONE(small_grids);
    RUN_ALONE(points_in_space);
    RUN_ALONE(ranges_beyond_the_scale_of_a_locator);
    RUN_ALONE(flat_points);
    RUN(neither_threads_nor_order_change_an_answer);
    RUN(values_have_the_same_bits_in_every_order);
    RUN_ALONE(bad_input_is_refused);
    RUN_ALONE(more_vertices_wanted_than_there_are_take_no_memory);
    RUN_ALONE(memory_may_run_out_anywhere);
    return harness_end();
}
