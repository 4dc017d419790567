/* brio compare: distances and normal deviation between two surfaces; signed distances of points from a surface. */
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include "cli/run/run.h"
#include "cli/steps/estimate.h"
#include "cli/steps/properties.h"
#include "cli/files/cloud.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- points --- */

/* Points compared with a surface: signed distances as a property, their percentiles and their histogram. */

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

/* Reports whether all points are within a limit, and fails with BRIO_ERR_CHECK if not.   outside  of `all` points. */
static brio_status judge_within(run *r, double worst, double within, size_t outside, size_t all) {
    cli_fact_bool(&r->facts, "within", !outside);
    cli_fact_count(&r->facts, "outside", outside);
    if (!outside) return BRIO_OK;
    return cli_fail(r, BRIO_ERR_CHECK, "%zu of %zu points are farther than %g, the farthest %g", outside, all, within,
                    worst);
}

static brio_status add_property(run *r, brio_mesh *points, const double *distance) {
    void *data;
    cli_set_aside(r, points, "distance");
    FORWARD(brio_mesh_add_property(points, "distance", BRIO_SCALAR_FLOAT64, &data));
    memcpy(data, distance, points->num_vertices * sizeof *distance);
    return BRIO_OK;
}

/* Reports how far points are from a surface, with the side; writes them with the property `distance` to -o.
 *  within  > 0: fails with BRIO_ERR_CHECK if a point is farther, by more than rounding. */
static brio_status compare_cloud(run *r, brio_mesh *points, const brio_mesh *surface, double within) {
    size_t n = points->num_vertices, outside = 0;
    double up_to = cli_up_to(within, fmax(cli_rounding(points), cli_rounding(surface)));
    double *distance = malloc((n + 1) * sizeof *distance), *magnitude = malloc((n + 1) * sizeof *magnitude);
    brio_status status = BRIO_OK;
    if (!distance || !magnitude) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu distances", n);
    TRY(brio_mesh_signed_distances(r->ctx, surface, points->vertices, n, distance));
    cli_lap(r, "compare");
    if (cli_wants_mesh(r)) TRY(add_property(r, points, distance));
    for (size_t i = 0; i < n; i++) {
        magnitude[i] = fabs(distance[i]);
        outside += within > 0 && magnitude[i] > up_to;
    }
    qsort(distance, n, sizeof *distance, compare_doubles);
    qsort(magnitude, n, sizeof *magnitude, compare_doubles);
    report(&r->facts, distance, magnitude, n);
    TRY(cli_write(r, points));
    if (within > 0) status = judge_within(r, magnitude[n - 1], within, outside, n);
done:
    free(distance);
    free(magnitude);
    return status;
}

/* --- the command --- */

typedef struct arguments {
    uint64_t samples;
    double within;
} arguments;

static const option options[] = {
    {"samples", 0, OPTION_NATURAL | OPTION_POSITIVE, offsetof(arguments, samples), "N",
     "points on each of two surfaces (default 100000)", 0},
    {"within", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, within), "D",
     "exit with code 5 if a point is farther than D", 0},
    {0},
};

static const arguments defaults = {0};

static void report_distance(facts *f, const brio_distance *d) {
    const struct {
        const char *name;
        double distance;
    } rows[] = {{"mean", d->mean}, {"rms", d->rms}, {"p95", d->p95}, {"hausdorff", d->hausdorff}};
    for (int i = 0; i < 4; i++) cli_fact_real(f, rows[i].name, rows[i].distance);
    cli_fact_real(f, "normal_consistency", d->normal_consistency);
    cli_fact_real(f, "diagonal", d->diagonal);
    cli_fact_open(f, "percent_of_diagonal", FACT_OBJECT);
    for (int i = 0; i < 4; i++) cli_fact_real(f, rows[i].name, 100 * rows[i].distance / d->diagonal);
    cli_fact_close(f);
}

