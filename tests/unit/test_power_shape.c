/* The power shape against medial axes that are known, at three densities of the samples. BRIO_TEST_VERBOSE=1 prints the
 * errors. */
#include "harness.h"
#include "medial_shapes.h"
#include "points.h"

/* The largest distance of a pole of the shape from the true axis. */
static double largest_error(const medial_shape *shape, const brio_mesh *mesh) {
    double most = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++) most = fmax(most, shape->off_axis(mesh->vertices + 3 * v));
    return most;
}

static double error_of(const medial_shape *shape, double h, uint64_t seed) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(shape, h, seed);
    brio_mesh *mesh;
    brio_medial_stats s;
    EXPECT(brio_power_shape(ctx, c.points, c.count, NULL, &mesh, NULL, &s) == BRIO_OK, "%s: %s", shape->name,
           brio_message(ctx));
    double error = mesh ? largest_error(shape, mesh) : INFINITY;
    if (getenv("BRIO_TEST_VERBOSE"))
        fprintf(stderr, "%s h %g: %zu samples, %zu poles, error %g\n", shape->name, h, c.count, s.inner, error);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
    free(c.points);
    return error;
}

/* The error is at most in proportion to the sampling, and it does get smaller. */
static void expect_convergence(const medial_shape *shape, double h, double most_over_h) {
    for (uint64_t seed = 1; seed <= 2; seed++) {
        double error[3];
        for (int i = 0; i < 3; i++) {
            double step = ldexp(h, -i);
            error[i] = error_of(shape, step, seed);
            EXPECT(error[i] < most_over_h * step, "%s: %g at h = %g", shape->name, error[i], step);
        }
        EXPECT(error[2] < 0.6 * error[0], "%s: %g, then %g", shape->name, error[0], error[2]);
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
    for (int i = 0; i < 3; i++) EXPECT(error_of(&medial_sphere, ldexp(0.4, -i), 1) < 1e-12);
}

int main(void) {
    RUN(axis_of_sphere_is_its_centre_for_any_sampling);
    RUN(axis_of_ellipsoid_is_in_proportion_to_sampling);
    RUN(axis_of_torus_is_in_proportion_to_sampling);
    RUN(axis_of_box_is_in_proportion_to_sampling);
    RUN(axis_of_cylinder_with_caps_is_in_proportion_to_sampling);
    return harness_end();
}
