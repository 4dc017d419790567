/* Parallel insertion: one answer for every number of threads, clean ends when something fails in the middle. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include <pthread.h>
#include <unistd.h>

enum {
    N = SHORT_TESTS ? 12000 : 40000,
    REPETITIONS = BRIEF_TESTS   ? 2
                  : SHORT_TESTS ? 4
                                : 20,
    SPARSE = BRIEF_TESTS   ? 24
             : SHORT_TESTS ? 4
                           : 1,
    LEAST_THREADS = BRIEF_TESTS   ? 8
                    : SHORT_TESTS ? 3
                                  : 2
};

static double points[3 * N], weights[N];

/* The whole result of a run as one number: tetrahedra in their order, mates, representatives, counts. */
static brio_status run(const double *p, const double *w, size_t n, int threads, brio_delaunay_stats *stats,
                       uint64_t *sum) {
    brio_context *ctx = new_context();
    brio_triangulation *t = NULL;
    brio_context_set_threads(ctx, threads);
    brio_status status = brio_delaunay(ctx, p, w, n, NULL, &t);
    if (status == BRIO_OK) {
        *stats = *brio_triangulation_stats(t);
        *sum = brio_mix(stats->vertices) ^ brio_mix(stats->hidden + 77);
        const uint32_t *number = (const uint32_t *)brio_triangulation_tetrahedra(t);
        for (size_t i = 0; i < 8 * (stats->tetrahedra + stats->hull_facets); i++) *sum = brio_mix(*sum + number[i]);
        for (size_t i = 0; i < n; i++) *sum = brio_mix(*sum + brio_triangulation_representatives(t)[i]);
    }
    brio_triangulation_free(t);
    brio_context_free(ctx);
    return status;
}

static uint64_t fingerprint(const double *p, const double *w, size_t n, int threads, brio_delaunay_stats *stats) {
    uint64_t sum = 0;
    EXPECT(run(p, w, n, threads, stats, &sum) == BRIO_OK, "%zu points, %d threads", n, threads);
    return sum;
}

/* Some points and weights twice, so that first comers matter. */
static void repeat_some(size_t n) {
    for (size_t i = 0; i + 7 < n; i += 7)
        memcpy(points + 3 * (i + 3), points + 3 * ((i * 31) % n), 3 * sizeof *points),
            weights[i + 3] = weights[(i * 31) % n];
}

static void make_set(int set) {
    if (set == 0) uniform_points(1, N, points);
    if (set == 1) clustered_points(2, N, points);
    if (set == 2) integer_points(3, N, 40, points);
    if (set == 3) sphere_points(4, N, points);
    if (set == 4) torus_points(5, N, points);
    if (set == 5) uniform_points(6, N, points), repeat_some(N);
    integer_weights(7, N, 5, weights);
    for (size_t i = 0; i < N; i++) weights[i] *= set == 2 ? 1 : 1e-5;
    if (set == 5) repeat_some(N);
}

static void every_number_of_threads_gives_the_same_arrays(void) {
    for (int set = 0; set < 6; set++) {
        make_set(set);
        size_t n = set == 4 ? N / 2 : N;
        for (int weighted = BRIEF_TESTS ? set % 2 : 0; weighted < 2; weighted += BRIEF_TESTS ? 2 : 1) {
            brio_delaunay_stats one, many;
            uint64_t expected = fingerprint(points, weighted ? weights : NULL, n, 1, &one), deferred = 0;
            for (int threads = LEAST_THREADS; threads <= 8; threads += threads < 3 ? 1 : 5) {
                uint64_t found = fingerprint(points, weighted ? weights : NULL, n, threads, &many);
                EXPECT(found == expected, "set %d, weighted %d, %d threads", set, weighted, threads);
                EXPECT(many.duplicates == one.duplicates && many.hidden == one.hidden);
                deferred += many.deferred;
            }
            EXPECT(deferred > 0, "set %d was not parallel at all", set);
        }
    }
}

