/* The power shape against medial axes that are known, at three densities of the samples and both ways, and its Euler
 * characteristic against that of the solid. BRIO_TEST_VERBOSE=1 prints the errors. */
#include "harness.h"
#include "known_surfaces.h"
#include "medial_shapes.h"
#include "points.h"
#include "surfaces.h"

/* One bound for all shapes, chosen: no axis point is farther than 2 h from a pole, also where the axis runs into a sharp
 * edge. (1.75 h was the most, on the cylinder.) */
enum { AXIS_POINTS = 1000, AXIS_OVER_H = 2 };

/* --- distance both ways --- */

/* The largest distance of a pole of the shape from the true axis. */
static double farthest_pole(const medial_shape *shape, const brio_mesh *mesh) {
    double most = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++) most = fmax(most, shape->off_axis(mesh->vertices + 3 * v));
    return most;
}

/* The largest distance of a random point of the true axis from the nearest pole of the shape. */
static double farthest_axis_point(const medial_shape *shape, const brio_mesh *mesh) {
    double most = 0, p[3];
    brio_rng rng = brio_rng_new(5);
    for (int i = 0; i < AXIS_POINTS; i++) {
        double least = INFINITY;
        shape->on_axis(&rng, p);
        EXPECT(shape->off_axis(p) < 1e-12, "%s: %g", shape->name, shape->off_axis(p));
        for (size_t v = 0; v < mesh->num_vertices; v++) {
            const double *q = mesh->vertices + 3 * v;
            double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
            least = fmin(least, x * x + y * y + z * z);
        }
        most = fmax(most, sqrt(least));
    }
    return most;
}

typedef struct {
    double from_poles, from_axis;
} errors;

static errors errors_of(const medial_shape *shape, double h, uint64_t seed) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(shape, h, seed);
    brio_mesh *mesh;
    brio_power_shape_stats s = {0};
    errors e = {INFINITY, INFINITY};
    EXPECT(brio_power_shape(ctx, c.points, c.count, NULL, &mesh, NULL, &s) == BRIO_OK, "%s: %s", shape->name,
           brio_message(ctx));
    if (mesh) e = (errors){farthest_pole(shape, mesh), farthest_axis_point(shape, mesh)};
    if (getenv("BRIO_TEST_VERBOSE"))
        fprintf(stderr, "%s h %g: %zu samples, %zu poles, errors over h %g %g\n", shape->name, h, c.count,
                s.poles.inner, e.from_poles / h, e.from_axis / h);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
    free(c.points);
    return e;
}

/* Both errors are at most in proportion to the sampling, and they do get smaller. */
static void expect_convergence(const medial_shape *shape, double h, double poles_over_h) {
    for (uint64_t seed = 1; seed <= 2; seed++) {
        errors e[3];
        for (int i = 0; i < 3; i++) {
            double step = ldexp(h, -i);
            e[i] = errors_of(shape, step, seed);
            EXPECT(e[i].from_poles < poles_over_h * step, "%s: %g at h = %g", shape->name, e[i].from_poles, step);
            EXPECT(e[i].from_axis < AXIS_OVER_H * step, "%s: %g at h = %g", shape->name, e[i].from_axis, step);
        }
        EXPECT(e[2].from_poles < 0.6 * e[0].from_poles, "%s: %g, then %g", shape->name, e[0].from_poles,
               e[2].from_poles);
        EXPECT(e[2].from_axis < 0.6 * e[0].from_axis, "%s: %g, then %g", shape->name, e[0].from_axis, e[2].from_axis);
    }
}

static void axis_of_ellipsoid_is_in_proportion_to_sampling(void) {
    expect_convergence(&medial_ellipsoid, 0.4, 0.08);
}

static void axis_of_torus_is_in_proportion_to_sampling(void) {
    expect_convergence(&medial_torus, 0.3, 0.15);
}

static void axis_of_box_is_in_proportion_to_sampling(void) {
    expect_convergence(&medial_box, 0.25, 0.8);
}

static void axis_of_cylinder_with_caps_is_in_proportion_to_sampling(void) {
    expect_convergence(&medial_cylinder, 0.4, 0.5);
}

static void axis_of_sphere_is_its_centre_for_any_sampling(void) {
    for (int i = 0; i < 3; i++) {
        errors e = errors_of(&medial_sphere, ldexp(0.4, -i), 1);
        EXPECT(e.from_poles < 1e-12 && e.from_axis < 1e-12);
    }
}

/* --- Euler characteristic --- */

