/* The power crust.
 *
 *   1. Delaunay triangulation of the samples and eight bounding points.
 *   2. The poles of each sample: the farthest vertices of its Voronoi cell on either side of the surface.
 *   3. The power diagram of the polar balls, as its dual, the regular triangulation of the poles.
 *   4. A label, inner or outer, for each pole.
 *   5. The faces of the power diagram between inner and outer cells.
 *
 * Based on: Amenta, Choi, Kolluri. The power crust, unions of balls, and the medial axis transform. CGTA 2001.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.7.
 * Differs from the paper: the bounding points are no poles and take no part in the power diagram; poles on the hull of
 * the power diagram's dual are outer, without which the crust of small or clustered inputs would not close. */
#include "base/memory.h"
#include "dual/spacing.h"
#include "reconstruct/crust_faces.h"
#include "reconstruct/labelling.h"
#include "reconstruct/sample_normals.h"
#include "surface/simplify.h"
#include <math.h>
#include <string.h>

enum { BOUNDING_POINTS = 8 };
static const double SHARP_DENSITY = 0.5;
static const double LONGEST_COLLAPSE = 1.5, COLLAPSE_TOLERANCE = 0.1; /* in spacings */

brio_surface_options brio_surface_options_default(void) {
    return (brio_surface_options){.seed = 1};
}

typedef struct {
    brio_context *ctx;
    size_t num_samples;
    double *points; /* samples and bounding points, scaled by 2^-exponent to at most 1 */
    int exponent;
    brio_options triangulation;
    brio_poles poles;
    double *spacing;          /* of the poles, where it is needed */
    uint32_t *representative; /* of the samples, where normals are asked for */
    uint8_t *label;
    brio_power_crust_stats stats;
} crust;

/* --- 1: samples and bounding points --- */

static brio_status check_finite(brio_context *ctx, const double *points, size_t n) {
    size_t first = n, bad = 0;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(points[3 * i]) && isfinite(points[3 * i + 1]) && isfinite(points[3 * i + 2])) continue;
        if (bad++ == 0) first = i;
    }
    if (bad == 0) return BRIO_OK;
    size_t k = 0;
    while (isfinite(points[3 * first + k])) k++;
    return brio_fail(ctx, BRIO_ERR_NOT_FINITE, "point %zu: %c is %s (%zu such points in all)", first, "xyz"[k],
                     isnan(points[3 * first + k]) ? "NaN" : "infinite", bad);
}

/* Eight corners of the box scaled five times about its centre; a side shorter than a fifth of the longest is taken as
 * that, so that flat inputs are bounded on both sides. */
static void bounding_corners(const double *points, size_t n, double *corner) {
    double low[3], high[3], centre[3], half[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        low[k] = high[k] = points[k];
        for (size_t i = 1; i < n; i++) {
            low[k] = fmin(low[k], points[3 * i + (size_t)k]);
            high[k] = fmax(high[k], points[3 * i + (size_t)k]);
        }
        longest = fmax(longest, high[k] - low[k]);
    }
    if (longest == 0) longest = 1; /* one position */
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5 * (low[k] + high[k]);
        half[k] = 2.5 * fmax(high[k] - low[k], longest / 5);
    }
    for (int i = 0; i < BOUNDING_POINTS; i++)
        for (int k = 0; k < 3; k++) corner[3 * i + k] = centre[k] + (i >> k & 1 ? half[k] : -half[k]);
}

static brio_status prepare(crust *c, const double *points) {
    brio_status status = BRIO_OK;
    size_t n = c->num_samples;
    double most = 0;
    BRIO_REQUIRE(c->ctx, n > 0, BRIO_ERR_NO_ANSWER, "no points, no surface");
    BRIO_TRY(check_finite(c->ctx, points, n));
    BRIO_TRY(BRIO_ALLOC(c->ctx, c->points, 3 * (n + BOUNDING_POINTS)));
    for (size_t i = 0; i < 3 * n; i++) most = fmax(most, fabs(points[i]));
    frexp(most, &c->exponent);
    for (size_t i = 0; i < 3 * n; i++) c->points[i] = ldexp(points[i], -c->exponent);
    bounding_corners(c->points, n, c->points + 3 * n);
done:
    return status;
}

/* Each stage owns a part of the progress bar, in proportion to its usual time. */
static void stage(crust *c, double from, double to) {
    c->ctx->progress_from = from;
    c->ctx->progress_to = to;
}

