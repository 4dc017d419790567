/* How long changes of a living triangulation take, in uniform points, with one thread.
 *   bench_dynamic [POINTS [CHANGES]]
 * Prints medians of microseconds for one insertion at a random place and for one removal, and seconds for steps that
 * move all points by shares of their spacing beside those of building anew. Processor time where many calls are added up. */
#include "brio/brio.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static uint64_t state = 1;

static double draw(void) {
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) * 0x1p-53;
}

static double seconds(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void check(brio_context *ctx, brio_status status) {
    if (status == BRIO_OK) return;
    fprintf(stderr, "%s\n", brio_message(ctx));
    exit(1);
}

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
    for (size_t i = 0, index = 1; i < changes; i++) {
        do index = (index * 2654435761u + 12345) % n;
        while (brio_dynamic_point(d, (uint32_t)index, NULL) == BRIO_DYNAMIC_NONE);
        double start = seconds(CLOCK_MONOTONIC);
        check(ctx, brio_dynamic_remove(d, &(uint32_t){(uint32_t)index}, 1));
        sum += took[i] = seconds(CLOCK_MONOTONIC) - start;
    }
    printf("remove one: median %.2f us, mean %.2f us\n", 1e6 * median(took, changes), 1e6 * sum / (double)changes);
    free(took);
}

static void batches(brio_context *ctx, brio_dynamic *d, size_t n) {
    size_t some = n / 100;
    double *p = malloc(3 * some * sizeof *p), start;
    uint32_t first, *index = malloc(some * sizeof *index);
    for (size_t i = 0; i < 3 * some; i++) p[i] = draw();
    start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(ctx, brio_dynamic_insert(d, p, NULL, some, &first));
    printf("insert 1 %%: %.4f s\n", seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
    for (size_t i = 0; i < some; i++) index[i] = first + (uint32_t)i;
    start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(ctx, brio_dynamic_remove(d, index, some));
    printf("remove 1 %%: %.4f s\n", seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
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
    enum { STEPS = 10 };
    double *p = malloc(3 * n * sizeof *p), took[STEPS], sum = 0;
    brio_dynamic *d;
    brio_triangulation *t;
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
    double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(ctx, brio_delaunay(ctx, p, NULL, n, NULL, &t));
    double anew = seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
    check(ctx, brio_triangulation_checksum(ctx, t, p, &built));
    check(ctx, brio_dynamic_checksum(ctx, d, &own));
    brio_triangulation_free(t);
    brio_dynamic_stats after = {.size = sizeof after};
    check(ctx, brio_dynamic_facts(d, &after));
    printf("move all by %g spacings: anew %.4f s; first step %.4f s, %.2f x; mean of %d more %.4f s, %.2f x; "
           "replaced %llu, built anew %llu%s\n",
           share, anew, took[0], anew / took[0], STEPS - 1, sum, anew / sum, (unsigned long long)after.replaced,
           (unsigned long long)after.anew, own == built ? "" : "  DIFFERENT");
    brio_dynamic_free(d);
    free(p);
}

int main(int argc, char **argv) {
    size_t n = argc > 1 ? (size_t)atoll(argv[1]) : 100000, changes = argc > 2 ? (size_t)atoll(argv[2]) : n / 10;
    static const double SHARE[] = {1e-4, 1e-3, 5e-3, 2e-2, 0.1};
    double *points = malloc(3 * n * sizeof *points);
    brio_context *ctx;
    brio_dynamic *d;
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
    brio_context_set_threads(ctx, 1);
    for (size_t i = 0; i < 3 * n; i++) points[i] = draw();
    double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    check(ctx, brio_dynamic_new(ctx, points, NULL, n, 0, &d));
    printf("build %zu points: %.3f s\n", n, seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
    one_by_one(ctx, d, n, changes);
    batches(ctx, d, n);
    brio_dynamic_free(d);
    for (size_t i = 0; i < sizeof SHARE / sizeof *SHARE; i++) move_all(ctx, points, n, SHARE[i]);
    brio_context_free(ctx);
    free(points);
    return 0;
}
