/* Labelings: right on dense samples, ordered by energy, and the same for every order of the samples; the maximum flow
 * under the global one. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include "trial.h"
#include "reconstruct/labels/max_flow.h"

static const int ALL[TRIAL_LABELINGS] = {BRIO_LABELING_GREEDY, TRIAL_NAIVE, TRIAL_THEORETICAL, BRIO_LABELING_GLOBAL};

static size_t unreached; /* by the last labeling */

static brio_mesh *crust(brio_context *ctx, const double *p, size_t n, int labeling, brio_surface_stats *s) {
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *mesh = NULL;
    brio_laboratory *lab;
    EXPECT(trial_labeling(ctx, labeling, &o.poles, &lab) == BRIO_OK);
    brio_status status = make_crust(ctx, p, n, &o, &mesh, NULL, s);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_ANSWER, "labeling %d: %s", labeling, brio_message(ctx));
    unreached = brio_laboratory_results(lab)->unreached;
    brio_laboratory_free(lab);
    return mesh;
}

static bool same_mesh(const brio_mesh *a, const brio_mesh *b) {
    return a->num_vertices == b->num_vertices && a->num_faces == b->num_faces &&
           !memcmp(a->vertices, b->vertices, 24 * a->num_vertices) &&
           !memcmp(a->face_vertices, b->face_vertices, 4 * a->face_offsets[a->num_faces]);
}

/* Dense samples of smooth surfaces: lemmata 56 and 57 say that every label is right. */
static void all_agree_on_dense_samples(void) {
    static double p[3 * 3000];
    for (int shape = 0; shape < 2; shape++) {
        brio_context *ctx = new_context();
        brio_context_set_threads(ctx, 1);
        brio_mesh *first = NULL;
        if (shape)
            torus_points(4, 3000, p);
        else
            sphere_points(4, 3000, p);
        for (int l = 0; l < TRIAL_LABELINGS; l++) {
            brio_surface_stats s = {0};
            brio_mesh *mesh = crust(ctx, p, 3000, ALL[l], &s);
            EXPECT(unreached == 0 && s.poles.undecided == 0 && s.poles.toggled == 0, "labeling %d", l);
            EXPECT(s.poles.energy < 1e-6 * (double)s.poles.poles, "labeling %d: %g", l, s.poles.energy);
            if (!first)
                first = mesh;
            else {
                EXPECT(same_mesh(first, mesh), "labeling %d", l);
                brio_mesh_free(mesh);
            }
        }
        brio_mesh_free(first);
        brio_context_free(ctx);
    }
}

