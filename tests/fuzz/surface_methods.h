/* Samples of surfaces, and every reconstruction with every option, as an input's bytes choose them. */
#ifndef BRIO_TESTS_SURFACE_METHODS_H
#define BRIO_TESTS_SURFACE_METHODS_H

#include "fuzz.h"
#include "trial.h"

enum { MOST_SAMPLES = 90 };

/* What a method made, and what it promises of it. */
typedef struct {
    const char *method;
    brio_mesh *mesh; /* NULL: a refusal */
    bool surface;    /* manifold and oriented */
    bool closed;
} reconstruction;

static inline size_t sample_shape(fuzz_input *in, bool torus, double *points) {
    size_t n = fuzz_below(in, MOST_SAMPLES + 1);
    double noise = fuzz_byte(in) % 8 / 64.0;
    for (size_t i = 0; i < n; i++) {
        double u = 6.283185307179586 * (double)i * 0.6180339887498949, v = (2 * (double)i + 1) / (double)n - 1, r, z;
        r = torus ? 1 + 0.4 * cos(9 * v) : sqrt(1 - v * v), z = torus ? 0.4 * sin(9 * v) : v;
        points[3 * i] = r * cos(u), points[3 * i + 1] = r * sin(u), points[3 * i + 2] = z;
        for (size_t k = 0; k < 3 && noise > 0; k++) points[3 * i + k] += noise * (fuzz_byte(in) - 128) / 128.0;
    }
    return n;
}

/** Any numbers, places on a grid, or points of a sphere or a torus that are moved a little.   points  room for MOST_SAMPLES. */
static inline size_t fuzz_samples(fuzz_input *in, double *points) {
    uint8_t kind = fuzz_byte(in) % 8;
    if (kind >= 4) return sample_shape(in, kind >= 6, points);
    size_t n = fuzz_below(in, MOST_SAMPLES + 1);
    for (size_t i = 0; i < 3 * n; i++)
        points[i] = kind == 0 ? fuzz_double(in) : kind == 1 ? fuzz_byte(in) : fuzz_byte(in) % (kind == 2 ? 4 : 9);
    return n;
}

/* lab  receives an experiment, to be freed, as one labeling in two is that of one. */
static inline brio_pole_options fuzz_poles(brio_context *ctx, fuzz_input *in, brio_noise *noise,
                                           brio_laboratory **lab) {
    brio_pole_options o = {0};
    uint8_t bits = fuzz_byte(in);
    FUZZ_EXPECT(trial_labeling(ctx, bits % TRIAL_LABELINGS, &o, lab) == BRIO_OK);
    *noise = (brio_noise)(bits / 4 % BRIO_NOISE_END);
    o.sharp = bits >> 6 & 1;
    o.sampling_density = bits & 128 ? 0.3 : 0;
    return o;
}

/* A method's result for points whose unit of length is `unit`. */
static inline reconstruction power_crust(brio_context *ctx, fuzz_input *in, const double *points, size_t n,
                                         double unit) {
    brio_surface_options o = {.method = BRIO_SURFACE_POWER_CRUST};
    reconstruction r = {.method = "power crust", .surface = true};
    double normals[3 * MOST_SAMPLES];
    brio_laboratory *lab;
    o.poles = fuzz_poles(ctx, in, &o.noise, &lab);
    uint8_t bits = fuzz_byte(in);
    o.simplify = bits >> 1 & 1, o.polygons = !(bits & 1) && !o.simplify, o.open = bits & 4 ? 1 + bits / 64.0 : 0;
    r.closed = o.open == 0;
    o.normals = bits & 8 ? normals : NULL;
    (void)unit;
    fuzz_expect_failure(brio_surface(ctx, points, n, &o, &r.mesh, NULL));
    brio_laboratory_free(lab);
    return r;
}

