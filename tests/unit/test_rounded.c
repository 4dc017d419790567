/* Depths that are rounded to steps higher than the spacing: they become slopes, and exact planes of models stay. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/noise/sample_noise.h"

enum { WIDE = 120, HIGH = 100, PIXELS = WIDE * HIGH };
static const double ANGLE = 0.01;

typedef enum { NOT_ROUNDED, PLANES, SPHERES, DISPARITIES } rounding_kind;

/* The depth that a kind of camera rounds, along z, the ray, or as a disparity. Returns the share of the ray. */
static double rounded_share(rounding_kind kind, const double *p, double step) {
    double z = p[2], r = sqrt(p[0] * p[0] + p[1] * p[1] + z * z);
    switch (kind) {
    case PLANES:
        return step * rint(z / step) / z;
    case SPHERES:
        return step * rint(r / step) / r;
    case DISPARITIES:
        return 100 / step / rint(100 / step / z) / z;
    default:
        return 1;
    }
}

/* A frame of a camera at the origin, of a wavy wall some ten away. */
static void make_frame(rounding_kind kind, double step, double *truth, double *p) {
    for (size_t i = 0; i < PIXELS; i++) {
        double x = ANGLE * ((double)(i % WIDE) - 0.5 * WIDE), y = ANGLE * ((double)(i / WIDE) - 0.5 * HIGH);
        double z = 10 + 3 * sin(2 * x) * cos(3 * y) + 2 * x;
        const double at[3] = {x * z, y * z, z};
        double share = rounded_share(kind, at, step);
        for (size_t k = 0; k < 3; k++) truth[3 * i + k] = at[k], p[3 * i + k] = share * at[k];
    }
}

static double mean_error(const double *truth, const double *p) {
    double sum = 0;
    for (size_t i = 0; i < PIXELS; i++)
        sum += sqrt(pow(p[3 * i] - truth[3 * i], 2) + pow(p[3 * i + 1] - truth[3 * i + 1], 2) +
                    pow(p[3 * i + 2] - truth[3 * i + 2], 2));
    return sum / PIXELS;
}

static brio_rounding unround(brio_context *ctx, double *p, size_t n, const double *place) {
    brio_rounding r = {-1, 0};
    EXPECT(brio_unround_samples(ctx, p, n, place, &r) == BRIO_OK);
    return r;
}

/* Steps of two to six pixels, along an axis and along the rays; with the scanner's place, and without. */
static void steps_become_slopes(void) {
    static const double ORIGIN[3] = {0, 0, 0};
    static double truth[3 * PIXELS], p[3 * PIXELS], rounded[3 * PIXELS];
    brio_context *ctx = new_context();
    for (rounding_kind kind = PLANES; kind <= SPHERES; kind++)
        for (int step = 2; step <= 6; step += 2)
            for (int known = 0; known < 2; known++) {
                make_frame(kind, 0.1 * step, truth, p);
                memcpy(rounded, p, sizeof p);
                double before = mean_error(truth, p);
                brio_rounding r = unround(ctx, p, PIXELS, known ? ORIGIN : NULL);
                double after = mean_error(truth, p);
                EXPECT(fabs(r.step - (0.1 * step)) < 1e-6);
                EXPECT(after < 0.7 * before, "kind %d, %d pixels, place %d: error %g of %g", (int)kind, step, known,
                       after, before);
                for (size_t i = 0; i < PIXELS; i++) {
                    double to = sqrt(pow(p[3 * i] - rounded[3 * i], 2) + pow(p[3 * i + 2] - rounded[3 * i + 2], 2));
                    EXPECT(to <= 0.0751 * step, "%g, over half a step", to);
                }
            }
    make_frame(DISPARITIES, 0.3, truth, p);
    double before = mean_error(truth, p);
    EXPECT(unround(ctx, p, PIXELS, ORIGIN).step > 0);
    EXPECT(mean_error(truth, p) < 0.7 * before, "%g of %g", mean_error(truth, p), before);
    brio_context_free(ctx);
}

/* Where a frame has another pose its levels are oblique planes. */
static void levels_may_be_oblique(void) {
    static double truth[3 * PIXELS], p[3 * PIXELS];
    brio_context *ctx = new_context();
    make_frame(PLANES, 0.4, truth, p);
    for (size_t i = 0; i < PIXELS; i++)
        for (int m = 0; m < 2; m++) {
            double *q = (m ? p : truth) + 3 * i, x = 0.6 * q[0] + 0.8 * q[2], z = 0.6 * q[2] - 0.8 * q[0];
            q[0] = x + 7, q[2] = z - 3;
        }
    double before = mean_error(truth, p);
    const double place[3] = {7, 0, -3};
    EXPECT(fabs(unround(ctx, p, PIXELS, place).step - (0.4)) < 1e-6);
    EXPECT(mean_error(truth, p) < 0.7 * before);
    brio_context_free(ctx);
}

