/* Generated points: each kind is what it says, point i follows from seed and i; the scan and its truth. */
#include "brio/testdata.h"
#include "base/rng.h"
#include "failing_allocator.h"
#include "iso/iso_surface.h"
#include "testdata/sculpture.h"
#include <float.h>
#include <math.h>
#include <string.h>

static brio_context *ctx;

/* The kinds whose points are independent of each other. */
static const brio_kind random_kinds[] = {BRIO_KIND_CUBE,     BRIO_KIND_BALL,     BRIO_KIND_SPHERE, BRIO_KIND_TORUS,
                                         BRIO_KIND_CYLINDER, BRIO_KIND_CLUSTERS, BRIO_KIND_MOMENT};
enum { RANDOM_KINDS = sizeof random_kinds / sizeof *random_kinds };

static const double PI = 3.14159265358979323846;

static brio_mesh *make(brio_kind kind, size_t n, uint64_t seed) {
    brio_generate_options options = {0};
    brio_mesh *mesh = NULL;
    options.seed = seed;
    EXPECT(brio_generate(ctx, kind, n, &options, &mesh) == BRIO_OK, "%s", brio_message(ctx));
    return mesh;
}

static double norm(double x, double y, double z) {
    return sqrt(x * x + y * y + z * z);
}

/* --- kinds --- */

static void no_points_are_an_empty_mesh(void) {
    for (brio_kind kind = 0; kind < BRIO_KIND_END; kind++) {
        brio_mesh *mesh = make(kind, 0, 1);
        EXPECT(mesh->num_vertices == 0 && mesh->num_faces == 0, "kind %d", (int)kind);
        brio_mesh_free(mesh);
    }
}

static void point_depends_on_seed_and_index_alone(void) {
    for (int k = 0; k < RANDOM_KINDS; k++) {
        brio_kind kind = random_kinds[k];
        brio_mesh *few = make(kind, 100, 7), *many = make(kind, 3000, 7), *other = make(kind, 100, 8);
        brio_context_set_threads(ctx, 1);
        brio_mesh *serial = make(kind, 3000, 7);
        brio_context_set_threads(ctx, 0);
        EXPECT(!memcmp(few->vertices, many->vertices, 300 * sizeof(double)), "kind %d", (int)kind);
        EXPECT(!memcmp(serial->vertices, many->vertices, 9000 * sizeof(double)), "kind %d", (int)kind);
        EXPECT(memcmp(few->vertices, other->vertices, 300 * sizeof(double)), "kind %d", (int)kind);
        brio_mesh_free(few);
        brio_mesh_free(many);
        brio_mesh_free(other);
        brio_mesh_free(serial);
    }
}

/* How far a point is from the set that its kind names. */
static double error_of(brio_kind kind, const double *p) {
    switch (kind) {
    case BRIO_KIND_CUBE:
        return fmax(fmax(fabs(p[0] - 0.5), fabs(p[1] - 0.5)), fabs(p[2] - 0.5)) <= 0.5 ? 0 : 1;
    case BRIO_KIND_BALL:
        return fmax(norm(p[0], p[1], p[2]) - 1, 0);
    case BRIO_KIND_SPHERE:
        return fabs(norm(p[0], p[1], p[2]) - 1);
    case BRIO_KIND_TORUS:
        return fabs(norm(norm(p[0], p[1], 0) - 1, p[2], 0) - 0.4);
    case BRIO_KIND_CYLINDER:
        return fmax(fabs(norm(p[0], p[1], 0) - 1), fabs(p[2]) - 2);
    case BRIO_KIND_CLUSTERS: /* no cluster reaches further out of the cube than the largest radius */
        return fmax(fmax(fmax(fabs(p[0] - 0.5), fabs(p[1] - 0.5)), fabs(p[2] - 0.5)) - 0.6, 0);
    case BRIO_KIND_MOMENT:
        return p[0] >= 0 && p[0] < 1 ? norm(p[1] - p[0] * p[0], p[2] - p[0] * p[0] * p[0], 0) : 1;
    default:
        return 1;
    }
}