static inline reconstruction offset_surface(brio_context *ctx, fuzz_input *in, const double *points, size_t n,
                                            double unit) {
    static const double distances[] = {0, 0.1, -0.1, 1, -1, 100, 1e-30, -1e200};
    brio_surface_options o = {.method = BRIO_SURFACE_OFFSET};
    reconstruction r = {.method = "offset", .surface = true, .closed = true};
    brio_laboratory *lab;
    o.poles = fuzz_poles(ctx, in, &o.noise, &lab);
    uint8_t bits = fuzz_byte(in);
    o.simplify = bits >> 1 & 1, o.polygons = !(bits & 1) && !o.simplify;
    o.distance = unit * distances[bits >> 2 & 7];
    fuzz_expect_failure(brio_surface(ctx, points, n, &o, &r.mesh, NULL));
    brio_laboratory_free(lab);
    return r;
}

static inline reconstruction power_shape(brio_context *ctx, fuzz_input *in, const double *points, size_t n,
                                         double unit) {
    brio_power_shape_options o = {0};
    reconstruction r = {.method = "crust of the power shape", .surface = true, .closed = true};
    brio_mesh *shape;
    brio_laboratory *lab;
    o.poles = fuzz_poles(ctx, in, &o.noise, &lab);
    uint8_t bits = fuzz_byte(in);
    o.sides = (brio_sides)(bits % BRIO_SIDES_END);
    o.scale = bits & 4 ? 1.2 : 1, o.redundancy = bits & 8 ? 0.1 : 0;
    (void)unit;
    fuzz_expect_failure(brio_power_shape(ctx, points, n, &o, &shape, bits & 16 ? &r.mesh : NULL, NULL));
    brio_laboratory_free(lab);
    if (shape) fuzz_expect_sound(shape);
    brio_mesh_free(shape);
    return r;
}

static inline reconstruction labeled_delaunay(brio_context *ctx, fuzz_input *in, const double *points, size_t n,
                                              double unit) {
    brio_surface_options o = {.holes = BRIO_HOLES_CLOSED};
    reconstruction r = {.method = "labeled Delaunay", .surface = true};
    double normals[3 * MOST_SAMPLES];
    uint8_t bits = fuzz_byte(in);
    o.noise = (brio_noise)(bits % BRIO_NOISE_END);
    o.confidence = bits >> 2 & 1, o.simplify = bits >> 3 & 1, o.open = bits & 16 ? 1 + bits / 64.0 : 0;
    r.closed = o.open == 0;
    (void)unit;
    o.normals = normals;
    fuzz_expect_failure(brio_surface(ctx, points, n, &o, &r.mesh, NULL));
    if (!r.mesh) return r;
    const int32_t *sample = brio_mesh_property(r.mesh, "sample")->data;
    for (size_t v = 0; v < r.mesh->num_vertices; v++)
        FUZZ_EXPECT(sample[v] >= 0 && (size_t)sample[v] < n, "vertex %zu", v);
    return r;
}

static inline reconstruction cocone(brio_context *ctx, fuzz_input *in, const double *points, size_t n, double unit) {
    brio_surface_options o = {.method = BRIO_SURFACE_COCONE};
    reconstruction r = {.method = "co-cone"};
    brio_laboratory_options experiment = {0};
    brio_laboratory *lab;
    uint8_t bits = fuzz_byte(in);
    o.boundaries = bits & 1, o.density = bits >> 1 & 1;
    o.theta = bits & 4 ? 1.0 : o.theta;
    if (bits & 8)
        o.method = BRIO_SURFACE_TIGHT_COCONE;
    else if (bits & 16)
        o.pieces = 2 + (bits >> 5);
    else
        experiment.extraction = (brio_extraction)((bits >> 5) % BRIO_EXTRACTION_END);
    r.surface = experiment.extraction == BRIO_EXTRACTION_LABELS, r.closed = o.method == BRIO_SURFACE_TIGHT_COCONE;
    (void)unit;
    FUZZ_EXPECT(brio_laboratory_new(ctx, &experiment, &lab) == BRIO_OK);
    fuzz_expect_failure(brio_surface(ctx, points, n, &o, &r.mesh, NULL));
    brio_laboratory_free(lab);
    return r;
}

typedef reconstruction (*surface_method)(brio_context *, fuzz_input *, const double *, size_t, double);

/** A method of the input's choice. */
static inline surface_method fuzz_method(fuzz_input *in) {
    static const surface_method methods[] = {labeled_delaunay, power_crust, cocone, offset_surface, power_shape};
    return methods[fuzz_below(in, sizeof methods / sizeof *methods)];
}

#endif
