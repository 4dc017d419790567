/* The axis by Voronoi facets against axes that are known, beside the power shape; the conditions against a brute force
 * over all pairs of samples. BRIO_TEST_VERBOSE=1 prints the errors. */
#include "harness.h"
#include "medial_shapes.h"
#include "points.h"

enum { AXIS_POINTS = 1000 };

static brio_mesh *axis_of(brio_context *ctx, const cloud *c, const brio_voronoi_axis_options *o) {
    brio_mesh *mesh = NULL;
    EXPECT(brio_voronoi_axis(ctx, c->points, c->count, o, &mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
    return mesh;
}

/* --- distance both ways --- */

typedef struct {
    double from_result, mean, from_axis; /* largest, mean, largest */
} errors;

static errors errors_of(const medial_shape *shape, const brio_mesh *mesh) {
    errors e = {0, 0, 0};
    brio_rng rng = brio_rng_new(5);
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        double off = shape->off_axis(mesh->vertices + 3 * v);
        e.from_result = fmax(e.from_result, off);
        e.mean += off / (double)mesh->num_vertices;
    }
    for (int i = 0; i < AXIS_POINTS; i++) {
        double least = INFINITY, p[3];
        shape->on_axis(&rng, p);
        for (size_t v = 0; v < mesh->num_vertices; v++) {
            const double *q = mesh->vertices + 3 * v;
            double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
            least = fmin(least, x * x + y * y + z * z);
        }
        e.from_axis = fmax(e.from_axis, sqrt(least));
    }
    return e;
}

/* Of the axis by facets, and beside it of the power shape. */
static errors compare(const medial_shape *shape, double h, uint64_t seed) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(shape, h, seed);
    brio_mesh *facets = axis_of(ctx, &c, NULL), *power = NULL;
    EXPECT(brio_power_shape(ctx, c.points, c.count, NULL, &power, NULL, NULL) == BRIO_OK);
    errors e = errors_of(shape, facets), p = errors_of(shape, power);
    if (getenv("BRIO_TEST_VERBOSE"))
        fprintf(stderr,
                "%s h %g: %zu samples; voronoi %zu vertices %zu facets, errors over h %g (mean %g) %g; power "
                "%zu vertices, %g (mean %g) %g\n",
                shape->name, h, c.count, facets->num_vertices, facets->num_faces, e.from_result / h, e.mean / h,
                e.from_axis / h, power->num_vertices, p.from_result / h, p.mean / h, p.from_axis / h);
    brio_mesh_free(facets);
    brio_mesh_free(power);
    brio_context_free(ctx);
    free(c.points);
    return e;
}

/* Both errors get smaller with the sampling. */
static void expect_convergence(const medial_shape *shape, double h, double result_over_h, double axis_over_h) {
    int levels = SHORT_TESTS ? 2 : 3;
    for (uint64_t seed = 1; seed <= (SHORT_TESTS ? 1 : 2); seed++) {
        errors e[3];
        for (int i = 0; i < levels; i++) {
            double step = ldexp(h, -i);
            e[i] = compare(shape, step, seed);
            EXPECT(e[i].from_result < result_over_h * step, "%s: %g at h = %g", shape->name, e[i].from_result, step);
            EXPECT(e[i].from_axis < axis_over_h * step, "%s: %g at h = %g", shape->name, e[i].from_axis, step);
        }
        EXPECT(e[levels - 1].from_axis < 0.8 * e[0].from_axis);
    }
}

static void facets_of_an_ellipsoid_converge(void) {
    expect_convergence(&medial_ellipsoid, 0.3, 3, 3);
}

static void facets_of_a_torus_converge(void) {
    expect_convergence(&medial_torus, 0.2, 3, 3);
}

static void facets_of_a_box_converge(void) {
    expect_convergence(&medial_box, 0.2, 3, 3);
}

static void facets_of_a_capsule_converge(void) {
    expect_convergence(&medial_capsule, 0.2, 3, 3);
}

/* --- what is chosen --- */

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void towards(const double *from, const double *to, double *out) {
    for (int k = 0; k < 3; k++) out[k] = to[k] - from[k];
}

static double apart(const double *a, const double *b) {
    double d[3];
    towards(a, b, d);
    return sqrt(dot(d, d));
}

/* Finds the samples on the ball of each vertex, by distances. Returns how many vertices have other than four. */
static size_t find_touched(const brio_mesh *m, const cloud *c, uint32_t *touched) {
    const brio_property *radius = brio_mesh_property(m, "radius");
    size_t odd = 0;
    for (size_t v = 0; v < m->num_vertices; v++) {
        int count = 0;
        double r = brio_property_value(radius, v);
        for (uint32_t s = 0; s < c->count; s++) {
            double d = apart(m->vertices + 3 * v, c->points + 3 * s);
            EXPECT(d > r * (1 - 1e-9));
            if (d < r * (1 + 1e-9) && count++ < 4) touched[4 * v + (size_t)count - 1] = s;
        }
        odd += count != 4;
    }
    return odd;
}