static void repeated_runs_give_the_same_arrays(void) {
    brio_delaunay_stats stats;
    make_set(5);
    uint64_t expected = fingerprint(points, NULL, N, 1, &stats);
    for (int run = 0; run < REPETITIONS; run++)
        EXPECT(fingerprint(points, NULL, N, 1 + run % 8, &stats) == expected, "run %d", run);
}

static void shuffled_points_give_the_same_checksum(void) {
    static double shuffled[3 * N];
    static size_t to[N];
    uint64_t expected = 0;
    make_set(1);
    for (int run = 0; run < (BRIEF_TESTS ? 4 : 6); run++) {
        brio_context *ctx = new_context();
        brio_triangulation *t = NULL;
        uint64_t sum = 0;
        shuffle_points((uint64_t)run, N, points, shuffled, to);
        brio_context_set_threads(ctx, 1 + run);
        EXPECT(brio_delaunay(ctx, shuffled, NULL, N, NULL, &t) == BRIO_OK);
        EXPECT(brio_triangulation_checksum(ctx, t, shuffled, &sum) == BRIO_OK);
        if (!run) expected = sum;
        EXPECT(sum == expected, "run %d", run);
        brio_triangulation_free(t);
        brio_context_free(ctx);
    }
}

static void more_threads_than_work(void) {
    brio_delaunay_stats stats;
    for (size_t n = 0; n < 12; n++) {
        uniform_points(n, n, points);
        EXPECT(fingerprint(points, NULL, n, 64, &stats) == fingerprint(points, NULL, n, 1, &stats), "%zu points", n);
    }
    memset(points, 0, sizeof points);
    EXPECT(fingerprint(points, NULL, N, 64, &stats) == fingerprint(points, NULL, N, 1, &stats), "coincident");
    integer_points(1, N, 1000, points);
    for (size_t i = 0; i < N; i++) points[3 * i + 2] = 0;
    EXPECT(fingerprint(points, NULL, N, 64, &stats) == fingerprint(points, NULL, N, 1, &stats), "in a plane");
    uniform_points(9, N, points);
    EXPECT(fingerprint(points, NULL, N, 64, &stats) == fingerprint(points, NULL, N, 1, &stats), "64 threads");
}

