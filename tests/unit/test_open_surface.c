/* Open surfaces: what holds of them without a known shape. */
#include "base/memory.h"
#include "base/rng.h"
#include "dual/spacing.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/labeled_delaunay/axis_agreement.h"
#include "reconstruct/labeled_delaunay/sheet_signs.h"
#include "reconstruct/open_surface/single_fans.h"
#include "same_faces.h"
#include "surface_calls.h"
#include <math.h>

/* --- fans --- */

static size_t count_parts(const uint8_t *part, size_t n, uint8_t which) {
    size_t count = 0;
    for (size_t f = 0; f < n; f++) count += part[f] == which;
    return count;
}

/* Two fans that meet at sample 0, of two triangles and one: a surface that ends there from the start, as where the hull was
 * left out of it. */
static const double bow[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 0, 0, -1, -1, 0};
static const uint32_t bow_faces[] = {0, 4, 5, 0, 1, 2, 0, 2, 3};

static brio_status thin_bow(brio_context *ctx) {
    brio_status status = BRIO_OK;
    brio_triangle_net net = {.ctx = ctx};
    uint8_t part[3] = {BRIO_TRIANGLE_SEEN, BRIO_TRIANGLE_SEEN, BRIO_TRIANGLE_SEEN};
    BRIO_TRY(brio_triangle_net_new(ctx, bow, 6, bow_faces, 3, &net));
    BRIO_TRY(brio_keep_single_fans(&net, part));
    EXPECT(part[0] == BRIO_TRIANGLE_GONE && count_parts(part, 3, BRIO_TRIANGLE_SEEN) == 2, "the longer fan stays");
done:
    brio_triangle_net_free(&net);
    return status;
}

static void fans_of_a_surface_with_a_boundary_meet_at_no_sample(void) {
    brio_context *ctx = new_context();
    EXPECT(thin_bow(ctx) == BRIO_OK);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    expect_clean_failures(thin_bow);
}

/* --- sheets --- */

/* What a scanner far above sees: a wavy ground, and a dome that floats before it and hides what is below. */
enum { MANY = 6000 };
static double scene[3 * MANY];
static size_t num_scene, num_dome;

static void make_scene(void) {
    brio_rng rng = brio_rng_new(3);
    num_scene = num_dome = 0;
    for (size_t i = 0; i < MANY; i++) {
        double *p = scene + 3 * num_scene, x = 4 * brio_rng_double(&rng) - 2, y = 4 * brio_rng_double(&rng) - 2;
        bool dome = hypot(x, y) < 0.9;
        p[0] = x, p[1] = y, p[2] = dome ? 0.6 + 0.8 * sqrt(1 - x * x - y * y) : 0.1 * sin(3 * x) * cos(2 * y);
        num_scene++, num_dome += dome;
    }
}

/* Lies below the dome's rim, where the ground is. */
static bool is_ground(const double *p) {
    return p[2] < 0.5;
}

/* Tells of every eighth axis that outside is below, and of a third of these the contrary. */
static void tell_downwards(const brio_pole_vectors *v, float *told) {
    for (size_t p = 0; p < num_scene; p++)
        told[p] = p % 8 ? 0 : (v->plane[4 * p + 2] < 0) == (p % 3 != 0) ? 1.0f : -1.0f;
}

