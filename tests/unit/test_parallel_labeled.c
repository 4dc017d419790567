/* The labeled Delaunay triangulation in several threads: the surface of one thread, on clean and on noisy samples. */
#include "base/rng.h"
#include "harness.h"
#include "points.h"
#include "same_faces.h"
#include "surface_calls.h"
#include <string.h>

enum { MANY = BRIEF_TESTS ? 3500 : 6000, MOST_THREADS = BRIEF_TESTS ? 3 : 5 };

static brio_mesh *surface_of(const double *p, int threads) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    brio_context_set_threads(ctx, threads);
    EXPECT(make_labeled(ctx, p, MANY, NULL, &mesh, NULL, NULL) == BRIO_OK, "%s", brio_message(ctx));
    return mesh; /* its context lives on with it */
}

static void free_surface(brio_mesh *mesh) {
    brio_context *ctx = mesh->context;
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void expect_the_surface_of_one_thread(const double *p) {
    brio_mesh *one = surface_of(p, 1);
    for (int threads = BRIEF_TESTS ? 3 : 2; threads <= MOST_THREADS; threads++) {
        brio_mesh *more = surface_of(p, threads);
        expect_same_faces(one, NULL, more);
        EXPECT(one->num_vertices == more->num_vertices &&
               !memcmp(one->vertices, more->vertices, 24 * one->num_vertices));
        free_surface(more);
    }
    free_surface(one);
}

static void clean_samples(void) {
    static double p[3 * MANY];
    torus_points(9, MANY, p);
    expect_the_surface_of_one_thread(p);
}

/* step: the noise in each coordinate, uniform. Some of it is reduced after the labels, more of it before. */
static void noisy_samples(double step) {
    static double p[3 * MANY];
    brio_rng rng = brio_rng_new(3);
    torus_points(9, MANY, p);
    for (size_t i = 0; i < 3 * MANY; i++) p[i] += step * (brio_rng_double(&rng) - 0.5);
    expect_the_surface_of_one_thread(p);
}

static void noise_reduced_after_the_labels(void) {
    noisy_samples(0.04);
}

static void noise_reduced_before_the_triangulation(void) {
    noisy_samples(0.12);
}

SUITE(test_parallel_labeled) {
    RUN(clean_samples);
    RUN(noise_reduced_after_the_labels);
    RUN(noise_reduced_before_the_triangulation);
    return harness_end();
}
