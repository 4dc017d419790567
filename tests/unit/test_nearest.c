/* Nearest points against exhaustive search: those of a tree and those of boxes about runs of points. */
#include "harness.h"
#include "points.h"
#include "query/near_list.h"
#include "query/point_boxes.h"
#include <string.h>

enum { MOST = 3000 };

typedef struct {
    double square, p[3];
} candidate;

static int compare_candidates(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    if (x->square != y->square) return (x->square > y->square) - (x->square < y->square);
    for (int k = 0; k < 3; k++)
        if (x->p[k] != y->p[k]) return (x->p[k] > y->p[k]) - (x->p[k] < y->p[k]);
    return 0;
}

/* Sorts all points by distance, then lexicographically. */
static void sort_all(const double *points, size_t n, const double *p, candidate *all) {
    for (size_t i = 0; i < n; i++) {
        all[i].square = brio_square_distance(p, points + 3 * i);
        memcpy(all[i].p, points + 3 * i, sizeof all[i].p);
    }
    qsort(all, n, sizeof *all, compare_candidates);
}

static void expect_first(const candidate *all, const double (*point)[3], const brio_near_point *near, size_t found) {
    size_t wrong = 0, twice = 0;
    for (size_t i = 0; i < found; i++) {
        wrong += near[i].square != all[i].square || memcmp(point[near[i].place], all[i].p, sizeof all[i].p) != 0;
        for (size_t j = 0; j < i; j++) twice += near[i].place == near[j].place;
    }
    EXPECT(wrong == 0 && twice == 0, "%zu of %zu wrong, %zu twice", wrong, found, twice);
}

static void make_points(size_t trial, size_t n, double *p) {
    if (trial % 4 == 0)
        integer_points(trial, n, 1 + (uint32_t)trial % 7, p);
    else if (trial % 4 == 1)
        clustered_points(trial, n, p);
    else if (trial % 4 == 2)
        sphere_points(trial, n, p);
    else
        for (size_t i = 0; i < 3 * n; i++) p[i] = trial % 8 == 3 ? 1 : (double)(i % 3 == 0) * (double)i;
}

static void check_queries(brio_context *ctx, size_t trial, size_t n) {
    static double p[3 * MOST];
    static candidate all[MOST];
    brio_near_point near[BRIO_NEAR_ROOM];
    brio_rng rng = brio_rng_new(trial);
    brio_point_boxes boxes;
    brio_point_tree tree;
    make_points(trial, n, p);
    EXPECT(brio_point_boxes_new(ctx, p, n, &boxes) == BRIO_OK && brio_point_tree_new(ctx, p, n, &tree) == BRIO_OK);
    for (int i = 0; i < 10; i++) {
        size_t q = brio_rng_below(&rng, (uint32_t)n), k = 1 + brio_rng_below(&rng, BRIO_MOST_NEAR);
        sort_all(p, n, p + 3 * q, all);
        size_t found = brio_nearest_in_boxes(&boxes, q, k, near);
        EXPECT(found == (k < n ? k : n), "%zu of %zu, %zu wanted", found, n, k);
        expect_first(all, boxes.point, near, found);
        double bound = i % 2 ? INFINITY : all[k < n ? k - 1 : n - 1].square * (1 + i / 4.0);
        found = brio_nearest_points(&tree, p + 3 * q, k, bound, near);
        EXPECT(found == (k < n ? k : n), "tree: %zu of %zu, %zu wanted", found, n, k);
        brio_sort_near_points(&tree, near, found);
        expect_first(all, (const double(*)[3])tree.point, near, found);
    }
    brio_point_boxes_free(ctx, &boxes);
    brio_point_tree_free(ctx, &tree);
}

