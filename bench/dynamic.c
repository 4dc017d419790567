/* How long changes of a living triangulation take, in uniform points.
 *   bench_dynamic [POINTS [CHANGES [THREADS [PARTS]]]]
 * PARTS are letters of what to measure, all of them where there are none:
 *   o  medians and means of microseconds for one insertion at a random place, and for one removal;
 *   b  batches of 1 % of the points: wall and processor time, beside that of building anew;
 *   m  seconds for steps that move all points by shares of their spacing, beside building anew (processor time;
 *      of builds the median of three);
 *   p  the same in a box that repeats, beside brio_delaunay_periodic, and for a snapshot.
 * THREADS: 1 if not given. */
#include "brio/brio.h"
#include "measure.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int compare(const void *p, const void *q) {
    double a = *(const double *)p, b = *(const double *)q;
    return (a > b) - (a < b);
}

static double median(double *x, size_t n) {
    qsort(x, n, sizeof *x, compare);
    return x[n / 2];
}

static void one_by_one(brio_context *ctx, brio_dynamic *d, size_t n, size_t changes) {
    double *took = malloc(changes * sizeof *took), sum = 0;
    for (size_t i = 0; i < changes; i++) {
        double p[3] = {draw(), draw(), draw()}, start = seconds(CLOCK_MONOTONIC);
        check(ctx, brio_dynamic_insert(d, p, NULL, 1, NULL));
        sum += took[i] = seconds(CLOCK_MONOTONIC) - start;
    }
    printf("insert one: median %.2f us, mean %.2f us\n", 1e6 * median(took, changes), 1e6 * sum / (double)changes);
    sum = 0;
    for (size_t i = 0, index; i < changes; i++) {
        do index = (size_t)(draw() * (double)n);
        while (brio_dynamic_point(d, (uint32_t)index, NULL) == BRIO_DYNAMIC_NONE);
        double start = seconds(CLOCK_MONOTONIC);
        check(ctx, brio_dynamic_remove(d, &(uint32_t){(uint32_t)index}, 1));
        sum += took[i] = seconds(CLOCK_MONOTONIC) - start;
    }
    printf("remove one: median %.2f us, mean %.2f us\n", 1e6 * median(took, changes), 1e6 * sum / (double)changes);
    free(took);
}

/* A time that runs in both clocks. */
typedef struct {
    double wall, processor;
} stopwatch;

static stopwatch start_watch(void) {
    return (stopwatch){seconds(CLOCK_MONOTONIC), seconds(CLOCK_PROCESS_CPUTIME_ID)};
}

static void show_batch(const char *what, stopwatch since, double anew) {
    double wall = seconds(CLOCK_MONOTONIC) - since.wall,
           processor = seconds(CLOCK_PROCESS_CPUTIME_ID) - since.processor;
    printf("%s 1 %%: wall %.4f s, processor %.4f s", what, wall, processor);
    printf(anew > 0 ? "; building anew takes %.2f x the wall time\n" : "\n", anew / wall);
}

/* Returns the median time of three builds.   checksum  NULL, or receives that of the result. */
static double time_anew(brio_context *ctx, const double *points, size_t n, clockid_t clock, uint64_t *checksum) {
    enum { BUILDS = 3 };
    double took[BUILDS];
    for (int i = 0; i < BUILDS; i++) {
        brio_triangulation *t;
        double start = seconds(clock);
        check(ctx, brio_delaunay(ctx, points, NULL, n, NULL, &t));
        took[i] = seconds(clock) - start;
        if (checksum) check(ctx, brio_triangulation_checksum(ctx, t, points, checksum));
        brio_triangulation_free(t);
    }
    return median(took, BUILDS);
}

static void batches(brio_context *ctx, brio_dynamic *d, const double *points, size_t n) {
    enum { ROUNDS = 3 };
    size_t some = n / 100;
    double *p = malloc(3 * some * sizeof *p), anew = time_anew(ctx, points, n, CLOCK_MONOTONIC, NULL),
           spacing = 1 / cbrt((double)n);
    uint32_t first, *index = malloc(some * sizeof *index);
    for (int round = 0; round < ROUNDS; round++) {
        for (size_t i = 0; i < 3 * some; i++) p[i] = draw();
        stopwatch start = start_watch();
        check(ctx, brio_dynamic_insert(d, p, NULL, some, &first));
        show_batch("insert", start, anew);
        for (size_t i = 0; i < some; i++) index[i] = first + (uint32_t)i;
        for (size_t i = 0; i < 3 * some; i++) p[i] += 0.5 * spacing * (draw() - 0.5);
        start = start_watch();
        check(ctx, brio_dynamic_move(d, index, p, NULL, some));
        show_batch("move near", start, anew);
        for (size_t i = 0; i < 3 * some; i++) p[i] = draw();
        start = start_watch();
        check(ctx, brio_dynamic_move(d, index, p, NULL, some));
        show_batch("move anywhere", start, anew);
        start = start_watch();
        check(ctx, brio_dynamic_remove(d, index, some));
        show_batch("remove", start, anew);
    }
    free(p), free(index);
}

