/* Hidden points that are left without a representative. */
#include "harness.h"
#include "points.h"
#include "triangulation/triangulation.h"

enum { MOST = 6000 };
static double points[3 * MOST], weights[MOST];

/* Small integers, so that many points coincide and weights hide most of the others, in a space of that dimension. */
static void crowded_points(int dimension) {
    static const uint32_t side[4] = {1, 2000, 200, 30};
    integer_points(7, MOST, side[dimension], points);
    integer_weights(11, MOST, 60, weights);
    for (size_t i = 0; i < MOST; i++)
        for (int k = dimension; k < 3; k++) points[3 * i + (size_t)k] = 2;
}

static brio_triangulation *triangulation_of(brio_context *ctx, int leaves) {
    brio_delaunay_options o = {0};
    brio_triangulation *t;
    o.leave_hidden = leaves;
    EXPECT(brio_delaunay(ctx, points, weights, MOST, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
    return t;
}

/* Everything is as without the option; only hidden points have no representative. */
static void compare(const brio_triangulation *named, const brio_triangulation *left) {
    const brio_delaunay_stats *a = brio_triangulation_stats(named), *b = brio_triangulation_stats(left);
    const uint32_t *r = brio_triangulation_representatives(named), *q = brio_triangulation_representatives(left);
    EXPECT(a->vertices == b->vertices && a->duplicates == b->duplicates && a->hidden == b->hidden,
           "%zu vertices, %zu duplicates, %zu hidden", b->vertices, b->duplicates, b->hidden);
    EXPECT(a->tetrahedra == b->tetrahedra && a->hull_facets == b->hull_facets);
    EXPECT(memcmp(brio_triangulation_tetrahedra(named), brio_triangulation_tetrahedra(left),
                  (a->tetrahedra + a->hull_facets) * sizeof(brio_tetrahedron)) == 0);
    for (size_t i = 0; i < MOST; i++) {
        bool has_vertex = memcmp(points + 3 * i, points + 3 * r[i], 3 * sizeof *points) == 0;
        EXPECT(q[i] == (has_vertex ? r[i] : BRIO_INFINITE), "point %zu: %u", i, q[i]);
    }
}

static void only_hidden_points_lack_a_representative(void) {
    for (int dimension = 0; dimension <= 3; dimension++)
        for (int threads = 1; threads <= 3; threads += 2) {
            brio_context *ctx = new_context();
            brio_context_set_threads(ctx, threads);
            crowded_points(dimension);
            brio_triangulation *named = triangulation_of(ctx, 0), *left = triangulation_of(ctx, 1);
            EXPECT(dimension == 0 || brio_triangulation_stats(left)->hidden > 0);
            compare(named, left);
            EXPECT(brio_triangulation_check(ctx, left, points, weights, MOST) == BRIO_OK, "%s", brio_message(ctx));
            brio_triangulation_free(named);
            brio_triangulation_free(left);
            EXPECT(brio_context_memory(ctx) == 0);
            brio_context_free(ctx);
        }
}

static void option_means_nothing_without_weights(void) {
    brio_context *ctx = new_context();
    brio_delaunay_options o = {0};
    brio_triangulation *t;
    o.leave_hidden = 1;
    crowded_points(3);
    EXPECT(brio_delaunay(ctx, points, NULL, MOST, &o, &t) == BRIO_OK);
    for (size_t i = 0; i < MOST; i++) EXPECT(brio_triangulation_representatives(t)[i] < MOST);
    EXPECT(brio_triangulation_stats(t)->duplicates > 0);
    EXPECT(brio_triangulation_check(ctx, t, points, NULL, MOST) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation_free(t);
    brio_context_free(ctx);
}

static size_t first_hidden(const brio_triangulation *left) {
    size_t i = 0;
    while (brio_triangulation_representatives(left)[i] != BRIO_INFINITE) i++;
    return i;
}

/* A missing representative is wrong where it was asked for, and one that is there where it was not. */
static void check_knows_whether_hidden_points_were_left(void) {
    brio_context *ctx = new_context();
    crowded_points(3);
    brio_triangulation *named = triangulation_of(ctx, 0), *left = triangulation_of(ctx, 1);
    size_t i = first_hidden(left), vertex = 0;
    uint32_t right = named->representative[i];
    while (left->representative[vertex] != vertex) vertex++;
    named->representative[i] = BRIO_INFINITE;
    left->representative[i] = right;
    EXPECT(brio_triangulation_check(ctx, named, points, weights, MOST) == BRIO_ERR_CHECK);
    EXPECT(brio_triangulation_check(ctx, left, points, weights, MOST) == BRIO_ERR_CHECK);
    left->representative[i] = BRIO_INFINITE;
    left->representative[vertex] = BRIO_INFINITE;
    EXPECT(brio_triangulation_check(ctx, left, points, weights, MOST) == BRIO_ERR_CHECK);
    brio_triangulation_free(named);
    brio_triangulation_free(left);
    brio_context_free(ctx);
}

SUITE(test_hidden) {
    RUN(only_hidden_points_lack_a_representative);
    RUN(option_means_nothing_without_weights);
    RUN(check_knows_whether_hidden_points_were_left);
    return harness_end();
}
