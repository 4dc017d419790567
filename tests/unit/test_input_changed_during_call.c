/* Points, weights and queries that change while the library works: by a callback, at places that are known, and by a second
 * thread, anywhere. Whatever is written, a call returns, and what it returns can be read.
 *
 * Not under the thread sanitizer, which rightly calls the second thread's writes a data race: that is what is tested. */
#include "harness.h"
#include "order/order.h"
#include "points.h"
#include "surface_calls.h"
#include "trial.h"
#include <math.h>
#include <pthread.h>
#include <string.h>

enum { N = 200, QUERIES = 100, CALLS = BRIEF_TESTS ? 4 : 40, WRITES = BRIEF_TESTS ? 500 : 2000 };

/* What is changed: rows of three numbers, weights, and what they were. */
static struct {
    double points[3 * N], weights[N];
    uint32_t edges[2 * N];
} now, good;

static const double WILD[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 5e-324, 0.5, -3, 1e-160, 7e150};
enum { WILDS = sizeof WILD / sizeof *WILD };

static double *number_at(size_t i) {
    return i < 3 * N ? &now.points[i] : &now.weights[i - 3 * N];
}

static void write_number(size_t i, double x) {
    __atomic_store(number_at(i), &x, __ATOMIC_RELAXED);
}

static int in_plane; /* whether the points lie in the plane x = z; atomic */

static double good_number(size_t i) {
    if (i >= 3 * N) return good.weights[i - 3 * N];
    return good.points[i % 3 == 2 && __atomic_load_n(&in_plane, __ATOMIC_RELAXED) ? i - 2 : i];
}

static void restore(void) {
    for (size_t i = 0; i < 4 * N; i++) write_number(i, good_number(i));
    for (size_t i = 0; i < 2 * (size_t)N; i++) __atomic_store_n(&now.edges[i], good.edges[i], __ATOMIC_RELAXED);
}

/* A cluster: so that orders divide a cell again and again. */
static void make_good(void) {
    brio_rng rng = brio_rng_new(5);
    for (size_t i = 0; i < 3 * N; i++) good.points[i] = brio_rng_double(&rng) * (i < 3 * N / 2 ? 1 : 1e-6);
    for (size_t i = 0; i < N; i++) good.weights[i] = 0.01 * brio_rng_double(&rng);
    for (uint32_t i = 0; i < 2 * N; i++) good.edges[i] = brio_rng_below(&rng, N);
}

/* --- the calls --- */

static size_t sum; /* of what was read, so that it is read */

static brio_status space(brio_context *ctx, const double *weights, const trial_options *o) {
    brio_triangulation *t;
    brio_status status = trial_delaunay(ctx, now.points, weights, N, o, &t, NULL);
    if (status != BRIO_OK) return status;
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    for (size_t i = 0; i < s->tetrahedra + s->hull_facets; i++)
        for (int k = 0; k < 4; k++) EXPECT(tet[i].vertex[k] < N || tet[i].vertex[k] == BRIO_INFINITE);
    for (size_t i = 0; i < N; i++) EXPECT(brio_triangulation_representatives(t)[i] < N);
    status = brio_triangulation_check(ctx, t, now.points, weights, N);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_CHECK || status == BRIO_ERR_NOT_FINITE, "%s", brio_message(ctx));
    brio_triangulation_free(t);
    return BRIO_OK;
}

static brio_status delaunay(brio_context *ctx) {
    return space(ctx, NULL, NULL);
}
static brio_status regular(brio_context *ctx) {
    return space(ctx, now.weights, NULL);
}

static brio_status in_order(brio_context *ctx, int order) {
    trial_options o = {0};
    o.order = order, o.block_size = 20;
    return space(ctx, NULL, &o);
}
static brio_status octree(brio_context *ctx) {
    return in_order(ctx, TRIAL_BRIO_OCTREE);
}
static brio_status kdtree(brio_context *ctx) {
    return in_order(ctx, TRIAL_BRIO_KDTREE);
}