static void points_lie_on_their_set(void) {
    for (int k = 0; k < RANDOM_KINDS; k++) {
        brio_kind kind = random_kinds[k];
        brio_mesh *mesh = make(kind, 5000, 3);
        double worst = 0;
        for (size_t i = 0; i < mesh->num_vertices; i++) worst = fmax(worst, error_of(kind, mesh->vertices + 3 * i));
        EXPECT(worst < 1e-14, "kind %d: %g", (int)kind, worst);
        brio_mesh_free(mesh);
    }
}

/* Mean of a function of the points, which a uniform distribution fixes; 200,000 points leave an error below 0.01. */
static double mean_of(brio_kind kind, double (*function)(const double *)) {
    brio_mesh *mesh = make(kind, 200000, 5);
    double sum = 0;
    for (size_t i = 0; i < mesh->num_vertices; i++) sum += function(mesh->vertices + 3 * i);
    sum /= (double)mesh->num_vertices;
    brio_mesh_free(mesh);
    return sum;
}

static double first(const double *p) {
    return p[0];
}
static double second(const double *p) {
    return p[1];
}
static double third(const double *p) {
    return p[2];
}
static double radius_cubed(const double *p) {
    return pow(norm(p[0], p[1], p[2]), 3);
}
static double third_squared(const double *p) {
    return p[2] * p[2];
}
static double is_outer(const double *p) {
    return norm(p[0], p[1], 0) > 1;
}

static void points_are_uniform(void) {
    EXPECT(fabs(mean_of(BRIO_KIND_CUBE, first) - 0.5) < 0.01);
    EXPECT(fabs(mean_of(BRIO_KIND_CUBE, third_squared) - 1.0 / 3) < 0.01);
    EXPECT(fabs(mean_of(BRIO_KIND_BALL, radius_cubed) - 0.5) < 0.01);
    EXPECT(fabs(mean_of(BRIO_KIND_BALL, second)) < 0.01);
    EXPECT(fabs(mean_of(BRIO_KIND_SPHERE, third_squared) - 1.0 / 3) < 0.01);
    EXPECT(fabs(mean_of(BRIO_KIND_SPHERE, first)) < 0.01);
    EXPECT(fabs(mean_of(BRIO_KIND_TORUS, is_outer) - (0.5 + 0.4 / PI)) < 0.01); /* the outer half's share of the area */
    EXPECT(fabs(mean_of(BRIO_KIND_TORUS, second)) < 0.01);
    EXPECT(fabs(mean_of(BRIO_KIND_CYLINDER, third_squared) - 4.0 / 3) < 0.02);
    EXPECT(fabs(mean_of(BRIO_KIND_CYLINDER, third)) < 0.02);
    EXPECT(fabs(mean_of(BRIO_KIND_MOMENT, first) - 0.5) < 0.01);
    EXPECT(fabs(mean_of(BRIO_KIND_MOMENT, third) - 0.25) < 0.01);
}