/* Inputs with no right answer: all are closed, and the global labels violate no more than the greedy ones. */
static void anything_is_labeled_and_global_is_no_worse(void) {
    double p[3 * 60];
    int lower = 0;
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    for (uint64_t trial = 0; trial < 150; trial++) {
        size_t n = 10 + trial % 50;
        if (trial % 2)
            clustered_points(trial, n, p);
        else
            integer_points(trial, n, 4, p);
        for (int l = 0; l < TRIAL_LABELINGS; l++) {
            brio_surface_stats s = {0};
            brio_certificate c = {0};
            brio_mesh *mesh = crust(ctx, p, n, ALL[l], &s);
            if (!mesh) continue;
            EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
            EXPECT(c.closed && c.manifold && c.oriented, "trial %llu, labeling %d", (unsigned long long)trial, l);
            if (ALL[l] == BRIO_LABELING_GLOBAL) {
                EXPECT(s.poles.energy <= s.poles.energy_greedy + 1e-9, "trial %llu", (unsigned long long)trial);
                lower += s.poles.energy < s.poles.energy_greedy - 1e-4;
            }
            brio_certificate_free(&c);
            brio_mesh_free(mesh);
        }
    }
    EXPECT(lower > 20, "%d", lower);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void shuffled_samples_give_the_same_global_labels(void) {
    static double p[3 * 400], q[3 * 400];
    static size_t to[400];
    clustered_points(8, 400, p);
    shuffle_points(3, 400, p, q, to);
    brio_context *ctx = new_context();
    brio_surface_stats s = {0}, t = {.size = sizeof t};
    brio_mesh *a = crust(ctx, p, 400, BRIO_LABELING_GLOBAL, &s), *b = crust(ctx, q, 400, BRIO_LABELING_GLOBAL, &t);
    EXPECT(a && b && same_mesh(a, b));
    EXPECT(s.poles.energy == t.poles.energy && s.poles.toggled == t.poles.toggled);
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void unknown_labeling_is_refused(void) {
    double p[3 * 20];
    uniform_points(1, 20, p);
    brio_context *ctx = new_context();
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *mesh;
    o.poles.labeling = BRIO_LABELING_END;
    EXPECT(make_crust(ctx, p, 20, &o, &mesh, NULL, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    brio_context_free(ctx);
}

/* --- maximum flow --- */

enum { NODES = 8 };

/* The value of the cut with the given nodes on the source's side. */
static int64_t cut_value(unsigned sources, const brio_flow_edge *e, size_t n, const int64_t *terminal) {
    int64_t value = 0;
    for (size_t i = 0; i < n; i++)
        if ((sources >> e[i].a & 1) != (sources >> e[i].b & 1)) value += e[i].capacity;
    for (int v = 0; v < NODES; v++) {
        bool source = sources >> v & 1;
        if (terminal[v] > 0 && !source) value += terminal[v];
        if (terminal[v] < 0 && source) value -= terminal[v];
    }
    return value;
}

/* Tries all 256 cuts: both sides are least minimum cuts. */
static void check_cut(const brio_flow_edge *e, size_t n, const int64_t *terminal, const uint8_t *side, uint64_t trial) {
    int64_t best = INT64_MAX;
    unsigned from_source = 0, to_sink = 0, all_sources = 255, all_sinks = 255;
    for (unsigned s = 0; s < 256; s++) {
        int64_t value = cut_value(s, e, n, terminal);
        if (value < best) best = value, all_sources = 255, all_sinks = 255;
        if (value == best) all_sources &= s, all_sinks &= ~s & 255;
    }
    for (int v = 0; v < NODES; v++) {
        if (side[v] == BRIO_FLOW_SOURCE) from_source |= 1u << v;
        if (side[v] == BRIO_FLOW_SINK) to_sink |= 1u << v;
    }
    EXPECT(from_source == all_sources && to_sink == all_sinks, "trial %llu", (unsigned long long)trial);
}

static void cuts_are_minimal_and_least(void) {
    brio_context *ctx = new_context();
    brio_flow flow = brio_flow_new(ctx); /* used again and again */
    for (uint64_t trial = 0; trial < 4000; trial++) {
        brio_rng rng = brio_rng_new(trial);
        brio_flow_edge e[20];
        size_t n = brio_rng_below(&rng, 21);
        int64_t terminal[NODES], used[NODES];
        uint8_t side[NODES];
        for (size_t i = 0; i < n; i++)
            e[i] = (brio_flow_edge){brio_rng_below(&rng, NODES), brio_rng_below(&rng, NODES),
                                    (int32_t)brio_rng_below(&rng, 6)};
        for (int v = 0; v < NODES; v++) used[v] = terminal[v] = (int64_t)brio_rng_below(&rng, 9) - 4;
        EXPECT(brio_flow_maximum(&flow, NODES, e, n, used, side) == BRIO_OK);
        check_cut(e, n, terminal, side, trial);
    }
    brio_flow_free(&flow);
    brio_context_free(ctx);
}

static brio_status small_global_crust(brio_context *ctx) {
    double p[3 * 40];
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *mesh;
    o.poles.labeling = BRIO_LABELING_GLOBAL;
    clustered_points(3, 40, p);
    brio_status status = make_crust(ctx, p, 40, &o, &mesh, NULL, NULL);
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(small_global_crust);
}

SUITE(test_labeling) {
    RUN(all_agree_on_dense_samples);
    RUN(anything_is_labeled_and_global_is_no_worse);
    RUN(shuffled_samples_give_the_same_global_labels);
    RUN(unknown_labeling_is_refused);
    RUN(cuts_are_minimal_and_least);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
