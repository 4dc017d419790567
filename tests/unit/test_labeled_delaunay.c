/* The labeled Delaunay triangulation: closed, manifold and oriented on anything, the right topology on dense samples, with
 * noise too, and the same surface for every order and number of threads. */
#include "base/rng.h"
#include "failing_allocator.h"
#include "harness.h"
#include "known_surfaces.h"
#include "points.h"
#include "reconstruct/labeled_delaunay/vote_weight.h"
#include "same_faces.h"
#include "surface_calls.h"
#include <math.h>
#include <string.h>

enum { MANY = 6000 };

static brio_context *context_of(int threads) {
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, threads);
    return ctx;
}

/* --- any input --- */

static int is_certified(brio_context *ctx, const double *p, size_t n, uint64_t trial) {
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_surface_stats s = {0};
    brio_status status = make_labeled(ctx, p, n, NULL, &mesh, NULL, &s);
    EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_ANSWER && !mesh), "trial %llu: %s", (unsigned long long)trial,
           brio_message(ctx));
    if (status != BRIO_OK) return 0;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.manifold && c.oriented && c.closed, "trial %llu: manifold %d oriented %d closed %d",
           (unsigned long long)trial, c.manifold, c.oriented, c.closed);
    EXPECT(mesh->num_vertices + s.unused == s.samples && mesh->num_faces > 0);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    return 1;
}

/* Small inputs to try. */
enum { TRIALS = BRIEF_TESTS ? 300 : SHORT_TESTS ? 2500 : 10000 };

static void small_inputs_are_closed_manifold_oriented(void) {
    double p[3 * 40];
    int surfaces = 0;
    brio_context *ctx = context_of(1);
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        size_t n = 4 + trial % 37;
        if (trial % 3 == 0)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 3 + (uint32_t)(trial % 3), p);
        surfaces += is_certified(ctx, p, n, trial);
    }
    EXPECT(surfaces > TRIALS / 2, "%d", surfaces);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void points_without_a_surface_are_closed_manifold_oriented(void) {
    static double p[3 * 20000];
    brio_context *ctx = context_of(1);
    const size_t n = BRIEF_TESTS ? 8000 : 20000;
    uniform_points(5, n, p);
    is_certified(ctx, p, n, 0);
    integer_points(6, n, BRIEF_TESTS ? 10 : 14, p);
    is_certified(ctx, p, n, 1);
    brio_context_free(ctx);
}

