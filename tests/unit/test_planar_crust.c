/* Power crusts of points in a plane: the links of sampled curves, the Euler characteristic of what they enclose, even degrees
 * whatever the points, one answer for any order. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include <math.h>
#include <string.h>

enum { MOST = 400 };

/* Points of closed curves one after the other: circles whose radius swings, in a plane that slants. */
typedef struct {
    double x, y, radius, swing;
    int count;
} ring;

static size_t sample(const ring *rings, int num_rings, double *out) {
    size_t n = 0;
    for (int c = 0; c < num_rings; c++)
        for (int i = 0; i < rings[c].count; i++, n++) {
            double angle = 2 * acos(-1) * i / rings[c].count,
                   r = rings[c].radius * (1 + rings[c].swing * sin(5 * angle));
            double x = rings[c].x + r * cos(angle), y = rings[c].y + r * sin(angle);
            out[3 * n] = x, out[3 * n + 1] = 0.6 * y, out[3 * n + 2] = 0.8 * y;
        }
    return n;
}

static bool has_edge(const brio_mesh *mesh, uint32_t a, uint32_t b) {
    const uint32_t *point = brio_mesh_property(mesh, "sample")->data;
    for (size_t e = 0; e < mesh->num_edges; e++) {
        uint32_t p = point[mesh->edges[2 * e]], q = point[mesh->edges[2 * e + 1]];
        if ((p == a && q == b) || (p == b && q == a)) return true;
    }
    return false;
}

static size_t wrong_links(const brio_mesh *mesh, const ring *rings, int num_rings, const uint32_t *place) {
    size_t wrong = 0;
    uint32_t first = 0;
    for (int c = 0; c < num_rings; first += (uint32_t)rings[c].count, c++)
        for (uint32_t i = 0; i < (uint32_t)rings[c].count; i++) {
            uint32_t a = first + i, b = first + (i + 1) % (uint32_t)rings[c].count;
            wrong += !has_edge(mesh, place ? place[a] : a, place ? place[b] : b);
        }
    return wrong;
}

static const ring STAR[1] = {{0, 0, 1, 0.4, 200}};
static const ring ANNULUS[2] = {{0, 0, 1, 0, 120}, {0, 0, 0.5, 0, 70}};
static const ring APART[3] = {{0, 0, 1, 0.2, 120}, {4, 1, 0.7, 0, 60}, {4, 1, 0.3, 0, 40}};

/* The crust of rings has their links and no others; the shape has the Euler characteristic of the inside. */
static void expect_rings(const ring *rings, int num_rings, int euler, const char *what) {
    brio_context *ctx = new_context();
    double p[3 * MOST], q[3 * MOST];
    uint32_t place[MOST];
    size_t n = sample(rings, num_rings, p);
    for (int shuffled = 0; shuffled < 2; shuffled++) {
        brio_mesh *mesh = NULL, *shape = NULL;
        brio_planar_crust_stats s = {0};
        for (uint32_t k = 0; k < n; k++) {
            place[k] = shuffled ? (k * 53 + 7) % (uint32_t)n : k;
            memcpy(q + 3 * (size_t)place[k], p + 3 * (size_t)k, 3 * sizeof *p);
        }
        EXPECT(brio_planar_crust(ctx, q, n, &mesh, &shape, &s) == BRIO_OK, "%s: %s", what, brio_message(ctx));
        if (!mesh) continue;
        EXPECT(mesh->num_edges == n && s.edges == n && s.samples == n, "%s: %zu edges", what, mesh->num_edges);
        EXPECT(wrong_links(mesh, rings, num_rings, place) == 0, "%s, shuffled %d", what, shuffled);
        EXPECT((int)shape->num_vertices - (int)shape->num_edges == euler, "%s: %zu - %zu", what, shape->num_vertices,
               shape->num_edges);
        EXPECT(shape->num_vertices == s.inner && s.inner + s.outer == s.poles);
        brio_mesh_free(mesh);
        brio_mesh_free(shape);
    }
    brio_context_free(ctx);
}