static brio_status traced(brio_context *ctx) {
    trial_options o = {0};
    o.locate = BRIO_LOCATION_TRACE, o.edges = now.edges, o.num_edges = N;
    return space(ctx, NULL, &o);
}

static brio_status plane_of(brio_context *ctx, const double *weights, bool flat) {
    brio_triangulation2 *t;
    brio_status status = (flat ? brio_delaunay2_flat : brio_delaunay2)(ctx, now.points, weights, N, NULL, &t);
    if (status != BRIO_OK) return status;
    const brio_delaunay2_stats *s = brio_triangulation2_stats(t);
    const brio_triangle *triangle = brio_triangulation2_triangles(t);
    for (size_t i = 0; i < s->triangles + s->hull_edges; i++)
        for (int k = 0; k < 3; k++) EXPECT(triangle[i].vertex[k] < N || triangle[i].vertex[k] == BRIO_INFINITE);
    for (size_t i = 0; i < N; i++) EXPECT(brio_triangulation2_representatives(t)[i] < N);
    status = brio_triangulation2_check(ctx, t, now.points, weights, N);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_CHECK || status == BRIO_ERR_NOT_FINITE ||
               (flat && status == BRIO_ERR_NO_ANSWER),
           "%s", brio_message(ctx));
    brio_triangulation2_free(t);
    return BRIO_OK;
}

static brio_status plane(brio_context *ctx) {
    return plane_of(ctx, NULL, false);
}
static brio_status plane_weighted(brio_context *ctx) {
    return plane_of(ctx, now.weights, false);
}
static brio_status plane_flat(brio_context *ctx) {
    return plane_of(ctx, now.weights, true);
}

static brio_status plane_queries(brio_context *ctx) {
    brio_status status;
    brio_triangulation2 *t = NULL;
    brio_locator2 *l = NULL;
    brio_diagram2 *d = NULL;
    static uint32_t found[QUERIES];
    static double values[N], out[QUERIES];
    brio_interpolation o = {0};
    o.values = values;
    status = brio_delaunay2(ctx, now.points, NULL, N, NULL, &t);
    if (status == BRIO_OK) status = brio_locator2_new(ctx, t, now.points, NULL, N, &l);
    if (status == BRIO_OK) status = brio_locator2_triangles(ctx, l, now.points, QUERIES, found);
    if (status == BRIO_OK) status = brio_locator2_least_power(ctx, l, now.points, QUERIES, found);
    if (status == BRIO_OK) status = brio_locator2_interpolate(ctx, l, now.points, QUERIES, &o, out);
    if (status == BRIO_OK) status = brio_voronoi2(ctx, t, now.points, NULL, N, &d);
    brio_diagram2_free(d);
    brio_locator2_free(l);
    brio_triangulation2_free(t);
    return status;
}

static brio_status space_queries(brio_context *ctx) {
    brio_status status;
    brio_triangulation *t = NULL;
    brio_locator *l = NULL;
    static uint32_t found[3 * QUERIES];
    static double values[N], out[QUERIES];
    brio_interpolation o = {0};
    o.values = values;
    status = brio_delaunay(ctx, now.points, NULL, N, NULL, &t);
    if (status == BRIO_OK) status = brio_locator_new(ctx, t, now.points, NULL, N, &l);
    if (status == BRIO_OK) status = brio_locator_tetrahedra(ctx, l, now.points, QUERIES, found);
    if (status == BRIO_OK) status = brio_locator_nearest(ctx, l, now.points, QUERIES, 3, found);
    if (status == BRIO_OK) status = brio_locator_interpolate(ctx, l, now.points, QUERIES, &o, out);
    brio_locator_free(l);
    brio_triangulation_free(t);
    return status;
}

