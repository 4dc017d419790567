/* Noise of samples: nearest points, how much noise is found, and the power crust of samples that were smoothed. */
#include "failing_allocator.h"
#include "harness.h"
#include "query/nearest_points.h"
#include "points.h"
#include "surface_calls.h"
#include "reconstruct/noise/sample_noise.h"
#include "reconstruct/noise/smooth_surface.h"

enum { N = 3000 };
static const double SPHERE_AREA = 12.566370614359172, TORUS_AREA = 15.791367041742973;

static double gauss(brio_rng *rng) {
    double u = 1 - brio_rng_double(rng), v = brio_rng_double(rng);
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

/* Distance from the surface: the unit sphere, or the torus of radii 1 and 0.4. */
static double sphere_distance(const double *p) {
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1;
}

static double torus_distance(const double *p) {
    double ring = sqrt(p[0] * p[0] + p[1] * p[1]) - 1;
    return sqrt(ring * ring + p[2] * p[2]) - 0.4;
}

/* Moves points by noise of a standard deviation, in all directions. */
static void disturb(uint64_t seed, size_t n, double sigma, double *p) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < 3 * n; i++) p[i] += sigma * gauss(&rng);
}

static double mean_distance(const double *p, size_t n, double (*distance)(const double *)) {
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += fabs(distance(p + 3 * i));
    return sum / (double)n;
}

static double level_of(brio_context *ctx, const double *p, size_t n) {
    double level = -1;
    EXPECT(brio_noise_level(ctx, p, n, &level) == BRIO_OK);
    return level;
}

/* --- nearest points --- */

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void expect_nearest(const brio_point_tree *tree, const double *points, size_t n, const double *p, size_t k) {
    brio_near_point near[BRIO_NEAR_ROOM];
    double *square = malloc(n * sizeof *square);
    for (size_t i = 0; i < n; i++) {
        double d[3] = {points[3 * i] - p[0], points[3 * i + 1] - p[1], points[3 * i + 2] - p[2]};
        square[i] = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    }
    qsort(square, n, sizeof *square, compare_doubles);
    double bound = k % 2 && k <= n ? square[k - 1] : INFINITY;
    size_t found = brio_nearest_points(tree, p, k, bound, near);
    EXPECT(found == (k < n ? k : n), "%zu of %zu, %zu wanted", found, n, k);
    brio_sort_near_points(tree, near, found);
    for (size_t i = 0; i < found; i++) EXPECT(near[i].square == square[i], "neighbour %zu", i);
    free(square);
}