static void nearest_points_are_the_first_of_all(void) {
    brio_context *ctx = new_context();
    for (size_t trial = 0; trial < 64; trial++) check_queries(ctx, trial, trial < 40 ? 1 + 2 * trial : MOST);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* A list of points that come in any order, of which some are farther than doubles can say. */
static void lists_keep_the_nearest_whatever_the_distances(void) {
    static double p[160][3];
    static candidate all[160];
    for (size_t trial = 0; trial < 300; trial++) {
        brio_near_point near[BRIO_NEAR_ROOM];
        brio_rng rng = brio_rng_new(trial);
        size_t wanted = 1 + brio_rng_below(&rng, BRIO_MOST_NEAR), n = wanted + brio_rng_below(&rng, 97);
        for (size_t i = 0; i < n; i++)
            for (int k = 0; k < 3; k++)
                p[i][k] = ldexp(brio_rng_double(&rng), (int)brio_rng_below(&rng, 1 + 4 * (uint32_t)trial));
        brio_near_list l = brio_near_list_for((const double(*)[3])p, (double[3]){0, 0, 0}, wanted, near);
        for (size_t i = 0; i < n; i++) brio_offer_points(&l, i, i + 1);
        if (l.size > wanted) brio_keep_nearest(&l);
        sort_all(*p, n, (double[3]){0, 0, 0}, all);
        brio_sort_near_list((const double(*)[3])p, near, l.size);
        EXPECT(l.size == wanted, "%zu of %zu", l.size, wanted);
        expect_first(all, (const double(*)[3])p, near, l.size);
    }
}

/* Full lists of points at one distance: as many places decide as there are points, not as there are pairs of them. */
static void ties_are_kept_in_linear_time(void) {
    static double p[BRIO_NEAR_ROOM][3];
    brio_near_point near[BRIO_NEAR_ROOM];
    for (size_t i = 0; i < BRIO_NEAR_ROOM; i++)
        for (int k = 0; k < 3; k++) p[i][k] = i % 3 == (size_t)k ? i % 2 ? 1 : -1 : 0;
    brio_near_list l = brio_near_list_for((const double(*)[3])p, (double[3]){0, 0, 0}, BRIO_MOST_NEAR, near);
    for (size_t i = 0; i < BRIO_NEAR_ROOM; i++) near[l.size++] = (brio_near_point){1, (uint32_t)i};
    brio_keep_nearest(&l);
    EXPECT(l.size == BRIO_MOST_NEAR && 0 < l.compared && l.compared <= 8 * BRIO_NEAR_ROOM, "%zu pairs", l.compared);
}

/* Among 60,000 points at 60 positions, a query takes comparisons in proportion to the points wanted. */
static void points_at_few_positions_take_few_comparisons(void) {
    enum { POSITIONS = 60, TIMES = 1000 };
    static double p[POSITIONS * TIMES][3];
    brio_context *ctx = new_context();
    brio_near_point near[BRIO_NEAR_ROOM];
    brio_point_tree tree;
    clustered_points(1, POSITIONS, *p);
    for (size_t i = POSITIONS; i < POSITIONS * TIMES; i++) memcpy(p[i], p[i % POSITIONS], sizeof *p);
    EXPECT(brio_point_tree_new(ctx, *p, POSITIONS * TIMES, &tree) == BRIO_OK);
    for (size_t wanted = 1; wanted <= BRIO_MOST_NEAR; wanted *= 2) {
        size_t compared = 0;
        for (size_t q = 0; q < POSITIONS; q++) {
            brio_near_list l = brio_near_list_for((const double(*)[3])tree.point, p[q], wanted, near);
            brio_offer_tree(&l, &tree);
            EXPECT(l.size >= wanted, "%zu of %zu", l.size, wanted);
            compared += l.compared;
        }
        EXPECT(compared <= POSITIONS * (16 * wanted + 32), "%zu wanted: %zu pairs", wanted, compared);
    }
    brio_point_tree_free(ctx, &tree);
    brio_context_free(ctx);
}

/* From far away all points of a cluster are beyond each cut of the tree by less than the nearest point is away: a query
 * met all of them. */
static void queries_far_from_a_cluster_do_not_meet_all_of_it(void) {
    enum { QUERIES = 50, FEW = 2 * MOST / 3 };
    static double p[3 * MOST];
    brio_context *ctx = new_context();
    brio_near_point near[BRIO_NEAR_ROOM];
    brio_rng rng = brio_rng_new(4);
    brio_point_tree tree;
    size_t met = 0;
    for (size_t i = 0; i < 3 * MOST; i++) p[i] = 1e-4 * brio_rng_double(&rng);
    EXPECT(brio_point_tree_new(ctx, p, MOST, &tree) == BRIO_OK);
    for (int q = 0; q < QUERIES; q++) {
        double from[3] = {1 + brio_rng_double(&rng), -1 - brio_rng_double(&rng), 1 + brio_rng_double(&rng)};
        brio_near_list l = brio_near_list_for((const double(*)[3])tree.point, from, 8, near);
        brio_offer_tree(&l, &tree);
        met += l.met;
    }
    EXPECT(0 < met && met < QUERIES * FEW, "%zu points a query", met / QUERIES);
    brio_point_tree_free(ctx, &tree);
    brio_context_free(ctx);
}

SUITE(test_nearest) {
    RUN(queries_far_from_a_cluster_do_not_meet_all_of_it);
    RUN(ties_are_kept_in_linear_time);
    RUN(points_at_few_positions_take_few_comparisons);
    RUN(nearest_points_are_the_first_of_all);
    RUN(lists_keep_the_nearest_whatever_the_distances);
    return harness_end();
}
