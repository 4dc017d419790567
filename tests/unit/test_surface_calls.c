/* One call for all methods: what each gives for the same points, and which options it has. */
#include "brio/brio.h"
#include "brio/testdata.h"
#include "harness.h"
#include "points.h"
#include <math.h>
#include <string.h>

enum { N = BRIEF_TESTS ? 300 : 600 };

static double points[3 * N];

static bool has(int method, const char *option) {
    return brio_surface_method_has((brio_surface_method)method, option);
}

/* The vertices of every method say which points they are, and lie there. */
static void every_method_names_the_points_of_its_vertices(void) {
    brio_context *ctx = new_context();
    for (int method = 0; method < BRIO_SURFACE_END; method++) {
        const brio_surface_method_info *info = brio_surface_method_facts((brio_surface_method)method);
        const bool named = !(info->traits & BRIO_METHOD_OWN_VERTICES);
        const brio_surface_options o = {.method = info->method,
                                        .noise = has(method, "noise") ? BRIO_NOISE_KEEP : BRIO_NOISE_AUTO,
                                        .distance = has(method, "distance") ? 0.1 : 0};
        brio_surface_stats s = {0};
        brio_mesh *mesh = NULL;
        EXPECT(brio_surface(ctx, points, N, &o, &mesh, &s) == BRIO_OK, "%d: %s", method, brio_message(ctx));
        if (!mesh) continue;
        const brio_property *sample = brio_mesh_property(mesh, "sample");
        EXPECT(sample && sample->type == BRIO_SCALAR_INT32 && s.samples == N, "%d", method);
        for (size_t v = 0; sample && v < mesh->num_vertices; v++) {
            int32_t p = ((const int32_t *)sample->data)[v];
            EXPECT(named ? p >= 0 && p < N : p == -1, "%d: vertex %zu is point %d", method, v, (int)p);
            EXPECT(!(info->traits & BRIO_METHOD_ALL_POINTS) || (size_t)p == v, "%d: vertex %zu", method, v);
            if (named && p >= 0 && p < N)
                EXPECT(!memcmp(mesh->vertices + 3 * v, points + 3 * p, 3 * sizeof *points), "%d: vertex %zu", method,
                       v);
        }
        for (size_t f = 0; f < mesh->num_faces; f++)
            EXPECT(mesh->face_offsets[f + 1] - mesh->face_offsets[f] == 3, "%d: face %zu", method, f);
        brio_mesh_free(mesh);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* The normals of the points of a sphere are the points. */
static void methods_that_have_normals_tell_them(void) {
    brio_context *ctx = new_context();
    double normals[3 * N];
    for (int method = 0; method < BRIO_SURFACE_END; method++) {
        if (!has(method, "normals")) continue;
        const brio_surface_options o = {.method = (brio_surface_method)method, .normals = normals};
        brio_mesh *mesh = NULL;
        EXPECT(brio_surface(ctx, points, N, &o, &mesh, NULL) == BRIO_OK, "%d: %s", method, brio_message(ctx));
        for (size_t i = 0; i < N; i++) {
            double cosine = 0;
            for (size_t k = 0; k < 3; k++) cosine += normals[3 * i + k] * points[3 * i + k];
            EXPECT(cosine > 0.9, "method %d, point %zu: %g", method, i, cosine);
        }
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

/* An option is taken or refused, and the sentence names it and the methods that have it. */
static void options_of_other_methods_are_refused(void) {
    static const struct {
        brio_surface_options o;
        const char *name, *has;
    } wrong[] = {{{.method = BRIO_SURFACE_COCONE, .noise = BRIO_NOISE_SMOOTH}, "noise", "BRIO_SURFACE_LABELED"},
                 {{.method = BRIO_SURFACE_COCONE, .open = 3}, "open", "BRIO_SURFACE_POWER_CRUST"},
                 {{.method = BRIO_SURFACE_COCONE, .holes = BRIO_HOLES_CLOSED}, "holes", "BRIO_SURFACE_TIGHT_COCONE"},
                 {{.method = BRIO_SURFACE_TIGHT_COCONE, .simplify = 1}, "simplify", "BRIO_SURFACE_OFFSET"},
                 {{.method = BRIO_SURFACE_POWER_CRUST, .confidence = 1}, "confidence", "BRIO_SURFACE_LABELED"},
                 {{.method = BRIO_SURFACE_POWER_CRUST, .distance = 1}, "distance", "BRIO_SURFACE_OFFSET"},
                 {{.method = BRIO_SURFACE_OFFSET, .open = 1}, "open", "BRIO_SURFACE_LABELED"},
                 {{.normals = points, .method = BRIO_SURFACE_OFFSET}, "normals", "BRIO_SURFACE_COCONE"},
                 {{.polygons = 1}, "polygons", "BRIO_SURFACE_POWER_CRUST"},
                 {{.poles.sharp = 1}, "poles.sharp", "BRIO_SURFACE_OFFSET"},
                 {{.theta = 0.3}, "theta", "BRIO_SURFACE_TIGHT_COCONE"},
                 {{.density = 1}, "density", "BRIO_SURFACE_COCONE"},
                 {{.method = BRIO_SURFACE_TIGHT_COCONE, .pieces = 3}, "pieces", "BRIO_SURFACE_COCONE"}};
    brio_context *ctx = new_context();
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        brio_mesh *mesh = NULL;
        EXPECT(brio_surface(ctx, points, N, &wrong[i].o, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh, "%zu", i);
        EXPECT(strstr(brio_message(ctx), wrong[i].name) == brio_message(ctx) && strstr(brio_message(ctx), wrong[i].has),
               "%zu: %s", i, brio_message(ctx));
    }
    const brio_surface_options none = {.method = BRIO_SURFACE_END},
                               both = {.method = BRIO_SURFACE_POWER_CRUST, .polygons = 1, .simplify = 1};
    brio_mesh *mesh = NULL;
    EXPECT(brio_surface(ctx, points, N, &none, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(brio_surface(ctx, points, N, &both, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    brio_context_free(ctx);
}

/* The table says of every method and every option whether brio_surface takes it. */
static void the_table_lists_the_options_that_are_taken(void) {
    static const brio_evidence evidence = {0};
    static const brio_tiles_options tiles = {.scratch = ".", .tiles = 2};
    double normals[3 * N];
    brio_mesh *cube = NULL;
    brio_explanation *explanation = NULL;
    brio_context *ctx = new_context();
    EXPECT(brio_generate_solid(ctx, BRIO_SOLID_IMPLICIT, 1, 16, &cube) == BRIO_OK, "%s", brio_message(ctx));
    const struct {
        brio_surface_options o;
        const char *name;
    } uses[] = {{{.noise = BRIO_NOISE_SMOOTH}, "noise"},
                {{.evidence = &evidence}, "evidence"},
                {{.normals = normals}, "normals"},
                {{.open = 9}, "open"},
                {{.holes = BRIO_HOLES_CLOSED}, "holes"},
                {{.simplify = 1}, "simplify"},
                {{.confidence = 1}, "confidence"},
                {{.polygons = 1}, "polygons"},
                {{.distance = 0.1}, "distance"},
                {{.poles.labeling = BRIO_LABELING_GREEDY}, "poles.labeling"},
                {{.poles.sharp = 1}, "poles.sharp"},
                {{.poles.sampling_density = 0.9}, "poles.sampling_density"},
                {{.poles.solid = cube}, "poles.solid"},
                {{.theta = 0.4}, "theta"},
                {{.boundaries = 1}, "boundaries"},
                {{.density = 1}, "density"},
                {{.pieces = 2}, "pieces"},
                {{.size = sizeof uses->o, .explanation = &explanation}, "explanation"},
                {{.size = sizeof uses->o, .tiles = &tiles}, "tiles"}};
    for (int method = 0; method < BRIO_SURFACE_END; method++) {
        const char *options = brio_surface_method_facts((brio_surface_method)method)->options;
        size_t listed = *options != 0, known = 0;
        for (const char *at = options; *at; at++) listed += *at == ' ';
        for (size_t i = 0; i < sizeof uses / sizeof *uses; i++) {
            brio_surface_options o = uses[i].o;
            brio_mesh *mesh = NULL;
            o.method = (brio_surface_method)method;
            bool refused = brio_surface(ctx, points, N, &o, &mesh, NULL) == BRIO_ERR_ARGUMENT;
            EXPECT(refused == !has(method, uses[i].name), "%d, %s: %s", method, uses[i].name, brio_message(ctx));
            known += has(method, uses[i].name);
            brio_mesh_free(mesh);
            brio_explanation_free(explanation);
            explanation = NULL;
        }
        EXPECT(known == listed, "%d: %zu options listed, %zu known", method, listed, known);
    }
    EXPECT(!has(BRIO_SURFACE_COCONE, "poles") && !has(BRIO_SURFACE_OFFSET, "sharp") && !has(BRIO_SURFACE_END, "noise"));
    EXPECT(!brio_surface_method_facts(BRIO_SURFACE_END) && !brio_surface_method_facts((brio_surface_method)-1));
    brio_mesh_free(cube);
    brio_context_free(ctx);
}

/* A seed of 0 is the default seed, in every function that has one. */
static void the_default_seed_is_one(void) {
    brio_context *ctx = new_context();
    brio_mesh *a = NULL, *b = NULL, *c = NULL;
    EXPECT(brio_generate(ctx, BRIO_KIND_BALL, 50, NULL, &a) == BRIO_OK);
    EXPECT(brio_generate(ctx, BRIO_KIND_BALL, 50, &(brio_generate_options){.seed = 1}, &b) == BRIO_OK);
    EXPECT(brio_generate(ctx, BRIO_KIND_BALL, 50, &(brio_generate_options){.seed = 2}, &c) == BRIO_OK);
    EXPECT(!memcmp(a->vertices, b->vertices, 150 * sizeof(double)) &&
           memcmp(a->vertices, c->vertices, 150 * sizeof(double)));
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_mesh_free(c);
    brio_context_free(ctx);
}

SUITE(test_surface_calls) {
    sphere_points(1, N, points);
    RUN(every_method_names_the_points_of_its_vertices);
    RUN(methods_that_have_normals_tell_them);
    RUN(options_of_other_methods_are_refused);
    RUN(the_table_lists_the_options_that_are_taken);
    RUN(the_default_seed_is_one);
    return harness_end();
}