static brio_status hull(brio_context *ctx) {
    brio_mesh *mesh;
    brio_status status = brio_convex_hull(ctx, now.points, N, NULL, &mesh, NULL);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < mesh->face_offsets[mesh->num_faces]; i++)
        EXPECT(mesh->face_vertices[i] < mesh->num_vertices);
    brio_mesh_free(mesh);
    return BRIO_OK;
}

static brio_status cells(brio_context *ctx) {
    const double box[6] = {-1, -1, -1, 2, 2, 2};
    brio_cells_options o = {0};
    brio_cells *out;
    o.box = box, o.vertices = 1;
    brio_status status = brio_voronoi_cells(ctx, NULL, now.points, now.weights, N, &o, &out);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < out->num_cells; i++) sum += out->site[i];
    brio_cells_free(out);
    return BRIO_OK;
}

/* Of a triangulation that is there, perhaps of other points. */
static brio_status cells_of_triangulation(brio_context *ctx) {
    const double box[6] = {-1, -1, -1, 2, 2, 2};
    brio_cells_options o = {0};
    brio_triangulation *t = NULL;
    brio_cells *out = NULL;
    o.box = box, o.vertices = 1;
    brio_status status = brio_delaunay(ctx, now.points, now.weights, N, NULL, &t);
    if (status == BRIO_OK) status = brio_voronoi_cells(ctx, t, now.points, now.weights, N, &o, &out);
    for (size_t i = 0; out && i < out->num_cells; i++) sum += out->site[i];
    brio_cells_free(out);
    brio_triangulation_free(t);
    return status;
}

static brio_status alpha(brio_context *ctx) {
    brio_triangulation *t = NULL;
    brio_alpha_complex c = {0};
    brio_status status = brio_delaunay(ctx, now.points, now.weights, N, NULL, &t);
    if (status == BRIO_OK) status = brio_alpha_values(ctx, t, now.points, now.weights, N, &c);
    for (size_t i = 0; i < c.counts[0]; i++) sum += c.simplices[0][i];
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
    return status;
}

static brio_status alpha_plane(brio_context *ctx) {
    brio_triangulation2 *t = NULL;
    brio_alpha_complex c = {0};
    brio_status status = brio_delaunay2(ctx, now.points, now.weights, N, NULL, &t);
    if (status == BRIO_OK) status = brio_alpha_values2(ctx, t, now.points, now.weights, N, &c);
    for (size_t i = 0; i < c.counts[0]; i++) sum += c.simplices[0][i];
    brio_alpha_complex_free(&c);
    brio_triangulation2_free(t);
    return status;
}

static brio_status thin(brio_context *ctx) {
    static uint8_t chosen[N];
    return brio_thin(ctx, now.points, N, 0.05, chosen, NULL);
}

static brio_status outliers(brio_context *ctx) {
    static uint8_t outlier[N];
    return brio_outliers(ctx, now.points, N, 8, NULL, outlier);
}

/* The surfaces promise nothing, but they copy their samples first. */
static brio_status labeled(brio_context *ctx) {
    brio_mesh *mesh;
    brio_status status = make_labeled(ctx, now.points, N, NULL, &mesh, NULL, NULL);
    if (status == BRIO_OK) brio_mesh_free(mesh);
    return status;
}
static brio_status crust(brio_context *ctx) {
    brio_mesh *mesh;
    brio_status status = make_crust(ctx, now.points, N, NULL, &mesh, NULL, NULL);
    if (status == BRIO_OK) brio_mesh_free(mesh);
    return status;
}
static brio_status cocone(brio_context *ctx) {
    brio_mesh *mesh;
    brio_status status = make_cocone(ctx, now.points, N, NULL, &mesh, NULL);
    if (status == BRIO_OK) brio_mesh_free(mesh);
    return status;
}