/* Writes the first of two surfaces, with the distances of its vertices from the second. */
static brio_status write_distances(run *r, brio_mesh *a, const brio_mesh *b) {
    brio_status status = BRIO_OK;
    if (!cli_wants_mesh(r)) return BRIO_OK;
    double *distance = malloc((a->num_vertices + 1) * sizeof *distance);
    if (!distance) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu distances", a->num_vertices);
    TRY(brio_mesh_signed_distances(r->ctx, b, a->vertices, a->num_vertices, distance));
    cli_lap(r, "compare");
    TRY(add_property(r, a, distance));
    status = cli_write(r, a);
done:
    free(distance);
    return status;
}

/* Compares two surfaces by points on both. */
static brio_status compare_surfaces(run *r, brio_mesh *a, const brio_mesh *b) {
    const arguments *chosen = r->arguments;
    brio_distance d = {0};
    brio_status status = BRIO_OK;
    status = brio_mesh_distance(r->ctx, a, b, (size_t)chosen->samples, r->common.seed, &d);
    if (status == BRIO_ERR_ARGUMENT) /* faces without area, or of two corners */
        FAIL(r, BRIO_ERR_NO_ANSWER, "%s, %s: %s", r->operands[0], r->operands[1], brio_message(r->ctx));
    TRY(status);
    cli_lap(r, "compare");
    report_distance(&r->facts, &d);
    TRY(write_distances(r, a, b));
    if (chosen->within > 0) {
        bool within = d.hausdorff <= cli_up_to(chosen->within, fmax(cli_rounding(a), cli_rounding(b)));
        cli_fact_bool(&r->facts, "within", within);
        if (!within) FAIL(r, BRIO_ERR_CHECK, "the surfaces are %g apart, more than %g", d.hausdorff, chosen->within);
    }
done:
    return status;
}

static brio_status compare(run *r) {
    const arguments *chosen = r->arguments;
    brio_mesh *mesh[2] = {NULL, NULL};
    brio_status status = BRIO_OK;
    if (!strcmp(r->operands[0], "-") && !strcmp(r->operands[1], "-"))
        FAIL(r, BRIO_ERR_ARGUMENT, "both inputs want standard input");
    if (r->common.output) TRY(cli_require_output(r, false));
    for (int i = 0; i < 2; i++) TRY(cli_read(r, r->operands[i], &mesh[i]));
    if (mesh[0]->num_faces && mesh[1]->num_faces) {
        status = compare_surfaces(r, mesh[0], mesh[1]);
        goto done;
    }
    int cloud = mesh[0]->num_faces ? 1 : 0;
    if (!mesh[1 - cloud]->num_faces) {
        cli_hint(r, HINT_SURFACE);
        FAIL(r, BRIO_ERR_FORMAT, "%s, %s: expected a surface at least once, found no faces", r->operands[0],
             r->operands[1]);
    }
    if (chosen->samples)
        FAIL(r, BRIO_ERR_ARGUMENT, "--samples is for two surfaces, and %s has points alone", r->operands[cloud]);
    if (!mesh[cloud]->num_vertices) FAIL(r, BRIO_ERR_NO_ANSWER, "%s: no points", r->operands[cloud]);
    status = compare_cloud(r, mesh[cloud], mesh[1 - cloud], chosen->within);
    if (status == BRIO_ERR_ARGUMENT)
        status = cli_fail(r, BRIO_ERR_NO_ANSWER, "%s: %s", r->operands[1 - cloud], brio_message(r->ctx));
done:
    brio_mesh_free(mesh[0]);
    brio_mesh_free(mesh[1]);
    return status;
}

const command cli_compare = {
    .name = "compare",
    .operands = "A B",
    .summary = "distances between two surfaces, or of points from a surface, with their sides",
    .description =
        "Points inside a closed surface, or behind the faces of another one, have negative distances. With "
        "-o the points, or of two surfaces the first, are written with the property distance, which --view shows as "
        "colours.",
    .examples =
        "brio compare surface.ply truth.ply\nhow far they are apart\n"
        "brio compare scan.ply part.stl --within 0.1 -o checked.ply\nis every point within a tenth of the part?\n",
    .has_output = true,
    .holds = CLI_POINTS,
    .output_optional = true,
    .group = GROUP_FILES,
    .min_operands = 2,
    .max_operands = 2,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = compare,
};