static void inputs_without_a_solid_say_so(void) {
    const double three[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, flat[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, .5, .5, 0};
    const double bad[9] = {0, 0, 0, 1, NAN, 0, 0, 1, INFINITY};
    brio_context *ctx = context_of(1);
    brio_surface_options o = LABELED_OPTIONS;
    brio_mesh *mesh;
    EXPECT(make_labeled(ctx, NULL, 0, NULL, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_labeled(ctx, three, 3, NULL, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_labeled(ctx, flat, 5, NULL, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(make_labeled(ctx, bad, 3, NULL, &mesh, NULL, NULL) == BRIO_ERR_NOT_FINITE && !mesh);
    o.noise = (brio_noise)77;
    EXPECT(make_labeled(ctx, flat, 5, &o, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- known surfaces --- */

static void expect_genus(const double *p, size_t n, int64_t genus, int smoothed) {
    brio_context *ctx = context_of(1);
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_surface_stats s = {0};
    EXPECT(make_labeled(ctx, p, n, NULL, &mesh, NULL, &s) == BRIO_OK, "%s", brio_message(ctx));
    if (mesh) {
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
        EXPECT(c.closed && c.components == 1 && c.genus == genus && c.volume > 0, "%zu components, genus %lld",
               c.components, (long long)c.genus);
        EXPECT((int)s.smoothed == smoothed, "noise %g", s.noise);
        EXPECT(s.samples == n && (smoothed || s.unused == 0), "%zu unused", s.unused);
        brio_certificate_free(&c);
    }
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

static void known_surfaces_have_their_genus(void) {
    const known_surface *all[] = {&known_sphere, &known_torus, &known_plate};
    static double random[3 * MANY];
    for (int i = 0; i < 3; i++) {
        size_t n;
        double *p = all[i]->sample(2.5 * all[i]->r, 7, &n);
        expect_genus(p, n, all[i]->genus, 0);
        free(p);
    }
    torus_points(1, MANY, random);
    expect_genus(random, MANY, 1, 0);
}

/* Noise of 0.3 spacings in each coordinate: the genus is right, and the vertices are nearer to the surface. */
static void noise_is_seen_and_reduced(void) {
    static double p[3 * MANY], noisy[3 * MANY];
    const double spacing = 0.9 * sqrt(4 * 3.141592653589793 / MANY);
    brio_rng rng = brio_rng_new(3);
    brio_context *ctx = context_of(1);
    brio_mesh *mesh;
    double before = 0, after = 0;
    sphere_points(1, MANY, p);
    for (size_t i = 0; i < 3 * MANY; i++) {
        double sum = -6;
        for (int k = 0; k < 12; k++) sum += brio_rng_double(&rng);
        noisy[i] = p[i] + 0.3 * spacing * sum;
    }
    expect_genus(noisy, MANY, 0, 1);
    EXPECT(make_labeled(ctx, noisy, MANY, NULL, &mesh, NULL, NULL) == BRIO_OK);
    for (size_t i = 0; i < MANY; i++) before += fabs(sphere_value(noisy + 3 * i)) / MANY;
    for (size_t v = 0; v < mesh->num_vertices; v++)
        after += fabs(sphere_value(mesh->vertices + 3 * v)) / (double)mesh->num_vertices;
    EXPECT(after < before / 2, "mean distance from the sphere: %g, then %g", before, after);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* A wall of two spacings: neither vanishes nor is punched through. */
static void a_thin_wall_stays(void) {
    enum { SIDE = 40 };
    static double p[3 * 8 * SIDE * SIDE];
    size_t n = 0;
    brio_rng rng = brio_rng_new(5);
    for (int i = 0; i <= SIDE; i++)
        for (int j = 0; j <= SIDE; j++)
            for (int k = 0; k <= 2; k++) {
                bool rim = i == 0 || j == 0 || i == SIDE || j == SIDE;
                if (k == 1 && !rim) continue;
                double jitter[3];
                for (int c = 0; c < 3; c++) jitter[c] = 0.3 * (brio_rng_double(&rng) - 0.5);
                p[n++] = i + (i > 0 && i < SIDE ? jitter[0] : 0);
                p[n++] = j + (j > 0 && j < SIDE ? jitter[1] : 0);
                p[n++] = k;
            }
    expect_genus(p, n / 3, 0, 0);
}

/* --- what must not matter --- */

static brio_mesh *surface_of(const double *p, size_t n, int threads, uint32_t *samples) {
    brio_context *ctx = context_of(threads);
    brio_mesh *mesh;
    EXPECT(make_labeled(ctx, p, n, NULL, &mesh, samples, NULL) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        EXPECT(v == 0 || samples[v] > samples[v - 1]);
        EXPECT(!memcmp(mesh->vertices + 3 * v, p + 3 * (size_t)samples[v], 24));
    }
    for (size_t c = 0; c < 3 * mesh->num_faces; c++) mesh->face_vertices[c] = samples[mesh->face_vertices[c]];
    return mesh; /* its context lives on with it: it is freed by free_surface */
}

static void free_surface(brio_mesh *mesh) {
    brio_context *ctx = mesh->context;
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void order_and_threads_do_not_matter(void) {
    static double p[3 * MANY], q[3 * MANY];
    static size_t to[MANY];
    static uint32_t samples[MANY];
    torus_points(9, MANY, p);
    brio_mesh *one = surface_of(p, MANY, 1, samples);
    for (int threads = 2; threads < 4; threads++) {
        brio_mesh *more = surface_of(p, MANY, threads, samples);
        expect_same_faces(one, NULL, more);
        free_surface(more);
    }
    shuffle_points(4, MANY, p, q, to);
    brio_mesh *shuffled = surface_of(q, MANY, 1, samples);
    expect_same_faces(one, to, shuffled);
    free_surface(shuffled);
    free_surface(one);
}

static void scale_and_duplicates_do_not_matter(void) {
    static double p[3 * MANY], q[6 * MANY];
    static uint32_t samples[2 * MANY];
    torus_points(2, MANY, p);
    brio_mesh *one = surface_of(p, MANY, 1, samples);
    for (size_t i = 0; i < 3 * MANY; i++) q[i] = q[3 * MANY + i] = ldexp(p[i], 300);
    brio_mesh *twice = surface_of(q, 2 * MANY, 1, samples);
    EXPECT(one->num_faces == twice->num_faces, "%zu and %zu", one->num_faces, twice->num_faces);
    free_surface(twice);
    free_surface(one);
}

/* --- parts --- */

static void log_odds_rise_with_the_cosine(void) {
    for (double noise = 0; noise < 0.3; noise += 0.05)
        for (double thick = 0.11; thick < 0.5; thick += 0.07) {
            double last = -BRIO_MOST_LOG_ODDS;
            for (double cosine = -0.975; cosine < 1; cosine += 0.05) {
                double now = brio_vote_log_odds(cosine, thick, noise);
                EXPECT(now >= last - 0.2 && now <= BRIO_MOST_LOG_ODDS, "%g at %g, %g, %g", now, cosine, thick, noise);
                last = now;
            }
            EXPECT(last > 1 && brio_vote_log_odds(-1, thick, noise) < -0.5);
        }
    EXPECT(brio_vote_log_odds(1, INFINITY, 0) == BRIO_MOST_LOG_ODDS);
    EXPECT(brio_vote_log_odds(-1, 0.12, 0) < brio_vote_log_odds(-1, 0.12, 0.2) - 2, "noise makes votes less sure");
}

static brio_status make_surface(brio_context *ctx) {
    static double p[3 * 300];
    brio_mesh *mesh;
    brio_surface_options o = LABELED_OPTIONS;
    o.noise = BRIO_NOISE_SMOOTH;
    sphere_points(1, 300, p);
    brio_status status = make_labeled(ctx, p, 300, &o, &mesh, NULL, NULL);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(make_surface);
}

SUITE(test_labeled_delaunay) {
    RUN(small_inputs_are_closed_manifold_oriented);
    RUN(points_without_a_surface_are_closed_manifold_oriented);
    RUN(inputs_without_a_solid_say_so);
    RUN(known_surfaces_have_their_genus);
    RUN(noise_is_seen_and_reduced);
    RUN(a_thin_wall_stays);
    RUN(order_and_threads_do_not_matter);
    RUN(scale_and_duplicates_do_not_matter);
    RUN(log_odds_rise_with_the_cosine);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