/* Moves each point by a step in a random direction. */
static void step_all(double *p, size_t n, double step) {
    for (size_t i = 0; i < n; i++) {
        double v[3], length;
        do {
            for (int c = 0; c < 3; c++) v[c] = 2 * draw() - 1;
            length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        } while (length > 1 || length == 0);
        for (size_t c = 0; c < 3; c++) p[3 * i + c] += step * v[c] / length;
    }
}

/* Moves all points of a new triangulation some times. The first step tests all tetrahedra, the others fewer. */
static void move_all(brio_context *ctx, const double *points, size_t n, double share) {
    enum { STEPS = 6 };
    double *p = malloc(3 * n * sizeof *p), took[STEPS], sum = 0;
    brio_dynamic *d;
    uint64_t own, built;
    memcpy(p, points, 3 * n * sizeof *p);
    check(ctx, brio_dynamic_new(ctx, p, NULL, n, 0, &d));
    for (int i = 0; i < STEPS; i++) {
        step_all(p, n, share / cbrt((double)n));
        double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
        check(ctx, brio_dynamic_move(d, NULL, p, NULL, n));
        took[i] = seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
        if (i > 0) sum += took[i] / (STEPS - 1);
    }
    double anew = time_anew(ctx, p, n, CLOCK_PROCESS_CPUTIME_ID, &built);
    check(ctx, brio_dynamic_checksum(ctx, d, &own));
    brio_dynamic_stats after = {.size = sizeof after};
    check(ctx, brio_dynamic_facts(d, &after));
    printf("move all by %g spacings: anew %.4f s; first step %.4f s, %.2f x; mean of %d more %.4f s, %.2f x; "
           "replaced %llu, built anew %llu%s\n",
           share, anew, took[0], anew / took[0], STEPS - 1, sum, anew / sum, (unsigned long long)after.replaced,
           (unsigned long long)after.anew, own == built ? "" : "  DIFFERENT");
    brio_dynamic_free(d);
    free(p);
}

/* Moves all points of a box that repeats some times. */
static void move_in_a_box(brio_context *ctx, const double *points, size_t n, double share) {
    enum { STEPS = 4 };
    static const double box[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    brio_periodic_options options = {.size = sizeof options, .cell = box};
    double *p = malloc(3 * n * sizeof *p), first = 0, sum = 0;
    brio_dynamic_periodic *d;
    brio_periodic *t;
    uint64_t own, built;
    memcpy(p, points, 3 * n * sizeof *p);
    check(ctx, brio_dynamic_periodic_new(ctx, p, NULL, n, &options, &d));
    for (int i = 0; i < STEPS; i++) {
        step_all(p, n, share / cbrt((double)n));
        double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
        check(ctx, brio_dynamic_periodic_move(d, NULL, p, NULL, n));
        *(i ? &sum : &first) += seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
    }
    double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(ctx, brio_dynamic_periodic_snapshot(ctx, d, &t));
    double snapshot = seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
    check(ctx, brio_periodic_checksum(ctx, t, &own));
    brio_periodic_free(t);
    brio_dynamic_periodic_points(d, NULL, p, NULL);
    start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(ctx, brio_delaunay_periodic(ctx, p, NULL, n, &options, &t));
    double anew = seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
    check(ctx, brio_periodic_checksum(ctx, t, &built));
    brio_periodic_free(t);
    printf("in a box that repeats, move all by %g spacings: anew %.4f s; first step %.4f s; mean of %d more %.4f s; "
           "snapshot %.4f s%s\n",
           share, anew, first, STEPS - 1, sum / (STEPS - 1), snapshot, own == built ? "" : "  DIFFERENT");
    brio_dynamic_periodic_free(d);
    free(p);
}

int main(int argc, char **argv) {
    static const double SHARE[] = {1e-4, 1e-3, 5e-3, 1e-2, 2e-2, 3e-2, 5e-2, 0.1, 0.5, 5};
    size_t n = argc > 1 ? (size_t)atoll(argv[1]) : 100000, changes = argc > 2 ? (size_t)atoll(argv[2]) : n / 10;
    const char *parts = argc > 4 ? argv[4] : "obmp";
    double *points = malloc(3 * n * sizeof *points);
    brio_context *ctx;
    brio_dynamic *d;
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
    brio_context_set_threads(ctx, argc > 3 ? atoi(argv[3]) : 1);
    for (size_t i = 0; i < 3 * n; i++) points[i] = draw();
    double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(ctx, brio_dynamic_new(ctx, points, NULL, n, 0, &d));
    printf("build %zu points: %.3f s\n", n, seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
    if (strchr(parts, 'o')) one_by_one(ctx, d, n, changes);
    if (strchr(parts, 'b')) batches(ctx, d, points, n);
    brio_dynamic_free(d);
    for (size_t i = 0; i < sizeof SHARE / sizeof *SHARE && strchr(parts, 'm'); i++) move_all(ctx, points, n, SHARE[i]);
    for (size_t i = 0; i < sizeof SHARE / sizeof *SHARE && strchr(parts, 'p'); i++)
        move_in_a_box(ctx, points, n, SHARE[i]);
    brio_context_free(ctx);
    free(points);
    return 0;
}