/* Each face is a Voronoi facet: its vertices' balls are empty and have two samples in common, its Delaunay edge. */
static void faces_are_facets_between_two_samples(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_torus, 0.25, 1);
    brio_voronoi_axis_options o = {.size = sizeof o, .sides = BRIO_SIDES_BOTH};
    brio_mesh *m = axis_of(ctx, &c, &o);
    uint32_t *touched = malloc(16 * m->num_vertices);
    EXPECT(find_touched(m, &c, touched) == 0);
    const brio_property *side = brio_mesh_property(m, "side");
    size_t sides[2] = {0, 0};
    for (size_t f = 0; f < m->num_faces; f++) {
        size_t begin = m->face_offsets[f], end = m->face_offsets[f + 1];
        int common = 0;
        for (int i = 0; i < 4; i++) {
            uint32_t s = touched[4 * (size_t)m->face_vertices[begin] + (size_t)i];
            bool everywhere = true;
            for (size_t k = begin; k < end; k++) {
                const uint32_t *t = touched + 4 * (size_t)m->face_vertices[k];
                everywhere = everywhere && (t[0] == s || t[1] == s || t[2] == s || t[3] == s);
            }
            common += everywhere;
        }
        EXPECT(common == 2, "%d samples in common", common);
        for (size_t k = begin; k < end; k++) {
            size_t v = m->face_vertices[k];
            bool inside = torus_distance(m->vertices + 3 * v) < 0;
            EXPECT((brio_property_value(side, v) < 0) == inside);
            sides[inside]++;
        }
    }
    EXPECT(sides[0] > 20 && sides[1] > 20);
    free(touched);
    brio_mesh_free(m);
    brio_context_free(ctx);
    free(c.points);
}

/* A stricter angle and a longer ratio choose fewer facets, and a ratio alone that none reaches leaves the angle's. */
static void conditions_choose_by_their_constants(void) {
    brio_context *ctx = new_context();
    cloud c = medial_sample(&medial_ellipsoid, 0.25, 1);
    size_t last = SIZE_MAX;
    for (int i = 1; i <= 6; i++) {
        brio_voronoi_axis_options o = {.size = sizeof o, .theta = 0.2 * i, .rho = 1e6};
        brio_voronoi_axis_stats s = {.size = sizeof s};
        brio_mesh *m = NULL;
        EXPECT(brio_voronoi_axis(ctx, c.points, c.count, &o, &m, &s) == BRIO_OK);
        EXPECT(s.by_ratio == 0 && s.by_angle > 0 && s.by_angle < last, "%zu", s.by_angle);
        last = s.by_angle;
        brio_mesh_free(m);
    }
    last = SIZE_MAX;
    for (int i = 1; i <= 5; i++) {
        brio_voronoi_axis_options o = {.size = sizeof o, .theta = 1.57, .rho = 1.2 * i};
        brio_voronoi_axis_stats s = {.size = sizeof s};
        brio_mesh *m = NULL;
        EXPECT(brio_voronoi_axis(ctx, c.points, c.count, &o, &m, &s) == BRIO_OK);
        EXPECT(s.by_ratio > 0 && s.by_ratio < last, "%zu", s.by_ratio);
        last = s.by_ratio;
        brio_mesh_free(m);
    }
    brio_context_free(ctx);
    free(c.points);
}

static void shuffled_samples_give_the_same_facets(void) {
    static double p[3 * 1000], q[3 * 1000];
    static size_t to[1000];
    brio_context *ctx = new_context();
    brio_mesh *a = NULL, *b = NULL;
    torus_points(2, 1000, p);
    shuffle_points(5, 1000, p, q, to);
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_voronoi_axis(ctx, p, 1000, NULL, &a, NULL) == BRIO_OK);
    brio_context_set_threads(ctx, 3);
    EXPECT(brio_voronoi_axis(ctx, q, 1000, NULL, &b, NULL) == BRIO_OK);
    EXPECT(a->num_vertices == b->num_vertices && a->num_faces == b->num_faces);
    EXPECT(!memcmp(a->vertices, b->vertices, 24 * a->num_vertices));
    EXPECT(!memcmp(a->face_vertices, b->face_vertices, 4 * a->face_offsets[a->num_faces]));
    brio_mesh_free(a);
    brio_mesh_free(b);
    brio_context_free(ctx);
}

static void wrong_uses_are_refused(void) {
    brio_context *ctx = new_context();
    brio_mesh *m;
    static double p[300], flat[300];
    uniform_points(1, 100, p);
    for (int i = 0; i < 300; i++) flat[i] = i % 3 == 2 ? 0 : p[i];
    brio_voronoi_axis_options o = {.size = sizeof o, .theta = 2};
    EXPECT(brio_voronoi_axis(ctx, p, 100, &o, &m, NULL) == BRIO_ERR_ARGUMENT);
    o = (brio_voronoi_axis_options){.size = sizeof o, .rho = -1};
    EXPECT(brio_voronoi_axis(ctx, p, 100, &o, &m, NULL) == BRIO_ERR_ARGUMENT);
    o = (brio_voronoi_axis_options){.size = sizeof o, .sides = BRIO_SIDES_END};
    EXPECT(brio_voronoi_axis(ctx, p, 100, &o, &m, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_voronoi_axis(ctx, flat, 100, NULL, &m, NULL) == BRIO_ERR_NO_ANSWER);
    EXPECT(brio_voronoi_axis(ctx, p, 0, NULL, &m, NULL) == BRIO_ERR_NO_ANSWER);
    p[7] = NAN;
    EXPECT(brio_voronoi_axis(ctx, p, 100, NULL, &m, NULL) == BRIO_ERR_NOT_FINITE);
    EXPECT(!m);
    brio_context_free(ctx);
}

SUITE(test_voronoi_axis) {
    RUN(facets_of_an_ellipsoid_converge);
    RUN(facets_of_a_torus_converge);
    RUN(facets_of_a_box_converge);
    RUN(facets_of_a_capsule_converge);
    RUN(faces_are_facets_between_two_samples);
    RUN(conditions_choose_by_their_constants);
    RUN(shuffled_samples_give_the_same_facets);
    RUN(wrong_uses_are_refused);
    return harness_end();
}