static void nearest_points_are_those_of_exhaustive_search(void) {
    static double p[3 * 3000];
    brio_context *ctx = new_context();
    for (uint64_t trial = 0; trial < 40; trial++) {
        size_t n = trial < 30 ? trial + 1 : 3000;
        brio_rng rng = brio_rng_new(trial);
        if (trial % 3 == 0)
            integer_points(trial, n, 1 + (uint32_t)trial % 7, p);
        else if (trial % 3 == 1)
            clustered_points(trial, n, p);
        else
            sphere_points(trial, n, p);
        brio_point_tree tree;
        EXPECT(brio_point_tree_new(ctx, p, n, &tree) == BRIO_OK);
        for (int i = 0; i < 10; i++)
            expect_nearest(&tree, p, n, p + 3 * brio_rng_below(&rng, (uint32_t)n), 1 + brio_rng_below(&rng, 64));
        expect_nearest(&tree, p, n, (double[3]){0, 0, 0}, 20);
        brio_point_tree_free(ctx, &tree);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- how much --- */

static void level_is_that_of_the_noise(void) {
    static double p[3 * N];
    brio_context *ctx = new_context();
    for (int i = 0; i < 6; i++) {
        double sigma = 0.15 + 0.05 * (i / 2), area = i % 2 ? SPHERE_AREA : TORUS_AREA;
        (i % 2 ? sphere_points : torus_points)((uint64_t)i, N, p);
        disturb((uint64_t)i + 100, N, sigma * sqrt(area / N), p);
        double level = level_of(ctx, p, N); /* six neighbours are nearer than sqrt(area / n) on the average by little */
        EXPECT(level > 0.8 * sigma && level < 1.2 * sigma, "%g found, %g there", level, sigma);
    }
    brio_context_free(ctx);
}

static void box_points(uint64_t seed, size_t n, double *p) {
    brio_rng rng = brio_rng_new(seed);
    uniform_points(seed + 1, n, p);
    for (size_t i = 0; i < n; i++) p[3 * i + brio_rng_below(&rng, 3)] = brio_rng_below(&rng, 2);
}

static void no_noise_in_shapes(void) {
    static void (*const shapes[])(uint64_t, size_t, double *) = {sphere_points, torus_points, box_points};
    static double p[3 * N];
    brio_context *ctx = new_context();
    for (size_t n = 200; n <= N; n = n * 3 / 2) /* sparse ones are far from their pieces of surface, too */
        for (int i = 0; i < 3; i++) {
            shapes[i](n, n, p);
            EXPECT(level_of(ctx, p, n) == 0, "shape %d, %zu points: %g", i, n, level_of(ctx, p, n));
        }
    brio_context_free(ctx);
}

static void no_noise_where_there_is_no_surface(void) {
    static double p[3 * N];
    brio_context *ctx = new_context();
    uniform_points(3, N, p);
    EXPECT(level_of(ctx, p, N) == 0, "in a cube: %g", level_of(ctx, p, N));
    size_t side = 14, n = 0;
    for (size_t i = 0; i < side * side * side; i++, n++)
        p[3 * n] = (double)(i % side), p[3 * n + 1] = (double)(i / side % side),
              p[3 * n + 2] = (double)(i / side / side);
    EXPECT(level_of(ctx, p, n) == 0, "on a lattice: %g", level_of(ctx, p, n));
    for (size_t i = 0; i < N; i++) p[3 * i] = (double)i, p[3 * i + 1] = p[3 * i + 2] = 0;
    EXPECT(level_of(ctx, p, N) == 0, "on a line");
    for (size_t i = 0; i < 3 * N; i++) p[i] = 1;
    EXPECT(level_of(ctx, p, N) == 0, "at one position");
    EXPECT(level_of(ctx, p, 1) == 0 && level_of(ctx, p, 0) == 0);
    brio_context_free(ctx);
}

/* --- walls --- */

/* A jittered grid of `side` by `side` points, one spacing apart. */
static void add_sheet(brio_rng *rng, size_t side, double z, double *p) {
    for (size_t i = 0; i < side * side; i++) {
        p[3 * i] = (double)(i % side) + 0.7 * brio_rng_double(rng);
        p[3 * i + 1] = (double)(i / side) + 0.7 * brio_rng_double(rng);
        p[3 * i + 2] = z;
    }
}

enum { SIDE = 40 };

/* Two sheets, or one if they are not apart. Returns the number of points. */
static size_t make_wall(uint64_t seed, double apart, double sigma, double *p) {
    brio_rng rng = brio_rng_new(seed);
    size_t n = 0;
    for (int i = 0; i < (apart > 0 ? 2 : 1); i++, n += SIDE * SIDE) add_sheet(&rng, SIDE, i * apart, p + 3 * n);
    disturb(seed + 1, n, sigma, p);
    return n;
}

static brio_least_scatter scatter_of(brio_context *ctx, const double *p, size_t n) {
    brio_least_scatter s = {-1, false};
    EXPECT(brio_least_noise(ctx, p, n, &s) == BRIO_OK);
    return s;
}

/* A thin wall is no noise: of exact points it has none, and of points with noise no more than one sheet of them. */
static void thin_walls_are_no_noise(void) {
    static const double apart[] = {0.5, 0.7, 1, 1.5, 2, 3, 5};
    static double p[6 * SIDE * SIDE];
    brio_context *ctx = new_context();
    for (size_t i = 0; i < sizeof apart / sizeof *apart; i++) {
        size_t n = make_wall(i, apart[i], 0, p);
        brio_least_scatter s = scatter_of(ctx, p, n);
        EXPECT(s.level < 1e-6, "%g apart: noise %g", apart[i], s.level);
        EXPECT(s.layered || apart[i] > 2, "%g apart", apart[i]);
        EXPECT(level_of(ctx, p, n) == 0, "%g apart: %g", apart[i], level_of(ctx, p, n));
        n = make_wall(i, apart[i], 0.1, p);
        s = scatter_of(ctx, p, n);
        EXPECT(s.level > 0.01 && s.level < 0.085, "%g apart: noise %g of 0.1", apart[i], s.level);
    }
    for (size_t i = 2; i < 5; i++) EXPECT(scatter_of(ctx, p, make_wall(i, apart[i], 0.3, p)).layered);
    brio_context_free(ctx);
}

/* The noise of one sheet is noise, whatever its distribution, and one sheet has no layers. */
static void noise_of_one_sheet_has_no_layers(void) {
    static double p[6 * SIDE * SIDE];
    brio_context *ctx = new_context();
    for (uint64_t i = 1; i <= 6; i++) { /* above, no surface is visible */
        double sigma = 0.1 * (double)i;
        size_t n = make_wall(i, 0, sigma, p);
        brio_least_scatter s = scatter_of(ctx, p, n);
        EXPECT(!s.layered && s.level > 0.3 * sigma && s.level < 0.7 * sigma, "%g of %g", s.level, sigma);
        brio_rng rng = brio_rng_new(i);
        n = make_wall(i, 0, 0, p);
        for (size_t k = 0; k < n; k++) p[3 * k + 2] += sigma * sqrt(12) * (brio_rng_double(&rng) - 0.5);
        s = scatter_of(ctx, p, n);
        EXPECT(!s.layered && s.level > 0.3 * sigma && s.level < 0.8 * sigma, "uniform: %g of %g", s.level, sigma);
    }
    brio_context_free(ctx);
}

/* --- less --- */

static void smoothing_does_not_depend_on_order_threads_or_duplicates(void) {
    static double p[3 * N], q[3 * N], one[3 * N], many[3 * N];
    static size_t to[N];
    brio_context *ctx = new_context();
    torus_points(5, N, p);
    disturb(6, N, 0.01, p);
    for (size_t i = 0; i < N; i += 10) memcpy(p + 3 * i, p + 3 * ((i + 7) % N), 3 * sizeof *p);
    for (size_t i = 0; i < N / 2; i++) /* many neighbours at one distance */
        for (size_t k = 0; k < 3; k++) p[3 * i + k] = floor(p[3 * i + k] * 64) / 64;
    shuffle_points(7, N, p, q, to);
    EXPECT(level_of(ctx, p, N) == level_of(ctx, q, N) && level_of(ctx, p, N) > 0);
    memcpy(one, p, sizeof p);
    memcpy(many, q, sizeof q);
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_smooth_samples(ctx, one, N) == BRIO_OK);
    brio_context_set_threads(ctx, 3);
    EXPECT(brio_smooth_samples(ctx, many, N) == BRIO_OK);
    size_t differ = 0;
    for (size_t i = 0; i < N; i++) differ += memcmp(one + 3 * i, many + 3 * to[i], 3 * sizeof *one) != 0;
    EXPECT(differ == 0, "%zu points differ", differ);
    brio_context_free(ctx);
}

static void smoothing_keeps_quadratic_shapes(void) {
    static double p[3 * N], q[3 * N];
    brio_context *ctx = new_context();
    sphere_points(8, N, p);
    memcpy(q, p, sizeof p);
    EXPECT(brio_smooth_samples(ctx, q, N) == BRIO_OK);
    double off = mean_distance(q, N, sphere_distance);
    EXPECT(off < 1e-4, "%g", off); /* the distance of neighbours is 0.07 */
    EXPECT(memcmp(p, q, sizeof p) != 0);
    for (size_t i = 0; i < 3 * N; i++) p[i] = q[i] = i % 3 ? 0.5 : 0.25;
    EXPECT(brio_smooth_samples(ctx, q, N) == BRIO_OK && !memcmp(p, q, sizeof p), "one position");
    brio_context_free(ctx);
}

/* --- the crust --- */

static brio_mesh *crust(brio_context *ctx, const double *p, size_t n, brio_noise noise, brio_surface_stats *s) {
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *mesh = NULL;
    o.noise = noise;
    EXPECT(make_crust(ctx, p, n, &o, &mesh, NULL, s) == BRIO_OK, "%s", brio_message(ctx));
    return mesh;
}

/* The middles of the faces, each as much as the others, against the true surface. */
static double crust_distance(const brio_mesh *mesh, double (*distance)(const double *)) {
    double sum = 0;
    for (size_t f = 0; f < mesh->num_faces; f++) {
        double middle[3] = {0, 0, 0};
        uint64_t begin = mesh->face_offsets[f], end = mesh->face_offsets[f + 1];
        for (uint64_t i = begin; i < end; i++)
            for (size_t k = 0; k < 3; k++)
                middle[k] += mesh->vertices[3 * (size_t)mesh->face_vertices[i] + k] / (double)(end - begin);
        sum += fabs(distance(middle));
    }
    return sum / (double)mesh->num_faces;
}

static void check_noisy_crust(brio_context *ctx, const double *p, double sigma, size_t genus,
                              double (*distance)(const double *)) {
    brio_surface_stats kept = {0}, smoothed = {.size = sizeof smoothed};
    brio_certificate c = {0};
    brio_mesh *rough = crust(ctx, p, N, BRIO_NOISE_KEEP, &kept), *calm = crust(ctx, p, N, BRIO_NOISE_AUTO, &smoothed);
    EXPECT(kept.noise == 0 && !kept.smoothed && smoothed.noise > 0 && smoothed.smoothed);
    double before = crust_distance(rough, distance), after = crust_distance(calm, distance);
    EXPECT(before > 0.5 * sigma && after < 0.35 * sigma, "%g and %g sigma", before / sigma, after / sigma);
    EXPECT(smoothed.poles.energy < 0.2 * kept.poles.energy, "%g and %g", kept.poles.energy, smoothed.poles.energy);
    EXPECT(brio_mesh_certificate(ctx, calm, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == (int64_t)genus);
    brio_certificate_free(&c);
    brio_mesh_free(rough);
    brio_mesh_free(calm);
}

static void crust_of_noisy_samples_runs_through_their_middle(void) {
    static double p[3 * N];
    brio_context *ctx = new_context();
    double sigma = 0.25 * sqrt(SPHERE_AREA / N);
    sphere_points(9, N, p);
    disturb(10, N, sigma, p);
    check_noisy_crust(ctx, p, sigma, 0, sphere_distance);
    torus_points(11, N, p);
    disturb(12, N, sigma, p);
    check_noisy_crust(ctx, p, sigma, 1, torus_distance);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void crust_of_clean_samples_is_the_exact_one(void) {
    static double p[3 * N];
    brio_context *ctx = new_context();
    brio_surface_stats s = {0};
    torus_points(13, N, p);
    brio_mesh *kept = crust(ctx, p, N, BRIO_NOISE_KEEP, NULL), *found = crust(ctx, p, N, BRIO_NOISE_AUTO, &s);
    EXPECT(s.noise == 0 && !s.smoothed && kept->num_vertices == found->num_vertices &&
           !memcmp(kept->vertices, found->vertices, 3 * kept->num_vertices * sizeof *kept->vertices));
    brio_mesh *smooth = crust(ctx, p, N, BRIO_NOISE_SMOOTH, &s);
    EXPECT(s.noise == 0 && s.smoothed);
    brio_mesh_free(kept);
    brio_mesh_free(found);
    brio_mesh_free(smooth);
    brio_context_free(ctx);
}

static void solids_keep_the_samples(void) {
    static double p[3 * N];
    brio_context *ctx = new_context();
    brio_surface_options o = CRUST_OPTIONS;
    brio_surface_stats s = {0};
    brio_mesh *mesh;
    sphere_points(14, N, p);
    disturb(15, N, 0.01, p);
    brio_mesh *solid = crust(ctx, p, N, BRIO_NOISE_AUTO, &s);
    EXPECT(s.smoothed);
    o.poles.solid = solid;
    EXPECT(make_crust(ctx, p, N, &o, &mesh, NULL, &s) == BRIO_OK && !s.smoothed);
    brio_mesh_free(mesh);
    o.noise = BRIO_NOISE_END;
    EXPECT(make_crust(ctx, p, N, &o, &mesh, NULL, &s) == BRIO_ERR_ARGUMENT);
    o.noise = BRIO_NOISE_AUTO;
    brio_mesh_free(solid);
    EXPECT(brio_mesh_new(ctx, &solid) == BRIO_OK);
    o.poles.solid = solid;
    EXPECT(make_crust(ctx, p, N, &o, &mesh, NULL, &s) == BRIO_ERR_NO_ANSWER, "%s", brio_message(ctx));
    brio_mesh_free(solid);
    brio_context_free(ctx);
}

static void medial_axis_of_noisy_samples_is_that_of_smoothed_ones(void) {
    static double p[3 * N];
    brio_context *ctx = new_context();
    brio_power_shape_options o = {0};
    brio_power_shape_stats s = {0};
    brio_mesh *shape;
    double mean[2] = {0, 0};
    sphere_points(16, N, p);
    disturb(17, N, 0.01, p);
    for (int i = 0; i < 2; i++) {
        o.noise = i ? BRIO_NOISE_AUTO : BRIO_NOISE_KEEP;
        EXPECT(brio_power_shape(ctx, p, N, &o, &shape, NULL, &s) == BRIO_OK && s.smoothed == (size_t)i &&
               (s.noise > 0) == i);
        for (size_t v = 0; v < shape->num_vertices; v++)
            mean[i] += (1 + sphere_distance(shape->vertices + 3 * v)) / (double)shape->num_vertices;
        brio_mesh_free(shape);
    }
    EXPECT(mean[1] < 0.7 * mean[0], "%g and %g from the centre", mean[0], mean[1]);
    brio_context_free(ctx);
}

/* --- failures --- */

static brio_status level_and_smooth(brio_context *ctx) {
    static double p[3 * 1000];
    double level;
    sphere_points(18, 1000, p);
    disturb(19, 1000, 0.02, p);
    brio_status status = brio_noise_level(ctx, p, 1000, &level);
    return status == BRIO_OK ? brio_smooth_samples(ctx, p, 1000) : status;
}

static void failing_memory_leaves_nothing(void) {
    expect_clean_failures(level_and_smooth);
}

static int stop(const char *stage, double fraction, void *user) {
    (void)fraction;
    (void)user;
    return !strcmp(stage, "noise");
}

static void smoothing_can_be_cancelled(void) {
    static double p[3 * N];
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    sphere_points(20, N, p);
    disturb(21, N, 0.01, p);
    brio_context_set_progress(ctx, stop, NULL);
    EXPECT(make_crust(ctx, p, N, NULL, &mesh, NULL, NULL) == BRIO_ERR_CANCELLED && !mesh);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* A limb as thin as the rings of neighbours are wide: a tube with few vertices round it, and noise. */
enum { ROUND = 10, LONG = 60 };

static double radial(const double *p, const double *d) {
    return p[0] * d[0] + p[1] * d[1];
}

static double facing(const double *points, const uint32_t *v) {
    double u[3], w[3], n[3], centre[2] = {0, 0};
    for (int k = 0; k < 3; k++) {
        u[k] = points[3 * v[1] + k] - points[3 * v[0] + k];
        w[k] = points[3 * v[2] + k] - points[3 * v[0] + k];
    }
    n[0] = u[1] * w[2] - u[2] * w[1], n[1] = u[2] * w[0] - u[0] * w[2];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) centre[k] += points[3 * v[i] + k];
    return radial(centre, n);
}

static void a_limb_is_not_turned_inside_out_by_smoothing(void) {
    static double p[3 * ROUND * LONG];
    static uint32_t faces[6 * ROUND * (LONG - 1)];
    size_t num_faces = 0, turned = 0;
    double unit = 2 * sin(3.141592653589793 / ROUND), sum = 0; /* of a tube of radius 1, the spacing round it */
    brio_context *ctx = new_context();
    brio_rng rng = brio_rng_new(5);
    for (uint32_t i = 0; i < LONG; i++)
        for (uint32_t j = 0; j < ROUND; j++) {
            double *x = p + 3 * (ROUND * i + j), a = 6.283185307179586 * (j + 0.5 * (i % 2)) / ROUND;
            double radius = 1 + 0.3 * unit * (brio_rng_double(&rng) - 0.5);
            x[0] = radius * cos(a), x[1] = radius * sin(a), x[2] = unit * i;
            if (i == LONG - 1) continue;
            uint32_t next = (j + 1) % ROUND, low = ROUND * i, high = low + ROUND, lean = i % 2 ? next : j;
            const uint32_t f[6] = {low + j,    low + next, high + lean, high + j, i % 2 ? low + j : low + next,
                                   high + next};
            memcpy(faces + 3 * num_faces, f, sizeof f), num_faces += 2;
        }
    for (size_t f = 0; f < num_faces; f++) EXPECT(facing(p, faces + 3 * f) > 0);
    EXPECT(brio_smooth_surface(ctx, p, ROUND * LONG, faces, num_faces) == BRIO_OK);
    for (size_t f = 0; f < num_faces; f++) turned += facing(p, faces + 3 * f) <= 0;
    for (size_t v = 0; v < ROUND * LONG; v++) sum += hypot(p[3 * v], p[3 * v + 1]);
    EXPECT(turned == 0, "%zu", turned);
    EXPECT(fabs(sum / (ROUND * LONG) - 1) < 0.1, "%g", sum / (ROUND * LONG));
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_noise) {
    RUN(a_limb_is_not_turned_inside_out_by_smoothing);
    RUN(nearest_points_are_those_of_exhaustive_search);
    RUN(level_is_that_of_the_noise);
    RUN(no_noise_in_shapes);
    RUN(no_noise_where_there_is_no_surface);
    RUN(thin_walls_are_no_noise);
    RUN(noise_of_one_sheet_has_no_layers);
    RUN(smoothing_does_not_depend_on_order_threads_or_duplicates);
    RUN(smoothing_keeps_quadratic_shapes);
    RUN(crust_of_noisy_samples_runs_through_their_middle);
    RUN(crust_of_clean_samples_is_the_exact_one);
    RUN(solids_keep_the_samples);
    RUN(medial_axis_of_noisy_samples_is_that_of_smoothed_ones);
    RUN(failing_memory_leaves_nothing);
    RUN(smoothing_can_be_cancelled);
    return harness_end();
}