/* --- 2: poles --- */

static brio_status measure_spacing(crust *c, const brio_triangulation *delaunay) {
    brio_status status = BRIO_OK;
    double *of_sample = NULL;
    BRIO_TRY(BRIO_ALLOC(c->ctx, of_sample, c->num_samples));
    BRIO_TRY(BRIO_ALLOC(c->ctx, c->spacing, c->poles.count));
    BRIO_TRY(brio_sample_spacing(c->ctx, delaunay, c->points, c->num_samples, of_sample));
    brio_pole_spacing(&c->poles, c->num_samples, of_sample, c->spacing);
done:
    brio_release(c->ctx, of_sample);
    return status;
}

static brio_status keep_representatives(crust *c, const brio_triangulation *delaunay) {
    brio_status status = BRIO_ALLOC(c->ctx, c->representative, c->num_samples);
    if (status != BRIO_OK) return status;
    memcpy(c->representative, brio_triangulation_representatives(delaunay), c->num_samples * sizeof *c->representative);
    return BRIO_OK;
}

static brio_status find_poles(crust *c, const brio_surface_options *o) {
    brio_status status = BRIO_OK;
    brio_pole_filter filter = {o->sampling_density, o->sharp};
    if (filter.both && filter.sampling_density == 0) filter.sampling_density = SHARP_DENSITY;
    brio_triangulation *delaunay = NULL;
    double start = brio_seconds();
    stage(c, 0, 0.35);
    BRIO_TRY(brio_delaunay(c->ctx, c->points, NULL, c->num_samples + BOUNDING_POINTS, &c->triangulation, &delaunay));
    c->stats.samples = brio_triangulation_stats(delaunay)->vertices - BOUNDING_POINTS;
    BRIO_REQUIRE(c->ctx, c->stats.samples >= 4, BRIO_ERR_NO_ANSWER, "%zu distinct points span no solid",
                 c->stats.samples);
    c->stats.delaunay_seconds = brio_seconds() - start;
    start = brio_seconds();
    stage(c, 0.35, 0.45);
    BRIO_TRY(brio_poles_find(c->ctx, delaunay, c->points, c->num_samples, &filter, &c->poles));
    if (o->open > 0 || o->simplify) BRIO_TRY(measure_spacing(c, delaunay));
    if (o->normals) BRIO_TRY(keep_representatives(c, delaunay));
    c->stats.poles = c->poles.count;
    c->stats.bad_cells = c->poles.bad_cells;
    c->stats.poles_seconds = brio_seconds() - start;
done:
    brio_triangulation_free(delaunay);
    return status;
}

/* --- 3 and 4: power diagram and labels --- */

static void count_labels(crust *c, const brio_triangulation *power) {
    const brio_stats *s = brio_triangulation_stats(power);
    c->stats.hidden_poles = s->hidden + s->duplicates;
    for (size_t p = 0; p < c->poles.count; p++) c->stats.inner += c->label[p] == BRIO_LABEL_INNER;
    c->stats.outer = c->poles.count - c->stats.inner;
}

typedef brio_status (*label_fn)(const brio_pole_graph *g, uint8_t *label, brio_labelling_stats *stats);

static const label_fn labellings[BRIO_LABELING_END] = {brio_label_global, brio_label_greedy, brio_label_naive,
                                                       brio_label_theoretical};

static brio_status label_poles(crust *c, const brio_triangulation *power, brio_labeling labeling,
                               brio_pole_graph *graph) {
    brio_status status = BRIO_OK;
    brio_labelling_stats s = {0};
    double start = brio_seconds(), least = labeling == BRIO_LABELING_THEORETICAL ? BRIO_THEORETICAL_WEIGHT : 0;
    stage(c, 0.8, 0.9);
    BRIO_TRY(brio_pole_graph_new(c->ctx, &c->poles, c->points, c->num_samples, power, least, graph));
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, c->label, c->poles.count));
    BRIO_TRY(labellings[labeling](graph, c->label, &s));
    c->stats.confused = s.confused;
    c->stats.unreached = s.unreached;
    c->stats.open = s.open;
    c->stats.toggled = s.toggled;
    c->stats.energy_greedy = s.energy_greedy;
    c->stats.energy = brio_label_energy(graph, c->label);
    count_labels(c, power);
    c->stats.label_seconds = brio_seconds() - start;
