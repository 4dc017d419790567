/* Co-cones by any number of threads: the same faces, properties and statistics to the last byte. */
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include <string.h>

enum { N = 3000 };

static double points[3 * N];

typedef struct {
    brio_mesh *mesh;
    brio_surface_stats stats;
} result;

static result run(brio_context *ctx, size_t n, const brio_surface_options *o, int threads) {
    result r = {.stats.size = sizeof r.stats};
    brio_context_set_threads(ctx, threads);
    EXPECT(make_cocone(ctx, points, n, o, &r.mesh, &r.stats) == BRIO_OK, "%s", brio_message(ctx));
    r.stats.delaunay_seconds = r.stats.poles_seconds = r.stats.candidates_seconds = r.stats.labels_seconds =
        r.stats.manifold_seconds = r.stats.density_seconds = 0;
    return r;
}

static void expect_same(const result *a, const result *b, int threads) {
    const brio_mesh *m = a->mesh, *n = b->mesh;
    EXPECT(m && n && m->num_faces == n->num_faces && m->num_properties == n->num_properties, "%d threads", threads);
    if (!m || !n || m->num_faces != n->num_faces || m->num_properties != n->num_properties) return;
    EXPECT(!memcmp(m->face_vertices, n->face_vertices, 3 * m->num_faces * sizeof *m->face_vertices), "%d threads",
           threads);
    for (size_t i = 0; i < m->num_properties; i++) {
        size_t size = m->num_vertices * brio_scalar_size(m->properties[i].type);
        EXPECT(!memcmp(m->properties[i].data, n->properties[i].data, size), "property %zu, %d threads", i, threads);
    }
    EXPECT(!memcmp(&a->stats, &b->stats, sizeof a->stats), "statistics of %d threads", threads);
}

/* The samples in points, by 1, 2, 3 and 8 threads (brief: 1 and 3), with and without what the options add. */
static void expect_one_answer(size_t n) {
    static const int teams[] = {2, 3, 8};
    brio_context *ctx = new_context();
    for (int way = 0; way < 3; way++) {
        brio_surface_options o = COCONE_OPTIONS;
        o.boundaries = o.density = way == 1;
        o.method = way == 2 ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE;
        result one = run(ctx, n, &o, 1);
        for (int i = BRIEF_TESTS ? 1 : 0; i < (BRIEF_TESTS ? 2 : 3); i++) {
            result many = run(ctx, n, &o, teams[i]);
            expect_same(&one, &many, teams[i]);
            brio_mesh_free(many.mesh);
        }
        brio_mesh_free(one.mesh);
    }
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void a_torus_is_the_same_by_threads(void) {
    torus_points(1, N, points);
    expect_one_answer(N);
}

/* Every Voronoi vertex is that of hundreds of tetrahedra, up to rounding: poles are decided by ties. */
static void a_sphere_is_the_same_by_threads(void) {
    sphere_points(2, 1500, points);
    expect_one_answer(1500);
}

static void a_grid_is_the_same_by_threads(void) {
    integer_points(3, 1500, 11, points);
    expect_one_answer(1500);
}

static void clusters_are_the_same_by_threads(void) {
    clustered_points(4, 1000, points);
    expect_one_answer(1000);
}

SUITE(test_parallel_cocone) {
    RUN(a_torus_is_the_same_by_threads);
    RUN(a_sphere_is_the_same_by_threads);
    RUN(a_grid_is_the_same_by_threads);
    RUN(clusters_are_the_same_by_threads);
    return harness_end();
}