static void result_of_threads_passes_the_check(void) {
    make_set(1);
    brio_context *ctx = new_context();
    brio_triangulation *t = NULL;
    brio_context_set_threads(ctx, 4);
    EXPECT(brio_delaunay(ctx, points, NULL, N, NULL, &t) == BRIO_OK);
    EXPECT(brio_triangulation_check(ctx, t, points, NULL, N) == BRIO_OK, "%s", brio_message(ctx));
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static int cancel_at(const char *stage, double fraction, void *user) {
    (void)stage;
    return fraction > *(double *)user;
}

static void cancelled_threads_free_everything(void) {
    make_set(0);
    for (double limit = 0.05; limit < 1; limit += 0.15) {
        brio_context *ctx = new_context();
        brio_triangulation *t;
        brio_context_set_threads(ctx, 4);
        brio_context_set_progress(ctx, cancel_at, &limit);
        EXPECT(brio_delaunay(ctx, points, NULL, N, NULL, &t) == BRIO_ERR_CANCELLED && t == NULL, "at %g", limit);
        EXPECT(brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
}

static void memory_running_out_in_a_thread_is_a_status(void) {
    make_set(0);
    int refused = 0, done = 0;
    for (size_t limit = (size_t)100 * N; limit < (size_t)3200 * N; limit += limit / (BRIEF_TESTS ? 3 : 6)) {
        brio_context *ctx = new_context();
        brio_triangulation *t;
        brio_context_set_threads(ctx, 4);
        brio_context_set_memory_limit(ctx, limit);
        brio_status status = brio_delaunay(ctx, points, NULL, N, NULL, &t);
        EXPECT(status == BRIO_OK || (status == BRIO_ERR_NO_MEMORY && !t), "%s", brio_message(ctx));
        refused += status != BRIO_OK, done += status == BRIO_OK;
        brio_triangulation_free(t);
        EXPECT(brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
    EXPECT(refused > 5 && done > 0);
}

static void few_tetrahedra_allowed_is_a_status(void) {
    make_set(0);
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_delaunay_options o = {0};
    o.max_tetrahedra = 5 * N;
    brio_context_set_threads(ctx, 4);
    EXPECT(brio_delaunay(ctx, points, NULL, N, &o, &t) == BRIO_ERR_TOO_LARGE && !t);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void skew_lines(size_t n) {
    brio_rng rng = brio_rng_new(8);
    for (size_t i = 0; i < n; i++) {
        double x = brio_rng_double(&rng);
        points[3 * i] = i % 2 ? x : 0, points[3 * i + 1] = i % 2 ? 0 : x, points[3 * i + 2] = i % 2 ? 1 : 0;
    }
}

static brio_status run_with_failure(size_t n, size_t k, bool *reached) {
    failing_memory memory = {k, 0};
    brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
    brio_context *ctx;
    brio_triangulation *t = NULL;
    brio_status status = brio_context_new(&allocator, &ctx);
    *reached = !memory.left;
    if (status != BRIO_OK) return status;
    brio_context_set_threads(ctx, 3);
    status = brio_delaunay(ctx, points, NULL, n, NULL, &t);
    EXPECT((status == BRIO_OK) == (t != NULL), "allocation %zu: %d", k, (int)status);
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0, "allocation %zu", k);
    brio_context_free(ctx);
    *reached = !memory.left;
    return status;
}

/* A failing allocation in the middle of a pass: every 37th of a run with the caller's allocator. Between skew lines
 * cavities are larger than their stars and joined by a hash table: a thread once went on after it had failed there. */
static void failed_allocations_in_threads_are_statuses(void) {
    for (int set = 0; set < 2; set++) {
        size_t n = set ? 1500 : N / 2;
        if (set)
            skew_lines(n);
        else
            make_set(0);
        bool reached = true;
        for (size_t k = 1; k < 1000 && reached; k += SPARSE * (set ? 11 : 37)) {
            brio_status status = run_with_failure(n, k, &reached);
            EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_MEMORY, "set %d, allocation %zu: %d", set, k,
                   (int)status);
        }
    }
}

typedef struct {
    int threads;
    uint64_t found;
    brio_delaunay_stats stats;
    brio_status status;
} caller;

static void *call(void *user) {
    caller *c = user;
    c->status = run(points, NULL, N, c->threads, &c->stats, &c->found);
    return NULL;
}

static void two_callers_with_a_context_each(void) {
    make_set(1);
    brio_delaunay_stats stats;
    uint64_t expected = fingerprint(points, NULL, N, 1, &stats);
    caller callers[3] = {{.threads = 2}, {.threads = 3}, {.threads = 1}};
    pthread_t thread[3];
    for (int i = 0; i < 3; i++) EXPECT(pthread_create(&thread[i], NULL, call, &callers[i]) == 0);
    for (int i = 0; i < 3; i++) {
        pthread_join(thread[i], NULL);
        EXPECT(callers[i].status == BRIO_OK && callers[i].found == expected, "caller %d", i);
    }
}

/* A thread that waits for ever ends the program by a signal, which is a failure. */
static void watch(void) {
    enum { SECONDS = 800 };
    alarm(SECONDS);
}

SUITE(test_parallel) {
    watch();
    RUN(every_number_of_threads_gives_the_same_arrays);
    RUN(repeated_runs_give_the_same_arrays);
    RUN(shuffled_points_give_the_same_checksum);
    RUN(more_threads_than_work);
    RUN(two_callers_with_a_context_each);
    RUN(result_of_threads_passes_the_check);
    RUN(cancelled_threads_free_everything);
    RUN(memory_running_out_in_a_thread_is_a_status);
    RUN(few_tetrahedra_allowed_is_a_status);
    RUN(failed_allocations_in_threads_are_statuses);
    return harness_end();
}
