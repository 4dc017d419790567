/* Every reconstruction, with every option: what it promises of its surface is judged by surface_oracle.h. The samples are few:
 * any numbers, places on a grid, or points of a sphere or a torus that are moved a little; so that labels are often wrong. */
#include "surface_oracle.h"

enum { MOST = 90 };

static size_t sample_shape(fuzz_input *in, bool torus, double *points) {
    size_t n = fuzz_below(in, MOST + 1);
    double noise = fuzz_byte(in) % 8 / 64.0;
    for (size_t i = 0; i < n; i++) {
        double u = 6.283185307179586 * (double)i * 0.6180339887498949, v = (2 * (double)i + 1) / (double)n - 1, r, z;
        r = torus ? 1 + 0.4 * cos(9 * v) : sqrt(1 - v * v), z = torus ? 0.4 * sin(9 * v) : v;
        points[3 * i] = r * cos(u), points[3 * i + 1] = r * sin(u), points[3 * i + 2] = z;
        for (size_t k = 0; k < 3 && noise > 0; k++) points[3 * i + k] += noise * (fuzz_byte(in) - 128) / 128.0;
    }
    return n;
}

static size_t make_samples(fuzz_input *in, double *points) {
    uint8_t kind = fuzz_byte(in) % 8;
    if (kind >= 4) return sample_shape(in, kind >= 6, points);
    size_t n = fuzz_below(in, MOST + 1);
    for (size_t i = 0; i < 3 * n; i++)
        points[i] = kind == 0 ? fuzz_double(in) : kind == 1 ? fuzz_byte(in) : fuzz_byte(in) % (kind == 2 ? 4 : 9);
    return n;
}

static brio_pole_options fuzz_poles(fuzz_input *in) {
    brio_pole_options o = brio_power_crust_options_default().poles;
    uint8_t bits = fuzz_byte(in);
    o.labeling = (brio_labeling)(bits % BRIO_LABELING_END);
    o.noise = (brio_noise)(bits / 4 % BRIO_NOISE_END);
    o.sharp = bits >> 6 & 1;
    o.sampling_density = bits & 128 ? 0.3 : 0;
    return o;
}

static void power_crust(brio_context *ctx, fuzz_input *in, const double *points, size_t n) {
    brio_power_crust_options o = brio_power_crust_options_default();
    double normals[3 * MOST];
    brio_mesh *m;
    o.poles = fuzz_poles(in);
    uint8_t bits = fuzz_byte(in);
    o.triangulate = bits & 1, o.simplify = bits >> 1 & 1, o.open = bits & 4 ? 1 + bits / 64.0 : 0;
    fuzz_expect_failure(brio_power_crust(ctx, points, n, &o, &m, bits & 8 ? normals : NULL, NULL));
    if (m) expect_surface(ctx, m, o.open == 0, "power crust");
    brio_mesh_free(m);
}

static void offset_surface(brio_context *ctx, fuzz_input *in, const double *points, size_t n) {
    static const double distances[] = {0, 0.1, -0.1, 1, -1, 100, 1e-30, -1e300};
    brio_offset_surface_options o = brio_offset_surface_options_default();
    brio_mesh *m;
    o.poles = fuzz_poles(in);
    uint8_t bits = fuzz_byte(in);
    o.triangulate = bits & 1, o.simplify = bits >> 1 & 1;
    fuzz_expect_failure(brio_offset_surface(ctx, points, n, distances[bits >> 2 & 7], &o, &m, NULL));
    if (m) expect_surface(ctx, m, true, "offset");
    brio_mesh_free(m);
}

static void power_shape(brio_context *ctx, fuzz_input *in, const double *points, size_t n) {
    brio_power_shape_options o = brio_power_shape_options_default();
    brio_mesh *m, *crust = NULL;
    o.poles = fuzz_poles(in);
    uint8_t bits = fuzz_byte(in);
    o.sides = (brio_sides)(bits % BRIO_SIDES_END);
    o.scale = bits & 4 ? 1.2 : 1, o.redundancy = bits & 8 ? 0.1 : 0;
    fuzz_expect_failure(brio_power_shape(ctx, points, n, &o, &m, bits & 16 ? &crust : NULL, NULL));
    if (m) fuzz_expect_sound(m);
    if (crust) expect_surface(ctx, crust, true, "crust of the shape");
    brio_mesh_free(m);
    brio_mesh_free(crust);
}

static void labeled_delaunay(brio_context *ctx, fuzz_input *in, const double *points, size_t n) {
    brio_labeled_delaunay_options o = brio_labeled_delaunay_options_default();
    uint32_t samples[MOST + 1];
    double normals[3 * MOST];
    brio_mesh *m;
    uint8_t bits = fuzz_byte(in);
    o.noise = (brio_noise)(bits % BRIO_NOISE_END);
    o.confidence = bits >> 2 & 1, o.simplify = bits >> 3 & 1, o.open = bits & 16 ? 1 + bits / 64.0 : 0;
    fuzz_expect_failure(brio_labeled_delaunay(ctx, points, n, &o, &m, samples, NULL));
    if (!m) return;
    expect_surface(ctx, m, o.open == 0, "labeled Delaunay");
    for (size_t v = 0; v < m->num_vertices; v++) FUZZ_EXPECT(samples[v] < n, "vertex %zu", v);
    fuzz_expect_failure(brio_point_normals(ctx, points, n, m, samples, normals));
    brio_mesh_free(m);
}

static void cocone(brio_context *ctx, fuzz_input *in, const double *points, size_t n) {
    brio_cocone_options o = brio_cocone_options_default();
    brio_mesh *m;
    uint8_t bits = fuzz_byte(in);
    o.boundaries = bits & 1, o.density = bits >> 1 & 1;
    o.theta = bits & 4 ? 1.0 : o.theta;
    if (bits & 8)
        o.tight = 1;
    else if (bits & 16)
        o.pieces = 2 + (bits >> 5);
    else
        o.extraction = (brio_extraction)((bits >> 5) % BRIO_EXTRACTION_END);
    fuzz_expect_failure(brio_cocone(ctx, points, n, &o, &m, NULL));
    if (m && o.extraction == BRIO_EXTRACTION_LABELS)
        expect_surface(ctx, m, o.tight, o.tight ? "tight co-cone" : "co-cone");
    else if (m)
        fuzz_expect_sound(m), expect_certificate(ctx, m);
    brio_mesh_free(m);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static void (*const methods[])(brio_context *, fuzz_input *, const double *,
                                   size_t) = {labeled_delaunay, power_crust, cocone, offset_surface, power_shape};
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    double points[3 * MOST];
    size_t method = fuzz_below(&in, sizeof methods / sizeof *methods);
    brio_context_set_threads(ctx, fuzz_byte(&in) < 8 ? 2 : 1);
    size_t n = make_samples(&in, points);
    methods[method](ctx, &in, points, n);
    fuzz_end();
    return 0;
}