static void expect_untouched(brio_context *ctx, const char *name, double *p, size_t n) {
    double *before = malloc(3 * n * sizeof *p);
    memcpy(before, p, 3 * n * sizeof *p);
    brio_rounding r = unround(ctx, p, n, NULL);
    EXPECT(r.step == 0 && r.moved == 0 && memcmp(before, p, 3 * n * sizeof *p) == 0, "%s: steps of %g", name, r.step);
    free(before);
}

/* The surface of a box whose points are those of a grid. */
static size_t add_box(int a, int b, int c, const double *at, double *p) {
    size_t n = 0;
    for (int x = 0; x <= a; x++)
        for (int y = 0; y <= b; y++)
            for (int z = 0; z <= c; z++) {
                if (x > 0 && x < a && y > 0 && y < b && z > 0 && z < c) continue;
                p[3 * n] = at[0] + x, p[3 * n + 1] = at[1] + y, p[3 * n++ + 2] = at[2] + z;
            }
    return n;
}

/* Grids on boxes, stairs, thin plates, rings of a lathe, heights over a grid: planes and levels, and nothing rounded. */
static void exact_planes_are_not_rounded(void) {
    static double p[3 * 80000], truth[3 * PIXELS];
    static const double O[3] = {0, 0, 0};
    brio_context *ctx = new_context();
    size_t n = add_box(40, 40, 40, O, p);
    expect_untouched(ctx, "cube", p, n);
    n = add_box(60, 60, 1, O, p);
    expect_untouched(ctx, "plate", p, n);
    n = 0;
    for (int i = 0; i < 12; i++) n += add_box(10, 50, 6 * (i + 1), (const double[3]){11 * i, 0, 0}, p + 3 * n);
    expect_untouched(ctx, "stairs", p, n);
    n = 0;
    for (int ring = 0; ring < 30; ring++)
        for (int i = 0; i < 200; i++, n++) {
            double a = 0.031415926535 * i, r = 10 + 3 * sin(0.2 * ring);
            p[3 * n] = r * cos(a), p[3 * n + 1] = r * sin(a), p[3 * n + 2] = 2 * ring;
        }
    expect_untouched(ctx, "lathe", p, n);
    for (int x = -30; x <= 30; x++) /* a lid, whose points are half as far apart as the rings: one level has planes */
        for (int y = -30; y <= 30; y++, n++) p[3 * n] = x, p[3 * n + 1] = y, p[3 * n + 2] = 60;
    expect_untouched(ctx, "lathe with a lid", p, n);
    n = 0;
    for (int x = 0; x < 100; x++)
        for (int y = 0; y < 100; y++, n++)
            p[3 * n] = x, p[3 * n + 1] = y, p[3 * n + 2] = 8 * sin(0.1 * x) * cos(0.07 * y);
    expect_untouched(ctx, "heights", p, n);
    make_frame(NOT_ROUNDED, 0, truth, p);
    expect_untouched(ctx, "frame", p, PIXELS);
    make_frame(PLANES, 0.02, truth, p);
    expect_untouched(ctx, "fine steps", p, PIXELS);
    brio_context_free(ctx);
}

/* The surface of a rounded frame is one piece, as that of the frame before; with the noise kept it falls to pieces. */
static void surface_of_steps_is_one_piece(void) {
    static double truth[3 * PIXELS], p[3 * PIXELS];
    brio_context *ctx = new_context();
    make_frame(PLANES, 0.4, truth, p);
    for (int keep = 0; keep < 2; keep++) {
        brio_surface_options o = {.noise = keep ? BRIO_NOISE_KEEP : BRIO_NOISE_AUTO};
        brio_surface_stats s = {.size = sizeof s};
        brio_mesh *mesh;
        brio_certificate c = {0};
        EXPECT(brio_surface(ctx, p, PIXELS, &o, &mesh, &s) == BRIO_OK);
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
        if (keep)
            EXPECT(s.rounding == 0 && s.unrounded == 0 && c.components > 3, "%zu pieces", c.components);
        else
            EXPECT(s.unrounded > PIXELS / 2 && c.components == 1 && c.genus == 0, "%zu pieces, genus %d", c.components,
                   (int)c.genus);
        EXPECT(fabs(s.rounding - (keep ? 0 : 0.4)) < 1e-6);
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

static brio_status unround_frame(brio_context *ctx) {
    static double truth[3 * PIXELS], p[3 * PIXELS];
    brio_rounding r;
    make_frame(PLANES, 0.4, truth, p);
    return brio_unround_samples(ctx, p, PIXELS, NULL, &r);
}

static void failing_memory_leaves_nothing(void) {
    expect_clean_failures(unround_frame);
}

SUITE(test_rounded) {
    RUN(steps_become_slopes);
    RUN(levels_may_be_oblique);
    RUN(exact_planes_are_not_rounded);
    RUN(surface_of_steps_is_one_piece);
    RUN(failing_memory_leaves_nothing);
    return harness_end();
}
