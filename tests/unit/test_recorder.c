/* Counters in the course of the insertion: when entries are made, and that they are those of the run. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "trial.h"

enum { N = 10000 };
static double points[3 * N], weights[N];

static brio_laboratory *lab; /* of the last triangulation */

static trial_options options_of(int order, uint64_t record_every) {
    trial_options o = {0};
    o.order = order;
    o.record_every = record_every;
    return o;
}

static brio_triangulation *triangulate(brio_context *ctx, const double *w, size_t n, const trial_options *o) {
    brio_triangulation *t;
    EXPECT(trial_delaunay(ctx, points, w, n, o, &t, &lab) == BRIO_OK, "%s", brio_message(ctx));
    return t;
}

static void release(brio_triangulation *t) {
    brio_triangulation_free(t);
    brio_laboratory_free(lab);
    lab = NULL;
}

/* What holds for every list: it rises, tells what there is at the time, and ends with the totals. */
static const brio_round *expect_rounds(const brio_triangulation *t, size_t n, size_t *count) {
    const brio_round *round = brio_laboratory_rounds(lab, count);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    EXPECT(round && *count > 0);
    for (size_t i = 0; i < *count; i++) {
        EXPECT(round[i].tetrahedra == round[i].created - round[i].destroyed);
        EXPECT(round[i].seconds >= (i ? round[i - 1].seconds : 0));
        if (i == 0) continue;
        EXPECT(round[i].points > round[i - 1].points && round[i].created > round[i - 1].created);
        EXPECT(round[i].walk_steps >= round[i - 1].walk_steps && round[i].destroyed >= round[i - 1].destroyed);
        EXPECT(round[i].insphere_calls > round[i - 1].insphere_calls && round[i].history >= round[i - 1].history);
    }
    const brio_round *last = &round[*count - 1];
    EXPECT(last->points == n && last->tetrahedra == s->tetrahedra + s->hull_facets);
    EXPECT(last->created == s->created && last->destroyed == s->destroyed &&
           last->history == brio_laboratory_results(lab)->history);
    EXPECT(last->insphere_calls == s->insphere_calls);
    return round;
}

static void nothing_is_recorded_unless_asked_for(void) {
    brio_context *ctx = new_context();
    size_t count = 9;
    brio_triangulation *t = triangulate(ctx, NULL, N, NULL);
    EXPECT(brio_laboratory_rounds(lab, &count) == NULL && count == 0);
    release(t);
    brio_context_free(ctx);
}

/* With ratio 1/2 the points in at the ends of the rounds double, within what chance does. */
static void orders_with_rounds_have_an_entry_each(void) {
    brio_context *ctx = new_context();
    for (int threads = 1; threads <= 2; threads++) {
        size_t count;
        trial_options o = options_of(TRIAL_BRIO_OCTREE, BRIO_RECORD_ROUNDS);
        brio_context_set_threads(ctx, threads);
        brio_triangulation *t = triangulate(ctx, NULL, N, &o);
        const brio_round *round = expect_rounds(t, N, &count);
        EXPECT(count >= 8 && count <= 14, "%zu rounds", count);
        for (size_t i = count - 4; i < count; i++)
            EXPECT(fabs((double)round[i].points / (double)round[i - 1].points - 2) < 0.3, "round %zu", i);
        release(t);
    }
    brio_context_free(ctx);
}

static void orders_without_rounds_have_one_at_each_doubling(void) {
    const size_t expected[] = {4096, 8192, N};
    const int orders[] = {BRIO_ORDER_HILBERT, BRIO_ORDER_RANDOM, BRIO_ORDER_INPUT, TRIAL_OCTREE};
    brio_context *ctx = new_context();
    for (size_t k = 0; k < sizeof orders / sizeof *orders; k++) {
        size_t count;
        trial_options o = options_of(orders[k], BRIO_RECORD_ROUNDS);
        brio_triangulation *t = triangulate(ctx, NULL, N, &o);
        const brio_round *round = expect_rounds(t, N, &count);
        EXPECT(count == 3);
        for (size_t i = 0; i < count && i < 3; i++) EXPECT(round[i].points == expected[i]);
        release(t);
    }
    brio_context_free(ctx);
}

/* Entries fall on multiples and on the end, for any number of threads, and change no answer. */
static void every_so_many_points(void) {
    brio_context *ctx = new_context();
    uint64_t plain, sum;
    brio_triangulation *t = triangulate(ctx, weights, N, NULL);
    EXPECT(brio_triangulation_checksum(ctx, t, points, &plain) == BRIO_OK);
    release(t);
    for (int threads = 1; threads <= 3; threads += 2)
        for (int order = 0; order < TRIAL_ORDERS; order += 4) {
            size_t count;
            trial_options o = options_of(order, 3000);
            brio_context_set_threads(ctx, threads);
            t = triangulate(ctx, weights, N, &o);
            const brio_round *round = expect_rounds(t, N, &count);
            EXPECT(count == 4);
            for (size_t i = 0; i + 1 < count; i++) EXPECT(round[i].points == 3000 * (i + 1));
            EXPECT(brio_triangulation_checksum(ctx, t, points, &sum) == BRIO_OK && sum == plain);
            release(t);
        }
    brio_context_free(ctx);
}

/* After every point: the first entry is that of the first tetrahedron. */
static void few_points_have_an_entry_at_the_end(void) {
    brio_context *ctx = new_context();
    const uint64_t everies[] = {1, 2, 1000, UINT64_MAX - 1, BRIO_RECORD_ROUNDS};
    for (size_t k = 0; k < sizeof everies / sizeof *everies; k++)
        for (size_t n = 0; n <= 6; n++) {
            size_t count;
            trial_options o = options_of(BRIO_ORDER_INPUT, everies[k]);
            brio_triangulation *t = triangulate(ctx, NULL, n, &o);
            const brio_round *round = brio_laboratory_rounds(lab, &count);
            EXPECT(count > 0 && round[count - 1].points == n, "%zu points", n);
            if (everies[k] == 1 && n >= 4) EXPECT(count == n - 3 && round[0].points == 4 && round[0].tetrahedra == 5);
            if (everies[k] > 6) EXPECT(count == 1);
            release(t);
        }
    brio_context_free(ctx);
}

static brio_status record_everything(brio_context *ctx) {
    trial_options o = options_of(TRIAL_BRIO_KDTREE, 1);
    brio_triangulation *t;
    brio_status status = trial_delaunay(ctx, points, NULL, 100, &o, &t, NULL);
    release(t);
    return status;
}

static void refused_memory_is_a_status(void) {
    expect_clean_failures(record_everything);
}

SUITE(test_recorder) {
    uniform_points(1, N, points);
    for (size_t i = 0; i < N; i++) weights[i] = 1e-3 * points[(7 * i) % N];
    RUN(nothing_is_recorded_unless_asked_for);
    RUN(orders_with_rounds_have_an_entry_each);
    RUN(orders_without_rounds_have_one_at_each_doubling);
    RUN(every_so_many_points);
    RUN(few_points_have_an_entry_at_the_end);
    RUN(refused_memory_is_a_status);
    return harness_end();
}