/* Signs the axes of the scene, as is told or not. */
static void expect_signs_along_sheets(bool is_told) {
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_pole_vectors v;
    double *spacing = malloc(MANY * sizeof *spacing);
    uint8_t *turned = malloc(MANY), *alone = malloc(MANY);
    float *told = malloc(MANY * sizeof *told);
    size_t down[2] = {0}, all[2] = {0};
    make_scene();
    EXPECT(brio_delaunay(ctx, scene, NULL, num_scene, NULL, &t) == BRIO_OK);
    EXPECT(brio_sample_spacing(ctx, t, scene, num_scene, spacing, NULL) == BRIO_OK);
    EXPECT(brio_pole_vectors_find(ctx, t, scene, num_scene, 0.39, &v) == BRIO_OK);
    tell_downwards(&v, told);
    brio_sheet_samples samples = {spacing, 0, is_told ? told : NULL};
    EXPECT(brio_sign_sheets(ctx, &v, &samples, turned, alone) == BRIO_OK);
    for (size_t p = 0; p < num_scene; p++) {
        bool ground = is_ground(scene + 3 * p);
        all[ground]++;
        down[ground] += (v.plane[4 * p + 2] < 0) != turned[p];
    }
    for (int i = 0; i < 2; i++) {
        size_t few = down[i] < all[i] - down[i] ? down[i] : all[i] - down[i];
        EXPECT(all[i] > 500 && few * 50 < all[i], "%zu of %zu look down", down[i], all[i]);
        EXPECT(!is_told || few < down[i], "%zu of %zu look down, as all should", down[i], all[i]);
    }
    brio_pole_vectors_free(ctx, &v);
    brio_triangulation_free(t);
    free(spacing), free(turned), free(alone), free(told);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void signs_agree_along_sheets(void) {
    expect_signs_along_sheets(false);
}

static void sheets_look_where_most_of_what_is_told_points(void) {
    expect_signs_along_sheets(true);
}

static void axes_of_a_circle_and_of_an_edge_agree(void) {
    for (double noise = 0; noise < 0.2; noise += 0.1)
        for (double distance = 1; distance < 4; distance++) {
            for (double along = -0.9; along < 1; along += 0.2)
                for (double mirrored = -0.9; mirrored < 1; mirrored += 0.2) {
                    double w = brio_axis_log_odds(along, mirrored, distance, noise);
                    EXPECT(w == -brio_axis_log_odds(-along, -mirrored, distance, noise), "an axis turned over");
                    EXPECT(fabs(w) <= 7);
                }
            EXPECT(brio_axis_log_odds(0.05, 0.95, distance, noise) > 2, "across an edge the mirror tells");
            EXPECT(brio_axis_log_odds(0.95, 0.95, distance, noise) > 4);
        }
    EXPECT(brio_axis_log_odds(0.95, -0.95, 1, 0.2) > 2 && brio_axis_log_odds(0.95, -0.95, 1, 0) < -2,
           "in noise the plane between close samples is an accident");
}

/* Makes the surface of the scene with a number of threads. */
static brio_mesh *surface_of_scene(int threads, brio_surface_stats *s) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    brio_surface_options o = LABELED_OPTIONS;
    brio_context_set_threads(ctx, threads);
    o.holes = BRIO_HOLES_AUTO;
    make_scene();
    EXPECT(make_labeled(ctx, scene, num_scene, &o, &mesh, NULL, s) == BRIO_OK, "%s", brio_message(ctx));
    return mesh;
}

static void free_with_context(brio_mesh *mesh) {
    brio_context *ctx = mesh->context;
    brio_mesh_free(mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* Both sheets are open, apart, and each looks one way. Labels that know inside and outside alone turn half of one over. */
static void sheets_one_behind_the_other_look_one_way_each(void) {
    brio_surface_stats s = {0};
    brio_mesh *mesh = surface_of_scene(1, &s), *other = surface_of_scene(4, &s);
    double up[2] = {0}, area[2] = {0};
    size_t between = 0;
    EXPECT(s.holes > 0 && s.evidence == 0 && s.told == 0);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *v = mesh->face_vertices + 3 * f;
        const double *p[3];
        size_t ground = 0;
        for (int i = 0; i < 3; i++) p[i] = mesh->vertices + 3 * (size_t)v[i], ground += is_ground(p[i]);
        between += ground % 3 != 0;
        double z = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        area[ground == 3] += fabs(z), up[ground == 3] += z;
    }
    EXPECT(between == 0, "%zu triangles join the sheets", between);
    for (int i = 0; i < 2; i++) EXPECT(fabs(up[i]) > 0.99 * area[i], "%g of %g", up[i], area[i]);
    EXPECT(area[0] / 2 > 0.85 * 2.54 && area[1] / 2 > 0.95 * (16 - 2.54), "areas %g %g", area[0] / 2, area[1] / 2);
    expect_same_faces(mesh, NULL, other);
    free_with_context(mesh);
    free_with_context(other);
}

/* A surface that is known to be open is labeled twice. */
static brio_status make_bowl(brio_context *ctx) {
    static double p[3 * 300];
    brio_mesh *mesh;
    brio_surface_options o = LABELED_OPTIONS;
    brio_surface_stats s = {0};
    o.holes = BRIO_HOLES_AUTO;
    o.confidence = 1;
    sphere_points(1, 300, p);
    for (size_t i = 0; i < 300; i++) p[3 * i + 2] = fabs(p[3 * i + 2]);
    brio_status status = make_labeled(ctx, p, 300, &o, &mesh, NULL, &s);
    EXPECT(status != BRIO_OK || s.holes > 0, "no hole");
    brio_mesh_free(mesh);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(make_bowl);
}

SUITE(test_open_surface) {
    RUN(signs_agree_along_sheets);
    RUN(sheets_look_where_most_of_what_is_told_points);
    RUN(axes_of_a_circle_and_of_an_edge_agree);
    RUN(sheets_one_behind_the_other_look_one_way_each);
    RUN(every_failed_allocation_is_a_status);
    RUN(fans_of_a_surface_with_a_boundary_meet_at_no_sample);
    return harness_end();
}
