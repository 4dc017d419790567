/* Theorem 18 of [Choi 2003]: with a biased randomized insertion order the expected number of tetrahedra that are ever
 * created is O(n) on realistic points and O(n^2) on any. Counted against a random order on scans, and against n^2 on the
 * moment curve. */
#include "brio/testdata.h"
#include "harness.h"
#include "points.h"
#include "trial.h"

enum { SEEDS = 3 };

static const int BRIOS[] = {BRIO_ORDER_BRIO, TRIAL_BRIO_OCTREE, TRIAL_BRIO_KDTREE};

/* Tetrahedra created, infinite ones too, over the number of vertices.   ratio  0: the default */
static double created_a_point(brio_kind kind, size_t n, int order, double ratio, uint64_t seed) {
    brio_context *ctx = new_context();
    trial_options o = {0};
    brio_generate_options generate = {0};
    brio_mesh *mesh = NULL;
    brio_triangulation *t = NULL;
    double created = 0;
    generate.seed = o.seed = seed;
    o.order = order;
    if (ratio > 0) o.round_ratio = ratio;
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_generate(ctx, kind, n, &generate, &mesh) == BRIO_OK);
    EXPECT(trial_delaunay(ctx, mesh->vertices, NULL, mesh->num_vertices, &o, &t, NULL) == BRIO_OK, "%s",
           brio_message(ctx));
    if (t) created = (double)brio_triangulation_stats(t)->created / (double)brio_triangulation_stats(t)->vertices;
    brio_triangulation_free(t);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
    return created;
}

enum { LARGE = SHORT_TESTS ? 8000 : 16000 };

static double mean_created(size_t n, int order, double ratio) {
    double sum = 0;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) sum += created_a_point(BRIO_KIND_SCAN, n, order, ratio, seed);
    return sum / SEEDS;
}

/* The thesis' rounds of a half and the house's. An order without rounds along a curve creates half as many again. */
static void scans_create_as_many_as_in_random_order(void) {
    double random[2], brio[2];
    for (int i = 0; i < 2; i++) {
        size_t n = i ? LARGE : LARGE / 4;
        random[i] = mean_created(n, BRIO_ORDER_RANDOM, 0);
        for (size_t k = 0; k < sizeof BRIOS / sizeof *BRIOS; k++) {
            brio[i] = mean_created(n, BRIOS[k], 0.5);
            EXPECT(brio[i] < 1.03 * random[i] && brio[i] > 0.97 * random[i], "order %d: %g, %g in random order",
                   BRIOS[k], brio[i], random[i]);
        }
        brio[i] = mean_created(n, BRIO_ORDER_BRIO, 0);
        EXPECT(brio[i] < 1.1 * random[i], "default rounds: %g, %g in random order", brio[i], random[i]);
    }
    EXPECT(random[1] < 1.1 * random[0] && brio[1] < 1.1 * brio[0], "%g, then %g a point", brio[0], brio[1]);
    double curve = mean_created(LARGE, BRIO_ORDER_HILBERT, 0);
    EXPECT(curve > 1.3 * random[1], "%g along the curve, %g in random order", curve, random[1]);
}

/* The worst case: about n^2 / 2 tetrahedra in the end. All points of the curve are on the hull, and each insertion among
 * j points creates as many as a point of the curve has, 2 j or less: n^2 in all. */
static void moment_curves_create_no_more_than_the_square(void) {
    for (size_t n = 200; n <= 800; n *= 2)
        for (size_t k = 0; k < sizeof BRIOS / sizeof *BRIOS; k++) {
            double created = created_a_point(BRIO_KIND_MOMENT, n, BRIOS[k], 0.5, 1);
            EXPECT(created <= (double)n && created > 0.9 * (double)n, "%g a point, %zu points", created, n);
        }
}

SUITE(test_created_tetrahedra) {
    RUN(scans_create_as_many_as_in_random_order);
    RUN(moment_curves_create_no_more_than_the_square);
    return harness_end();
}