static void crusts_have_the_links_of_sampled_curves(void) {
    expect_rings(STAR, 1, 1, "star");
    expect_rings(ANNULUS, 2, 0, "annulus");
    expect_rings(APART, 3, 1, "a disk and an annulus");
}

/* The circles of the shape are empty of samples, and touch three; they are the largest in the disk near its centre. */
static void balls_of_the_shape_are_empty(void) {
    brio_context *ctx = new_context();
    brio_mesh *mesh = NULL, *shape = NULL;
    double p[3 * MOST];
    size_t n = sample(STAR, 1, p);
    EXPECT(brio_planar_crust(ctx, p, n, &mesh, &shape, NULL) == BRIO_OK);
    for (size_t v = 0; shape && v < shape->num_vertices; v++) {
        const double *c = shape->vertices + 3 * v,
                     radius = ((const double *)brio_mesh_property(shape, "radius")->data)[v];
        double least = INFINITY;
        for (size_t i = 0; i < n; i++)
            least = fmin(least, hypot(hypot(p[3 * i] - c[0], p[3 * i + 1] - c[1]), p[3 * i + 2] - c[2]));
        EXPECT(fabs(least - radius) < 1e-9, "a circle of %g, the nearest sample at %g", radius, least);
    }
    brio_mesh_free(mesh);
    brio_mesh_free(shape);
    brio_context_free(ctx);
}

static void degrees_are_even_whatever_the_points(void) {
    brio_context *ctx = new_context();
    brio_rng rng = brio_rng_new(3);
    for (int round = 0; round < 30; round++) {
        brio_mesh *mesh = NULL;
        double p[3 * MOST];
        int degree[MOST] = {0};
        size_t n = 20 + 12 * (size_t)round;
        bool grid = round % 3 == 0;
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0; k < 3; k++)
                p[3 * i + k] = k == 2 ? 1 : grid ? (double)brio_rng_below(&rng, 12) : brio_rng_double(&rng);
        brio_status status = brio_planar_crust(ctx, p, n, &mesh, NULL, NULL);
        EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_ANSWER, "%s", brio_message(ctx));
        for (size_t e = 0; mesh && e < 2 * mesh->num_edges; e++) degree[mesh->edges[e]]++;
        for (size_t v = 0; mesh && v < mesh->num_vertices; v++) EXPECT(degree[v] % 2 == 0, "round %d", round);
        brio_mesh_free(mesh);
    }
    brio_context_free(ctx);
}

static void what_has_no_inside_is_refused(void) {
    brio_context *ctx = new_context();
    const double line[9] = {0, 0, 0, 1, 1, 1, 3, 3, 3}, space[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    brio_mesh *mesh = NULL;
    EXPECT(brio_planar_crust(ctx, line, 3, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(brio_planar_crust(ctx, space, 4, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    EXPECT(brio_planar_crust(ctx, space, 0, &mesh, NULL, NULL) == BRIO_ERR_NO_ANSWER && !mesh);
    brio_context_free(ctx);
}

static brio_status attempt(brio_context *ctx) {
    brio_mesh *mesh = NULL, *shape = NULL;
    double p[3 * MOST];
    brio_status status = brio_planar_crust(ctx, p, sample(ANNULUS, 2, p), &mesh, &shape, NULL);
    brio_mesh_free(mesh);
    brio_mesh_free(shape);
    return status;
}

static void memory_that_ends_leaves_nothing(void) {
    expect_clean_failures(attempt);
}

SUITE(test_planar_crust) {
    RUN(crusts_have_the_links_of_sampled_curves);
    RUN(balls_of_the_shape_are_empty);
    RUN(degrees_are_even_whatever_the_points);
    RUN(what_has_no_inside_is_refused);
    RUN(memory_that_ends_leaves_nothing);
    return harness_end();
}
