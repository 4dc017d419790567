/* bench_locate [N [Q [THREADS]]]: queries a second of a locator of N uniform points (default 1,000,000), with Q uniform
 * queries (default 1,000,000) in random order, one at a time in random order, and in order.
 *
 * In order: the queries in the order of the boxes of a grid; the library sorts them again. Each line is the median of
 * three runs, in CPU time of all threads. */
#include <brio/brio.h>
#include <brio/testdata.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RUNS = 3 };

static brio_context *ctx;

static void require(brio_status status) {
    if (status == BRIO_OK) return;
    fprintf(stderr, "%s\n", brio_message(ctx));
    exit(1);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef struct {
    const brio_locator *locator;
    const double *queries, *values;
    size_t count;
    uint32_t *found;
    double *results;
} work;

static void tetrahedra(const work *w) {
    require(brio_locator_tetrahedra(ctx, w->locator, w->queries, w->count, w->found));
}
static void one_at_a_time(const work *w) {
    for (size_t i = 0; i < w->count; i++)
        require(brio_locator_tetrahedra(ctx, w->locator, w->queries + 3 * i, 1, w->found + i));
}
static void nearest(const work *w) {
    require(brio_locator_nearest(ctx, w->locator, w->queries, w->count, 1, w->found));
}
static void nearest_eight(const work *w) {
    require(brio_locator_nearest(ctx, w->locator, w->queries, w->count, 8, w->found));
}

static void interpolate(const work *w, brio_interpolation_method method) {
    brio_interpolation o = {0};
    o.method = method;
    o.values = w->values;
    require(brio_locator_interpolate(ctx, w->locator, w->queries, w->count, &o, w->results));
}
static void linear(const work *w) {
    interpolate(w, BRIO_INTERPOLATION_LINEAR);
}
static void natural(const work *w) {
    interpolate(w, BRIO_INTERPOLATION_NATURAL);
}

static void measure(const char *name, void (*run)(const work *), const work *w) {
    double seconds[RUNS];
    for (int i = 0; i < RUNS; i++) {
        double start = now();
        run(w);
        seconds[i] = now() - start;
    }
    qsort(seconds, RUNS, sizeof *seconds, compare_doubles);
    printf("%-32s %8.0f ns CPU a query %9.3f M queries a second of CPU\n", name,
           1e9 * seconds[RUNS / 2] / (double)w->count, 1e-6 * (double)w->count / seconds[RUNS / 2]);
    fflush(stdout);
}

/* Copies queries in the order of the boxes of a grid, each row of boxes in the direction opposite to the one before. */
static double *in_boxes(const double *queries, size_t count) {
    enum { SIDE = 64, BOXES = SIDE * SIDE * SIDE };
    double *sorted = malloc(3 * count * sizeof *sorted);
    size_t *start = calloc(BOXES + 1, sizeof *start), *box = malloc(count * sizeof *box);
    for (size_t i = 0; i < count; i++) {
        size_t cell[3];
        for (size_t k = 0; k < 3; k++) cell[k] = (size_t)(queries[3 * i + k] * SIDE) % SIDE;
        if (cell[0] % 2) cell[1] = SIDE - 1 - cell[1];
        if (cell[1] % 2) cell[2] = SIDE - 1 - cell[2];
        start[(box[i] = (cell[0] * SIDE + cell[1]) * SIDE + cell[2]) + 1]++;
    }
    for (size_t b = 0; b < BOXES; b++) start[b + 1] += start[b];
    for (size_t i = 0; i < count; i++) memcpy(sorted + 3 * start[box[i]]++, queries + 3 * i, 3 * sizeof *sorted);
    free(start);
    free(box);
    return sorted;
}

int main(int argc, char **argv) {
    size_t n = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000000, count = argc > 2 ? strtoul(argv[2], NULL, 10) : 1000000;
    brio_generate_options o = {0};
    brio_mesh *points, *queries;
    brio_triangulation *t;
    brio_locator *locator;
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
    brio_context_set_threads(ctx, argc > 3 ? atoi(argv[3]) : 1);
    require(brio_generate(ctx, BRIO_KIND_CUBE, n, &o, &points));
    o.seed = 2;
    require(brio_generate(ctx, BRIO_KIND_CUBE, count, &o, &queries));
    require(brio_delaunay(ctx, points->vertices, NULL, n, NULL, &t));
    double start = now();
    size_t before = brio_context_memory(ctx);
    require(brio_locator_new(ctx, t, points->vertices, NULL, n, &locator));
    printf("locator of %zu points: %.2f s CPU, %.0f bytes a point\n", n, now() - start,
           (double)(brio_context_memory(ctx) - before) / (double)n);
    brio_triangulation_free(t);
    double *values = malloc(n * sizeof *values), *sorted = in_boxes(queries->vertices, count);
    for (size_t i = 0; i < n; i++) values[i] = points->vertices[3 * i];
    work w = {locator,
              queries->vertices,
              values,
              count,
              malloc(8 * count * sizeof(uint32_t)),
              malloc(count * sizeof(double))};
    work in_order = w, fewer = w;
    in_order.queries = sorted;
    fewer.count = count / 10;
    measure("tetrahedra, random", tetrahedra, &w);
    measure("tetrahedra, in order", tetrahedra, &in_order);
    measure("tetrahedra, random, single calls", one_at_a_time, &fewer);
    measure("nearest, random", nearest, &w);
    measure("nearest, in order", nearest, &in_order);
    measure("8 nearest, random", nearest_eight, &fewer);
    measure("linear, random", linear, &w);
    measure("natural neighbours, random", natural, &fewer);
    free(w.found), free(w.results), free(values), free(sorted);
    brio_locator_free(locator);
    brio_mesh_free(points);
    brio_mesh_free(queries);
    brio_context_free(ctx);
    return 0;
}