/* Distance from point i to the nearest other one. */
static double gap_of(const brio_mesh *mesh, size_t i) {
    double nearest = INFINITY;
    const double *p = mesh->vertices + 3 * i;
    for (size_t j = 0; j < mesh->num_vertices; j++) {
        const double *q = mesh->vertices + 3 * j;
        if (j != i) nearest = fmin(nearest, norm(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    }
    return nearest;
}

/* With 40 points a cluster the gaps are some fifth of its radius: as many points in each decade of it. */
static void gaps_in_clusters_spread_evenly_over_six_decades(void) {
    enum { POINTS = 10240, PROBED = 1024 };
    brio_mesh *mesh = make(BRIO_KIND_CLUSTERS, POINTS, 1);
    int decades[6] = {0};
    for (size_t i = 0; i < PROBED; i++) {
        int decade = (int)floor(-log10(5 * gap_of(mesh, i))) - 1;
        if (decade >= 0 && decade < 6) decades[decade]++;
    }
    for (int d = 0; d < 6; d++)
        EXPECT(abs(decades[d] - PROBED / 6) < PROBED / 12, "decade %d: %d points", d, decades[d]);
    brio_mesh_free(mesh);
}

static void grid_is_the_smallest_that_has_room(void) {
    brio_mesh *mesh = make(BRIO_KIND_GRID, 27, 1);
    EXPECT(mesh->vertices[0] == 0 && mesh->vertices[5] == 1 && mesh->vertices[3 * 26] == 2);
    brio_mesh_free(mesh);
    mesh = make(BRIO_KIND_GRID, 28, 1);
    const double *last = mesh->vertices + 3 * 27; /* of a grid of 4^3, x slowest */
    EXPECT(last[0] == 1 && last[1] == 2 && last[2] == 3, "%g %g %g", last[0], last[1], last[2]);
    brio_mesh_free(mesh);
}

/* A frame of 160 x 120: depths are whole, columns are planes through the camera, rays see the near before the far. */
static void depth_frame_has_whole_depths_along_its_rays(void) {
    enum { WIDTH = 160, HEIGHT = 120, MOST = 4400 };
    static bool seen[MOST];
    brio_mesh *frame = make(BRIO_KIND_DEPTH, (size_t)WIDTH * HEIGHT, 3), *other = make(BRIO_KIND_DEPTH, 1000, 4);
    size_t broken = 0, depths = 0, near = 0;
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        const double *p = frame->vertices + 3 * i, *top = frame->vertices + 3 * (i % WIDTH);
        broken += p[2] != floor(p[2]) || p[2] < 500 || p[2] >= MOST;
        broken += fabs(p[0] / p[2] - top[0] / top[2]) > 1e-12;
        if (p[2] < 500 || p[2] >= MOST) continue;
        depths += !seen[(size_t)p[2]];
        seen[(size_t)p[2]] = true;
        near += p[2] < 3000;
    }
    EXPECT(broken == 0, "%zu points", broken);
    EXPECT(depths > 100 && depths < 3000, "%zu depths", depths);
    EXPECT(near > 1000, "%zu points", near);
    EXPECT(memcmp(frame->vertices, other->vertices, 3000 * sizeof(double)));
    brio_mesh_free(frame);
    brio_mesh_free(other);
}

static void bad_options_are_refused(void) {
    brio_generate_options options = {0};
    brio_mesh *mesh;
    EXPECT(brio_generate(ctx, BRIO_KIND_END, 5, NULL, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
    options.views = -1;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, 5, &options, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
    options.views = 65536;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, 5, &options, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
    options.views = 1;
    options.noise = NAN;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, 5, &options, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
    brio_status refused = SIZE_MAX > UINT32_MAX ? BRIO_ERR_NO_MEMORY : BRIO_ERR_TOO_LARGE; /* no array has them there */
    EXPECT(brio_generate(ctx, BRIO_KIND_CUBE, SIZE_MAX / 2, NULL, &mesh) == refused && !mesh);
    EXPECT(brio_generate_truth(ctx, SIZE_MAX, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
}

/* A finite noise whose product with the spacing overflowed gave infinite coordinates and BRIO_OK. */
static void scan_whose_noise_overflows_is_refused(void) {
    brio_generate_options options = {.size = sizeof options, .seed = 1, .noise = DBL_MAX, .views = 2};
    brio_mesh *mesh;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, 50, &options, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(strstr(brio_message(ctx), "noise 1.79769e+308"), "%s", brio_message(ctx));
    options.noise = 1e300;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, 50, &options, &mesh) == BRIO_OK && mesh->num_vertices > 0);
    for (size_t i = 0; mesh && i < 3 * mesh->num_vertices; i++) EXPECT(isfinite(mesh->vertices[i]));
    brio_mesh_free(mesh);
}

/* --- the sculpture --- */

static void sculpture_function_never_exceeds_the_distance(void) {
    brio_mesh *mesh = make(BRIO_KIND_CUBE, 40000, 2);
    double steepest = 0;
    for (size_t i = 0; i < mesh->num_vertices; i++) {
        double p[3], q[3];
        for (int k = 0; k < 3; k++) p[k] = 6 * mesh->vertices[3 * i + k] - 3;
        for (int k = 0; k < 3; k++) {
            memcpy(q, p, sizeof q);
            q[k] += 1e-4;
            double slope = (brio_sculpture(q, NULL) - brio_sculpture(p, NULL)) / 1e-4;
            steepest = fmax(steepest, fabs(slope));
        }
    }
    EXPECT(steepest < 1 + 1e-9, "%g", steepest);
    brio_mesh_free(mesh);
}

static void truth_is_a_certified_surface_of_genus_3(void) {
    brio_mesh *mesh;
    brio_certificate c = {0};
    for (size_t resolution = 40; resolution <= 160; resolution *= 2) {
        EXPECT(brio_generate_truth(ctx, resolution == 160 ? 0 : resolution, &mesh) == BRIO_OK);
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
        EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 3, "resolution %zu", resolution);
        EXPECT(c.volume > 2.7 && c.volume < 3.1 && c.area > 23 && c.area < 25, "%g %g", c.volume, c.area);
        double worst = 0;
        for (size_t i = 0; i < mesh->num_vertices; i++)
            worst = fmax(worst, fabs(brio_sculpture(mesh->vertices + 3 * i, NULL)));
        EXPECT(worst < 1e-6, "%g", worst);
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
}

/* --- the scan --- */

/* Grids of 1 to 3 cells have no node inside the sculpture: the closed mesh was one without faces. */
static void truth_too_coarse_to_have_faces_is_refused(void) {
    brio_mesh *mesh;
    for (size_t resolution = 1; resolution < 4; resolution++) {
        EXPECT(brio_generate_truth(ctx, resolution, &mesh) == BRIO_ERR_ARGUMENT && !mesh, "resolution %zu", resolution);
        EXPECT(strstr(brio_message(ctx), "4 to 32768"), "%s", brio_message(ctx));
        brio_mesh_free(mesh);
    }
    for (size_t resolution = 4; resolution < 40; resolution++) {
        brio_certificate c = {0};
        EXPECT(brio_generate_truth(ctx, resolution, &mesh) == BRIO_OK);
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK && c.closed && c.manifold && c.oriented,
               "resolution %zu", resolution);
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
}

static void scan_has_about_n_points_in_scan_order(void) {
    static const size_t sizes[] = {300, 3000, 30000};
    for (size_t s = 0; s < 3; s++) {
        brio_mesh *mesh = make(BRIO_KIND_SCAN, sizes[s], 1);
        const brio_property *view = brio_mesh_property(mesh, "view");
        double ratio = (double)mesh->num_vertices / (double)sizes[s];
        EXPECT(fabs(ratio - 1) < 0.2 / sqrt((double)sizes[s] / 300), "%zu of %zu", mesh->num_vertices, sizes[s]);
        EXPECT(view && view->type == BRIO_SCALAR_UINT16);
        bool ascends = brio_property_value(view, 0) == 0;
        for (size_t i = 1; i < mesh->num_vertices; i++)
            ascends &= brio_property_value(view, i) >= brio_property_value(view, i - 1);
        EXPECT(ascends && brio_property_value(view, mesh->num_vertices - 1) == 11);
        brio_mesh_free(mesh);
    }
}

static void scan_follows_from_its_seed(void) {
    brio_mesh *a = make(BRIO_KIND_SCAN, 2000, 4), *other = make(BRIO_KIND_SCAN, 2000, 5);
    brio_context_set_threads(ctx, 1);
    brio_mesh *b = make(BRIO_KIND_SCAN, 2000, 4);
    brio_context_set_threads(ctx, 0);
    size_t n = a->num_vertices;
    EXPECT(b->num_vertices == n && !memcmp(a->vertices, b->vertices, 3 * n * sizeof(double)));
    EXPECT(other->num_vertices != n || memcmp(a->vertices, other->vertices, 3 * n * sizeof(double)));
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_mesh_free(other);
}

/* Root of the mean square of the sculpture's function over a scan of 5,000 points. */
static double scan_error(double noise) {
    brio_generate_options options = {0};
    brio_mesh *mesh;
    double sum = 0;
    options.noise = noise;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, 5000, &options, &mesh) == BRIO_OK);
    for (size_t i = 0; i < mesh->num_vertices; i++) sum += pow(brio_sculpture(mesh->vertices + 3 * i, NULL), 2);
    sum = sqrt(sum / (double)mesh->num_vertices);
    brio_mesh_free(mesh);
    return sum;
}

static void scan_noise_is_a_share_of_the_spacing(void) {
    double none = scan_error(-1), some = scan_error(0.1), more = scan_error(0.2);
    EXPECT(none < 1e-6, "%g", none);
    EXPECT(some > 0.002 && some < 0.02, "%g", some); /* 12 views of spacing about 0.1 */
    EXPECT(fabs(more / some - 2) < 0.2, "%g", more / some);
}

static void twelve_views_cover_nearly_everything(void) {
    brio_mesh *truth, *scan = make(BRIO_KIND_SCAN, 10000, 1);
    EXPECT(brio_generate_truth(ctx, 24, &truth) == BRIO_OK);
    double spacing = sqrt(23.9 / (double)scan->num_vertices);
    size_t far = 0;
    for (size_t i = 0; i < truth->num_vertices; i++) {
        const double *p = truth->vertices + 3 * i;
        double nearest = INFINITY;
        for (size_t j = 0; j < scan->num_vertices; j++) {
            const double *q = scan->vertices + 3 * j;
            double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
            double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if (square < nearest) nearest = square;
        }
        far += sqrt(nearest) > 2 * spacing;
    }
    EXPECT((double)far < 0.005 * (double)truth->num_vertices, "%zu of %zu", far, truth->num_vertices);
    brio_mesh_free(truth);
    brio_mesh_free(scan);
}

/* --- iso-surfaces --- */

static double ball(const double *p, const void *user) {
    (void)user;
    return norm(p[0], p[1], p[2]) - 1;
}

/* On the nodes of an integer grid this is often zero. */
static double octahedron(const double *p, const void *user) {
    (void)user;
    return fabs(p[0]) + fabs(p[1]) + fabs(p[2]) - 2;
}

static double noise_of_nodes(const double *p, const void *user) {
    int64_t key = (int64_t)p[0] + 64 * (int64_t)p[1] + 4096 * (int64_t)p[2];
    bool border = fmax(fmax(fabs(p[0]), fabs(p[1])), fabs(p[2])) >= 8;
    bool node = p[0] == floor(p[0]) && p[1] == floor(p[1]) && p[2] == floor(p[2]);
    return border || !node || brio_mix((uint64_t)key ^ *(const uint64_t *)user) & 1 ? 1 : -1;
}

static brio_certificate certificate_of_iso_surface(brio_implicit_fn value, const void *user, uint32_t cells) {
    brio_implicit_grid grid = {value, user, {-8, -8, -8}, 16.0 / cells, {cells, cells, cells}};
    brio_mesh *mesh;
    brio_certificate c = {0};
    EXPECT(brio_marched_surface(ctx, &grid, &mesh) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    brio_mesh_free(mesh);
    return c;
}

static void ball_has_its_area_and_volume(void) {
    brio_certificate c = certificate_of_iso_surface(ball, NULL, 160);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 0);
    EXPECT(fabs(c.volume / (4 * PI / 3) - 1) < 0.01 && fabs(c.area / (4 * PI) - 1) < 0.01, "%g %g", c.volume, c.area);
    brio_certificate_free(&c);
}

static void zero_at_nodes_and_random_signs_still_close(void) {
    brio_certificate c = certificate_of_iso_surface(octahedron, NULL, 16);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 0);
    brio_certificate_free(&c);
    for (uint64_t seed = 0; seed < 3; seed++) {
        c = certificate_of_iso_surface(noise_of_nodes, &(uint64_t){seed << 40}, 16);
        EXPECT(c.closed && c.manifold && c.oriented && c.genus > 100, "%d %d %d %zu %d", c.closed, c.manifold,
               c.oriented, c.components, (int)c.genus);
        brio_certificate_free(&c);
    }
}