done:
    return status;
}

/* --- 5: faces --- */

/* A quarter of the faces, where that can be had. */
static brio_status simplify(crust *c, size_t polygons, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    brio_simplify_options o = {.target_faces = polygons / 4,
                               .spacing = brio_mesh_property(mesh, "spacing")->data,
                               .longest = LONGEST_COLLAPSE,
                               .tolerance = COLLAPSE_TOLERANCE};
    BRIO_TRY(brio_mesh_simplify(c->ctx, mesh, &o));
    c->stats.simplify_seconds = brio_seconds() - start;
done:
    return status;
}

static void drop_properties(brio_mesh *mesh) {
    while (mesh->num_properties) brio_release(mesh->context, mesh->properties[--mesh->num_properties].data);
}

static brio_status make_crust(crust *c, const brio_pole_graph *graph, const brio_surface_options *o, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    brio_crust_options options = {o->triangulate || o->simplify, o->open, c->spacing};
    brio_crust_counts counts;
    stage(c, 0.9, o->simplify ? 0.93 : 1);
    BRIO_TRY(brio_crust_faces(graph, c->label, &options, mesh, &counts));
    c->stats.left_out = counts.left_out;
    c->stats.crust_seconds = brio_seconds() - start;
    if (o->normals) BRIO_TRY(brio_sample_normals(graph, c->label, c->representative, mesh, o->normals));
    stage(c, 0.93, 1);
    if (o->simplify) BRIO_TRY(simplify(c, counts.faces, mesh));
    drop_properties(mesh);
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) mesh->vertices[i] = ldexp(mesh->vertices[i], c->exponent);
done:
    return status;
}

static brio_status reconstruct(crust *c, const double *points, const brio_surface_options *options, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    brio_triangulation *power = NULL;
    brio_pole_graph graph = {.ctx = c->ctx};
    BRIO_TRY(prepare(c, points));
    BRIO_TRY(find_poles(c, options));
    double start = brio_seconds();
    stage(c, 0.45, 0.8);
    BRIO_TRY(brio_delaunay(c->ctx, c->poles.centre, c->poles.square, c->poles.count, &c->triangulation, &power));
    c->stats.power_seconds = brio_seconds() - start;
    BRIO_REQUIRE(c->ctx, brio_triangulation_stats(power)->dimension == 3, BRIO_ERR_NO_ANSWER,
                 "no inside found: the poles span no solid");
    BRIO_TRY(label_poles(c, power, options->labeling, &graph));
    BRIO_TRY(make_crust(c, &graph, options, mesh));
done:
    brio_pole_graph_free(&graph);
    brio_triangulation_free(power);
    return status;
}

static brio_status check_options(brio_context *ctx, const brio_surface_options *o) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, (unsigned)o->labeling < BRIO_LABELING_END, BRIO_ERR_ARGUMENT, "no such labeling: %d",
                 (int)o->labeling);
    BRIO_REQUIRE(ctx, o->sampling_density >= 0 && o->sampling_density < 1, BRIO_ERR_ARGUMENT,
                 "sampling density %g, expected 0 or a number between 0 and 1", o->sampling_density);
    BRIO_REQUIRE(ctx, o->open >= 0, BRIO_ERR_ARGUMENT, "open: %g spacings, expected 0 or a positive number", o->open);
done:
    return status;
}

brio_status brio_power_crust(brio_context *ctx, const double *points, size_t num_points,
                             const brio_surface_options *options, brio_mesh **out, brio_power_crust_stats *stats) {
    brio_status status = BRIO_OK;
    brio_surface_options standard = brio_surface_options_default();
    brio_mesh *mesh = NULL;
    crust c = {.ctx = ctx, .num_samples = num_points, .triangulation = brio_options_default()};
    *out = NULL;
    if (!options) options = &standard;
    BRIO_TRY(check_options(ctx, options));
    c.triangulation.seed = options->seed;
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(reconstruct(&c, points, options, mesh));
    *out = mesh;
    mesh = NULL;
done:
    if (stats) *stats = c.stats;
    stage(&c, 0, 1);
    brio_mesh_free(mesh);
    brio_release(ctx, c.points);
    brio_release(ctx, c.spacing);
    brio_release(ctx, c.representative);
    brio_release(ctx, c.label);
    brio_poles_free(ctx, &c.poles);
    return status;
}