static brio_status offset(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_status status = make_offset(ctx, now.points, N, 0.1, NULL, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}

static brio_status power_shape(brio_context *ctx) {
    brio_mesh *shape = NULL, *crust = NULL;
    brio_status status = brio_power_shape(ctx, now.points, N, NULL, &shape, &crust, NULL);
    brio_mesh_free(shape);
    brio_mesh_free(crust);
    return status;
}

static const struct {
    const char *name;
    brio_status (*call)(brio_context *ctx);
    bool surface;
} CALL[] = {
    {"delaunay", delaunay, false},
    {"regular", regular, false},
    {"octree", octree, false},
    {"kdtree", kdtree, false},
    {"traced", traced, false},
    {"plane", plane, false},
    {"plane_weighted", plane_weighted, false},
    {"plane_flat", plane_flat, false},
    {"plane_queries", plane_queries, false},
    {"space_queries", space_queries, false},
    {"hull", hull, false},
    {"cells", cells, false},
    {"cells_of_triangulation", cells_of_triangulation, false},
    {"alpha", alpha, false},
    {"alpha_plane", alpha_plane, false},
    {"thin", thin, false},
    {"outliers", outliers, false},
    {"labeled", labeled, true},
    {"crust", crust, true},
    {"cocone", cocone, true},
    {"offset", offset, true},
    {"power_shape", power_shape, true},
};
enum { NUM_CALLS = sizeof CALL / sizeof *CALL };

static void begin(size_t which) {
    __atomic_store_n(&in_plane, CALL[which].call == plane_flat, __ATOMIC_RELAXED);
    restore();
}

static void expect_sane(size_t which, brio_status status, const brio_context *ctx) {
    EXPECT(status == BRIO_OK || status == BRIO_ERR_NOT_FINITE || status == BRIO_ERR_ARGUMENT ||
               status == BRIO_ERR_NO_ANSWER || status == BRIO_ERR_CANCELLED,
           "%s: %s: %s", CALL[which].name, brio_status_string(status), brio_message(ctx));
    EXPECT(brio_context_memory(ctx) == 0, "%s", CALL[which].name);
}

/* --- by a callback --- */

typedef struct {
    int left; /* calls of the callback until it writes */
    double wild;
    size_t rows;       /* what it writes to: the first of so many numbers, or all */
    const char *stage; /* where it wrote, or NULL */
} change;

static int change_now(const char *stage, double fraction, void *user) {
    change *c = user;
    (void)fraction;
    if (c->left-- != 0) return 0;
    c->stage = stage;
    for (size_t i = 0; i < c->rows; i++) write_number(i, c->wild);
    for (size_t i = 0; i < 2 * (size_t)N; i++) __atomic_store_n(&now.edges[i], UINT32_MAX, __ATOMIC_RELAXED);
    return 0;
}

/* What is no number when the points are copied is refused, though it was one when the call began. Points are copied after
 * the stages "order" of triangulations and "skip" of the hull. */
static void expect_refused(size_t which, const change *c, brio_status status) {
    bool copied_later = c->stage && (!strcmp(c->stage, "order") || !strcmp(c->stage, "skip"));
    bool read = c->rows >= 3 * N || (c->rows == 30 && CALL[which].call != hull);
    if (!copied_later || !read || isfinite(c->wild) || CALL[which].surface || CALL[which].call == cells || in_plane)
        return;
    EXPECT(status == BRIO_ERR_NOT_FINITE, "%s: %s", CALL[which].name, brio_status_string(status));
}

/* Writes at the k-th report, for each k until the call ends before it. */
static void by_a_callback(void) {
    static const size_t ROWS[] = {1, 30, 3 * N, 4 * N};
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    for (size_t which = 0; which < NUM_CALLS; which++)
        for (size_t wild = 0; wild < WILDS; wild += BRIEF_TESTS ? 9 : SHORT_TESTS ? 3 : 1) {
            change c = {-1, WILD[wild], 0, NULL};
            for (int k = 0; c.left < 0; k += BRIEF_TESTS ? 7 + k / 3 : SHORT_TESTS ? 3 + k / 8 : 1 + k / 32) {
                c.left = k, c.stage = NULL, c.rows = ROWS[(wild + (size_t)k) % (sizeof ROWS / sizeof *ROWS)];
                brio_context_set_progress(ctx, change_now, &c);
                begin(which);
                brio_status status = CALL[which].call(ctx);
                expect_sane(which, status, ctx);
                expect_refused(which, &c, status);
            }
        }
    brio_context_free(ctx);
}

/* --- by a second thread --- */

static int stopped;
static size_t writes;

/* Writes a wild number somewhere, and soon afterwards the good one again, so that calls pass their first look at it. */
static void *scribble(void *user) {
    brio_rng rng = brio_rng_new(*(const uint64_t *)user);
    while (!__atomic_load_n(&stopped, __ATOMIC_RELAXED)) {
        size_t i = brio_rng_below(&rng, 4 * N), edge = brio_rng_below(&rng, 2 * N);
        write_number(i, WILD[brio_rng_below(&rng, WILDS)]);
        __atomic_fetch_add(&writes, 1, __ATOMIC_RELAXED);
        __atomic_store_n(&now.edges[edge], UINT32_MAX, __ATOMIC_RELAXED);
        for (uint32_t wait = brio_rng_below(&rng, 400); wait; wait--) __atomic_signal_fence(__ATOMIC_SEQ_CST);
        write_number(i, good_number(i));
        __atomic_store_n(&now.edges[edge], good.edges[edge], __ATOMIC_RELAXED);
        for (uint32_t wait = brio_rng_below(&rng, 4000); wait; wait--) __atomic_signal_fence(__ATOMIC_SEQ_CST);
    }
    return NULL;
}

static void by_a_second_thread(void) {
    pthread_t thread;
    uint64_t seed = 7;
    begin(0);
    EXPECT(pthread_create(&thread, NULL, scribble, &seed) == 0);
    for (size_t which = 0; which < NUM_CALLS; which++)
        for (int threads = 1; threads <= 3; threads += BRIEF_TESTS ? 2 : 1) {
            brio_context *ctx;
            size_t fine = 0;
            begin(which);
            EXPECT(brio_context_new(NULL, &ctx) == BRIO_OK);
            brio_context_set_threads(ctx, threads);
            size_t n = 0, before = __atomic_load_n(&writes, __ATOMIC_RELAXED), written = 0;
            for (; n < CALLS || (written < WRITES && n < (BRIEF_TESTS ? 10 : 50) * CALLS); n++) {
                brio_status status = CALL[which].call(ctx);
                expect_sane(which, status, ctx);
                fine += status == BRIO_OK;
                written = __atomic_load_n(&writes, __ATOMIC_RELAXED) - before;
            }
            brio_context_free(ctx);
            if (threads == 1)
                fprintf(stderr, "%s: %zu of %zu calls had a result, during %zu writes\n", CALL[which].name, fine, n,
                        written);
        }
    __atomic_store_n(&stopped, 1, __ATOMIC_RELAXED);
    pthread_join(thread, NULL);
}

/* --- orders --- */

enum { MANY = 20000 };
static double many[3 * MANY];

/* Moves points to and fro all the time. */
static void *move_points(void *user) {
    brio_rng rng = brio_rng_new(*(const uint64_t *)user);
    while (!__atomic_load_n(&stopped, __ATOMIC_RELAXED)) {
        double x = WILD[brio_rng_below(&rng, WILDS)], y = brio_rng_double(&rng);
        size_t i = brio_rng_below(&rng, 3 * MANY);
        if (brio_rng_below(&rng, 100)) x = y;
        __atomic_store(&many[i], &x, __ATOMIC_RELAXED);
        __atomic_fetch_add(&writes, 1, __ATOMIC_RELAXED);
    }
    return NULL;
}

static void expect_permutation(brio_context *ctx, int order) {
    static uint32_t found[MANY];
    static uint8_t seen[MANY];
    trial_options o = {0};
    size_t twice = 0;
    o.order = order, o.block_size = 50;
    EXPECT(trial_order(ctx, &(brio_input){many, NULL, MANY}, &o, found, NULL, NULL, NULL) == BRIO_OK);
    memset(seen, 0, sizeof seen);
    for (size_t i = 0; i < MANY; i++) {
        EXPECT(found[i] < MANY, "order %d", order);
        if (found[i] < MANY) twice += seen[found[i]]++;
    }
    EXPECT(twice == 0, "order %d: %zu points come twice", order, twice);
}

static void orders_stay_permutations(void) {
    pthread_t thread;
    uint64_t seed = 11;
    brio_context *ctx = new_context();
    __atomic_store_n(&stopped, 0, __ATOMIC_RELAXED);
    EXPECT(pthread_create(&thread, NULL, move_points, &seed) == 0);
    for (int order = 0; order < TRIAL_ORDERS; order++)
        for (int threads = 1; threads <= 3; threads += BRIEF_TESTS ? 2 : 1) {
            size_t before = __atomic_load_n(&writes, __ATOMIC_RELAXED), written = 0;
            brio_context_set_threads(ctx, threads);
            for (int n = 0; n < 5 || (written < 100 * WRITES && n < 60); n++) {
                expect_permutation(ctx, order);
                written = __atomic_load_n(&writes, __ATOMIC_RELAXED) - before;
            }
        }
    __atomic_store_n(&stopped, 1, __ATOMIC_RELAXED);
    pthread_join(thread, NULL);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- what a triangulation knows of its points --- */

static void points_hash_is_that_of_the_points(void) {
    brio_context *ctx;
    brio_triangulation *t;
    brio_triangulation2 *t2;
    brio_locator *l;
    double p[3 * N];
    restore();
    memcpy(p, good.points, sizeof p);
    p[7] = 0;
    EXPECT(brio_context_new(NULL, &ctx) == BRIO_OK);
    for (int threads = 1; threads <= 3; threads += BRIEF_TESTS ? 2 : 1) {
        brio_context_set_threads(ctx, threads);
        EXPECT(brio_delaunay(ctx, p, good.weights, N, NULL, &t) == BRIO_OK);
        EXPECT(brio_delaunay2(ctx, p, NULL, N, NULL, &t2) == BRIO_OK);
        EXPECT(brio_triangulation_points_hash(t) == brio_points_hash(p, good.weights, N, 3));
        EXPECT(brio_triangulation2_points_hash(t2) == brio_points_hash(p, NULL, N, 2));
        p[7] = -0.0;
        EXPECT(brio_triangulation_points_hash(t) == brio_points_hash(p, good.weights, N, 3));
        EXPECT(brio_triangulation_points_hash(t) != brio_points_hash(p, NULL, N, 3));
        p[7] = 1;
        EXPECT(brio_locator_new(ctx, t, p, good.weights, N, &l) == BRIO_ERR_ARGUMENT);
        EXPECT(strstr(brio_message(ctx), "not those of the triangulation") != NULL, "%s", brio_message(ctx));
        p[7] = 0;
        EXPECT(brio_locator_new(ctx, t, p, good.weights, N, &l) == BRIO_OK);
        brio_locator_free(l);
        brio_triangulation_free(t);
        brio_triangulation2_free(t2);
    }
    double swapped[6] = {1, 2, 3, 4, 5, 6}, other[6] = {4, 5, 6, 1, 2, 3}, mirrored[6] = {-1, -2, 3, 4, 5, 6};
    EXPECT(brio_points_hash(swapped, NULL, 2, 3) != brio_points_hash(other, NULL, 2, 3));
    EXPECT(brio_points_hash(swapped, NULL, 2, 3) != brio_points_hash(mirrored, NULL, 2, 3));
    brio_context_free(ctx);
}

SUITE(test_input_changed_during_call) {
    make_good();
    RUN(points_hash_is_that_of_the_points);
    RUN(by_a_callback);
    RUN(by_a_second_thread);
    RUN(orders_stay_permutations);
    return harness_end() || sum == SIZE_MAX;
}