static long euler_of_shape(const brio_mesh *m) {
    return (long)m->num_vertices - (long)m->num_edges + (long)m->num_faces - (long)m->num_tetrahedra;
}

/* Of the solid that a closed surface bounds: half of that of the surface. */
static long euler_of_solid(brio_context *ctx, const brio_mesh *crust) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, crust, &c) == BRIO_OK && c.closed && c.manifold);
    long euler = (long)c.components - (long)c.genus;
    brio_certificate_free(&c);
    return euler;
}

/* Also of the shape after simplification; `expected` is the characteristic of the true solid, which that one need not
 * have. */
static void expect_euler(const char *name, const double *points, size_t n, long expected) {
    brio_context *ctx = new_context();
    for (int simplified = 0; simplified < 2; simplified++) {
        brio_power_shape_options o = {0};
        brio_mesh *shape, *crust;
        if (simplified) o.scale = 1.1, o.redundancy = 0.01;
        EXPECT(brio_power_shape(ctx, points, n, &o, &shape, &crust, NULL) == BRIO_OK, "%s", brio_message(ctx));
        long euler = euler_of_shape(shape), solid = euler_of_solid(ctx, crust);
        EXPECT(euler == solid, "%s: shape %ld, solid %ld", name, euler, solid);
        EXPECT(simplified || euler == expected, "%s: %ld", name, euler);
        EXPECT(simplified || shape->num_tetrahedra > 0, "%s: the shape has no tetrahedra to count", name);
        brio_mesh_free(shape);
        brio_mesh_free(crust);
    }
    brio_context_free(ctx);
}

static void shapes_of_known_solids_have_their_euler_characteristic(void) {
    static const medial_shape *const shapes[] = {&medial_sphere, &medial_torus, &medial_ellipsoid, &medial_box,
                                                 &medial_cylinder};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        cloud c = medial_sample(shapes[i], 0.15, 1);
        expect_euler(shapes[i]->name, c.points, c.count, shapes[i]->euler);
        free(c.points);
    }
}

static void shape_of_plate_with_three_holes_has_their_euler_characteristic(void) {
    size_t n;
    double *points = known_plate.sample(0.2, 1, &n);
    expect_euler("plate", points, n, 1 - known_plate.genus);
    free(points);
}

/* Chains of one, two and three bent tori, sampled at the vertices of a mesh. */
static void shapes_of_chains_of_tori_have_their_euler_characteristic(void) {
    brio_context *ctx = new_context();
    for (int genus = 1; genus <= 3; genus++) {
        brio_mesh *mesh = random_surface(ctx, genus, SHORT_TESTS ? 0.14 : 0.1, (uint64_t)genus);
        expect_euler("chain", mesh->vertices, mesh->num_vertices, 1 - genus);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

/* Whatever the points are: the shape is the nerve of the cells whose union the crust bounds. */
static void shapes_of_any_points_have_the_euler_characteristic_of_their_solid(void) {
    static double p[3 * 2000];
    for (uint64_t seed = 1; seed <= 12; seed++) {
        brio_context *ctx = new_context();
        brio_mesh *shape, *crust;
        size_t n = 100 * seed;
        if (seed % 3 == 0)
            uniform_points(seed, n, p);
        else if (seed % 3 == 1)
            torus_points(seed, n, p);
        else
            clustered_points(seed, n, p);
        EXPECT(brio_power_shape(ctx, p, n, NULL, &shape, &crust, NULL) == BRIO_OK, "%s", brio_message(ctx));
        long euler = euler_of_shape(shape), solid = euler_of_solid(ctx, crust);
        EXPECT(euler == solid, "seed %d: shape %ld, solid %ld", (int)seed, euler, solid);
        brio_mesh_free(shape);
        brio_mesh_free(crust);
        brio_context_free(ctx);
    }
}

SUITE(test_power_shape) {
    RUN(axis_of_sphere_is_its_centre_for_any_sampling);
    RUN(axis_of_ellipsoid_is_in_proportion_to_sampling);
    RUN(axis_of_torus_is_in_proportion_to_sampling);
    RUN(axis_of_box_is_in_proportion_to_sampling);
    RUN(axis_of_cylinder_with_caps_is_in_proportion_to_sampling);
    RUN(shapes_of_known_solids_have_their_euler_characteristic);
    RUN(shape_of_plate_with_three_holes_has_their_euler_characteristic);
    RUN(shapes_of_chains_of_tori_have_their_euler_characteristic);
    RUN(shapes_of_any_points_have_the_euler_characteristic_of_their_solid);
    return harness_end();
}
