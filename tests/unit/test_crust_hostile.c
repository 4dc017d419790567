/* The power crust of random, clustered, concentric and lattice inputs, with every labeling and option that leaves
 * nothing open on purpose: closed, manifold and oriented, or no inside, and nothing else.
 *
 * test_crust_hostile [COUNT] sweeps COUNT inputs of up to 300 points; without it, a few. */
#include "harness.h"
#include "points.h"
#include "surface_calls.h"

enum { MOST = 300, FEW = BRIEF_TESTS ? 200 : 400, KINDS = 4 };

static uint64_t num_inputs = FEW;

/* Shells round one centre; every other input repeats the directions of the first shell, scaled. */
static size_t concentric_points(uint64_t seed, double *p) {
    brio_rng rng = brio_rng_new(seed);
    size_t shells = 2 + brio_rng_below(&rng, 3), each = 4 + brio_rng_below(&rng, 56);
    for (size_t s = 0; s < shells; s++) {
        double radius = 1 + pow(10, -9 * brio_rng_double(&rng)) * (double)s, *shell = p + 3 * each * s;
        sphere_points(seed % 2 ? seed : seed + s, each, shell);
        for (size_t i = 0; i < 3 * each; i++) shell[i] *= radius;
    }
    return shells * each;
}

/* A block of a lattice, its spacing exact in binary or not, some of its points left out, or with cell centres. */
static size_t lattice_points(uint64_t seed, double *p) {
    brio_rng rng = brio_rng_new(seed);
    uint32_t side[3], thin = brio_rng_below(&rng, 3), centred = brio_rng_below(&rng, 2);
    double spacing = brio_rng_below(&rng, 2) ? 1 : 0.1;
    size_t n = 0;
    for (int k = 0; k < 3; k++) side[k] = 2 + brio_rng_below(&rng, 4);
    for (uint32_t i = 0; i < side[0] * side[1] * side[2]; i++) {
        if (thin && brio_rng_below(&rng, 4) == 0) continue;
        const uint32_t at[3] = {i % side[0], i / side[0] % side[1], i / side[0] / side[1]};
        for (uint32_t half = 0; half <= centred && n < MOST; half++, n++)
            for (int k = 0; k < 3; k++) p[3 * n + (size_t)k] = spacing * (at[k] + 0.5 * half);
    }
    return n;
}

static size_t hostile_points(uint64_t trial, double *p) {
    size_t n = 4 + brio_mix(trial) % (MOST - 3);
    switch (trial % KINDS) {
    case 0:
        uniform_points(trial, n, p);
        return n;
    case 1:
        clustered_points(trial, n, p);
        return n;
    case 2:
        return concentric_points(trial, p);
    default:
        return lattice_points(trial, p);
    }
}

static brio_surface_options options_of(uint64_t trial) {
    brio_surface_options o = CRUST_OPTIONS;
    uint64_t choice = trial / KINDS;
    o.poles.labeling = (brio_labeling)(choice % BRIO_LABELING_END);
    o.polygons = !(choice / 4 % 3 == 1);
    o.simplify = choice / 4 % 3 == 2;
    o.poles.sharp = choice / 12 % 3 == 1;
    o.poles.sampling_density = choice / 12 % 3 == 2 ? 0.6 : 0;
    return o;
}

/* 1 when a surface came out. */
static int sweep_one(brio_context *ctx, uint64_t trial) {
    static double p[3 * MOST];
    size_t n = hostile_points(trial, p);
    brio_surface_options o = options_of(trial);
    brio_surface_stats s = {0};
    brio_mesh *mesh;
    brio_certificate c = {0};
    brio_status status = make_crust(ctx, p, n, &o, &mesh, NULL, &s);
    EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_ANSWER && !mesh), "input %llu: %s", (unsigned long long)trial,
           brio_message(ctx));
    if (status != BRIO_OK) return 0;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.boundary_edges == 0 && c.flipped_edges == 0, "input %llu",
           (unsigned long long)trial);
    EXPECT(s.poles.inner > 0 && s.poles.inner + s.poles.outer == s.poles.poles, "input %llu",
           (unsigned long long)trial);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    return 1;
}

static void hostile_inputs_have_closed_surfaces_or_none(void) {
    uint64_t surfaces[KINDS] = {0};
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    for (uint64_t trial = 0; trial < num_inputs; trial++) surfaces[trial % KINDS] += (uint64_t)sweep_one(ctx, trial);
    for (int k = 0; k < KINDS; k++)
        EXPECT(surfaces[k] > num_inputs / KINDS / 2, "kind %d: %llu surfaces", k, (unsigned long long)surfaces[k]);
    fprintf(stderr, "%llu inputs: surfaces of %llu random, %llu clustered, %llu concentric, %llu lattice ones\n",
            (unsigned long long)num_inputs, (unsigned long long)surfaces[0], (unsigned long long)surfaces[1],
            (unsigned long long)surfaces[2], (unsigned long long)surfaces[3]);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_crust_hostile) {
    if (argc > 1) num_inputs = strtoull(argv[1], NULL, 10);
    RUN(hostile_inputs_have_closed_surfaces_or_none);
    return harness_end();
}
