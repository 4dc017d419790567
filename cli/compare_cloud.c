/* Points compared with a surface: signed distances as a property, their percentiles and their histogram. */
#include "compare_cloud.h"
#include "properties.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BINS = 20 };

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the number of nearest rank. */
static double at_percent(const double *sorted, size_t count, double percent) {
    size_t rank = (size_t)ceil(percent / 100 * (double)count);
    return sorted[rank > 0 ? rank - 1 : 0];
}

static void report_percentiles(facts *f, const double *sorted, size_t count) {
    static const struct {
        const char *name;
        double percent;
    } rows[] = {{"p1", 1}, {"p5", 5}, {"p25", 25}, {"p50", 50}, {"p75", 75}, {"p95", 95}, {"p99", 99}};
    cli_fact_open(f, "percentiles", FACT_OBJECT);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        cli_fact_real(f, rows[i].name, at_percent(sorted, count, rows[i].percent));
    cli_fact_close(f);
}

/* Bins of one width between the least and the greatest distance; the last one has its end. */
static void report_histogram(facts *f, const double *sorted, size_t count) {
    uint64_t bins[BINS] = {0};
    double low = sorted[0], high = sorted[count - 1];
    for (size_t i = 0; i < count; i++) {
        double place = high > low ? (sorted[i] - low) / (high - low) * BINS : 0;
        bins[place < BINS - 1 ? (size_t)place : BINS - 1]++;
    }
    cli_fact_open(f, "histogram", FACT_OBJECT);
    cli_fact_real(f, "low", low);
    cli_fact_real(f, "high", high);
    cli_fact_open(f, "counts", FACT_LIST);
    for (int i = 0; i < BINS; i++) cli_fact_count(f, NULL, bins[i]);
    cli_fact_close(f);
    cli_fact_close(f);
}

/* Reports distances, which are sorted.   magnitudes  the same without signs, sorted. */
static void report(facts *f, const double *sorted, const double *magnitudes, size_t count) {
    double sum = 0, signs = 0, squares = 0;
    for (size_t i = 0; i < count; i++) {
        signs += sorted[i];
        sum += magnitudes[i];
        squares += magnitudes[i] * magnitudes[i];
    }
    cli_fact_count(f, "points", count);
    cli_fact_real(f, "mean", sum / (double)count);
    cli_fact_real(f, "rms", sqrt(squares / (double)count));
    cli_fact_real(f, "p95", at_percent(magnitudes, count, 95));
    cli_fact_real(f, "hausdorff", magnitudes[count - 1]);
    cli_fact_real(f, "signed_mean", signs / (double)count);
    report_percentiles(f, sorted, count);
    report_histogram(f, sorted, count);
}

brio_status cli_judge_within(run *r, double worst, double within, size_t outside, size_t all) {
    cli_fact_bool(&r->facts, "within", worst <= within);
    cli_fact_count(&r->facts, "outside", outside);
    if (worst <= within) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_CHECK, "%zu of %zu points are farther than %g, the farthest %g", outside, all, within,
                    worst);
}

static brio_status add_property(run *r, brio_mesh *points, const double *distance) {
    brio_status status = BRIO_OK;
    void *data;
    cli_set_aside(r, points, "distance");
    TRY(brio_mesh_add_property(points, "distance", BRIO_SCALAR_FLOAT64, &data));
    memcpy(data, distance, points->num_vertices * sizeof *distance);
done:
    return status;
}

brio_status cli_compare_cloud(run *r, brio_mesh *points, const brio_mesh *surface, double within) {
    size_t n = points->num_vertices, outside = 0;
    double *distance = malloc((n + 1) * sizeof *distance), *magnitude = malloc((n + 1) * sizeof *magnitude);
    brio_status status = BRIO_OK;
    if (!distance || !magnitude) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu distances", n);
    TRY(brio_mesh_signed_distances(r->ctx, surface, points->vertices, n, distance));
    cli_lap(r, "compare");
    if (r->common.output) TRY(add_property(r, points, distance));
    for (size_t i = 0; i < n; i++) {
        magnitude[i] = fabs(distance[i]);
        outside += within > 0 && magnitude[i] > within;
    }
    qsort(distance, n, sizeof *distance, compare_doubles);
    qsort(magnitude, n, sizeof *magnitude, compare_doubles);
    report(&r->facts, distance, magnitude, n);
    TRY(cli_write(r, points));
    if (within > 0) status = cli_judge_within(r, magnitude[n - 1], within, outside, n);
done:
    free(distance);
    free(magnitude);
    return status;
}