static void function_negative_on_the_border_is_refused(void) {
    brio_implicit_grid grid = {ball, NULL, {-1, -1, -0.5}, 0.1, {20, 20, 20}};
    brio_mesh *mesh;
    EXPECT(brio_marched_surface(ctx, &grid, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
}

static void empty_iso_surface_has_no_faces(void) {
    brio_implicit_grid grid = {ball, NULL, {3, 3, 3}, 0.1, {5, 4, 3}};
    brio_mesh *mesh;
    EXPECT(brio_marched_surface(ctx, &grid, &mesh) == BRIO_OK && mesh->num_faces == 0 && mesh->num_vertices == 0);
    brio_mesh_free(mesh);
}

/* --- memory and cancelling --- */

static brio_status make_scan(brio_context *context) {
    brio_generate_options options = {.size = sizeof options, .seed = 1, .noise = 0.1, .views = 2};
    brio_mesh *mesh = NULL;
    brio_status status = brio_generate(context, BRIO_KIND_SCAN, 40, &options, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static brio_status make_sphere(brio_context *context) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_generate(context, BRIO_KIND_SPHERE, 40, NULL, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static brio_status make_truth(brio_context *context) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_generate_truth(context, 10, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static void no_memory_is_a_status(void) {
    expect_clean_failures(make_sphere);
    expect_clean_failures(make_truth);
    expect_clean_failures(make_scan);
}

static int cancel(const char *stage, double fraction, void *user) {
    (void)stage;
    (void)user;
    return fraction > 0.4;
}

static void cancelling_leaves_nothing(void) {
    brio_mesh *mesh;
    size_t before = brio_context_memory(ctx);
    brio_context_set_progress(ctx, cancel, NULL);
    EXPECT(brio_generate(ctx, BRIO_KIND_CUBE, 1000000, NULL, &mesh) == BRIO_ERR_CANCELLED && !mesh);
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, 1000, NULL, &mesh) == BRIO_ERR_CANCELLED && !mesh);
    EXPECT(brio_generate_truth(ctx, 20, &mesh) == BRIO_ERR_CANCELLED && !mesh);
    EXPECT(brio_context_memory(ctx) == before);
    brio_context_set_progress(ctx, NULL, NULL);
}

SUITE(test_generate) {
    brio_context_new(NULL, &ctx);
    RUN(no_points_are_an_empty_mesh);
    RUN(point_depends_on_seed_and_index_alone);
    RUN(points_lie_on_their_set);
    RUN(points_are_uniform);
    RUN(gaps_in_clusters_spread_evenly_over_six_decades);
    RUN(grid_is_the_smallest_that_has_room);
    RUN(depth_frame_has_whole_depths_along_its_rays);
    RUN(bad_options_are_refused);
    RUN(scan_whose_noise_overflows_is_refused);
    RUN(truth_too_coarse_to_have_faces_is_refused);
    RUN(sculpture_function_never_exceeds_the_distance);
    RUN(truth_is_a_certified_surface_of_genus_3);
    RUN(scan_has_about_n_points_in_scan_order);
    RUN(scan_follows_from_its_seed);
    RUN(scan_noise_is_a_share_of_the_spacing);
    RUN(twelve_views_cover_nearly_everything);
    RUN(ball_has_its_area_and_volume);
    RUN(zero_at_nodes_and_random_signs_still_close);
    RUN(function_negative_on_the_border_is_refused);
    RUN(empty_iso_surface_has_no_faces);
    RUN(no_memory_is_a_status);
    RUN(cancelling_leaves_nothing);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
