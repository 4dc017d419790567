/* Surfaces of samples on the regular grids of machined shapes, where many poles coincide exactly: any number of threads
 * gives the same mesh.
 *
 * Coincident poles once made the triangulation rename the vertices of slots that nobody had written, which ended one run
 * in four.
 *
 * Without an argument: small grids, each option once. With a number: large grids too, at least that many runs. */
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include <math.h>

enum { MOST_SAMPLES = 90000, OPTIONS = 7 };

static const int THREADS[] = {1, 2, 3, 8, 17};
enum { NUM_THREADS = sizeof THREADS / sizeof *THREADS };

static double samples[3 * MOST_SAMPLES];
static size_t num_samples, runs;

/* Coordinates of CAD files end after some digits. */
static void add_sample(double x, double y, double z) {
    double *p = samples + 3 * num_samples++;
    p[0] = round(x * 1e12) / 1e12, p[1] = round(y * 1e12) / 1e12, p[2] = round(z * 1e12) / 1e12;
}

static void shuffle_samples(void) {
    brio_rng rng = brio_rng_new(5);
    for (size_t i = num_samples; i > 1; i--) {
        size_t j = brio_rng_below(&rng, (uint32_t)i);
        for (int k = 0; k < 3; k++) {
            double x = samples[3 * j + (size_t)k];
            samples[3 * j + (size_t)k] = samples[3 * (i - 1) + (size_t)k], samples[3 * (i - 1) + (size_t)k] = x;
        }
    }
}

static void make_cylinder(size_t around, size_t along) {
    num_samples = 0;
    for (size_t i = 0; i < around; i++)
        for (size_t j = 0; j < along; j++) {
            double a = 6.283185307179586 * (double)i / (double)around;
            add_sample(cos(a), sin(a), 2.0 * (double)j / (double)along);
        }
    shuffle_samples();
}

static void make_torus(size_t n, size_t step) {
    num_samples = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j += step) {
            double a = 6.283185307179586 * (double)i / (double)n, b = 6.283185307179586 * (double)j / (double)n;
            add_sample((2 + cos(b)) * cos(a), (2 + cos(b)) * sin(a), sin(b));
        }
    shuffle_samples();
}

/* A number that tells two meshes apart. */
static uint64_t fingerprint(const brio_mesh *m) {
    uint64_t sum = m->num_faces;
    for (size_t i = 0; i < m->face_offsets[m->num_faces]; i++) sum = brio_mix(sum + m->face_vertices[i]);
    for (size_t i = 0; i < 3 * m->num_vertices; i++) {
        uint64_t bits;
        memcpy(&bits, &m->vertices[i], sizeof bits);
        sum = brio_mix(sum + bits);
    }
    return sum;
}

static brio_status surface_with(brio_context *ctx, int option, brio_mesh **out) {
    brio_surface_options o = CRUST_OPTIONS;
    brio_surface_options c = COCONE_OPTIONS;
    if (option == 1) o.noise = BRIO_NOISE_KEEP;
    if (option == 2) o.polygons = 0;
    if (option == 3) o.poles.labeling = BRIO_LABELING_GREEDY;
    if (option == 4) o.noise = BRIO_NOISE_SMOOTH;
    c.method = option == 6 ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE;
    return option < 5 ? make_crust(ctx, samples, num_samples, &o, out, NULL, NULL)
                      : make_cocone(ctx, samples, num_samples, &c, out, NULL);
}

static uint64_t run(int option, int threads) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = NULL;
    brio_context_set_threads(ctx, threads);
    brio_status status = surface_with(ctx, option, &mesh);
    uint64_t sum = status == BRIO_OK ? fingerprint(mesh) : (uint64_t)status;
    EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_ANSWER, "option %d, %d threads: %s", option, threads,
           brio_message(ctx));
    brio_mesh_free(mesh);
    brio_context_free(ctx);
    runs++;
    return sum;
}

static void expect_one_surface(const char *name) {
    for (int option = 0; option < OPTIONS; option++) {
        uint64_t alone = run(option, THREADS[0]);
        for (int k = 1; k < NUM_THREADS; k++)
            EXPECT(run(option, THREADS[k]) == alone, "%s, option %d, %d threads", name, option, THREADS[k]);
    }
}

static void grids_give_one_surface_for_every_number_of_threads(void) {
    make_cylinder(60, 12);
    expect_one_surface("cylinder");
    make_torus(36, 1);
    expect_one_surface("torus");
}

static void large_grids_give_one_surface(size_t least) {
    static const size_t CYLINDERS[][2] = {{360, 60}, {512, 40}, {100, 200}, {720, 120}};
    for (int i = 0; runs < least; i = (i + 1) % 7) {
        if (i < 4)
            make_cylinder(CYLINDERS[i][0], CYLINDERS[i][1]);
        else
            make_torus(150, (size_t)(i - 3));
        expect_one_surface(i < 4 ? "large cylinder" : "large torus");
        fprintf(stderr, "%zu runs\n", runs);
    }
}

SUITE(test_machined_grids) {
    RUN(grids_give_one_surface_for_every_number_of_threads);
    if (argc > 1) large_grids_give_one_surface((size_t)atol(argv[1]));
    return harness_end();
}
