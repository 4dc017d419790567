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
#include "reconstruct/crust_faces.h"
#include "reconstruct/labelling.h"
#include <math.h>
#include <string.h>

enum { BOUNDING_POINTS = 8 };

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

static brio_status find_poles(crust *c) {
    brio_status status = BRIO_OK;
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
    BRIO_TRY(brio_poles_find(c->ctx, delaunay, c->points, c->num_samples, &c->poles));
    c->stats.poles = c->poles.count;
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

static brio_status label_poles(crust *c, const brio_triangulation *power, brio_pole_graph *graph) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    stage(c, 0.8, 0.9);
    BRIO_TRY(brio_pole_graph_new(c->ctx, &c->poles, c->points, c->num_samples, power, graph));
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, c->label, c->poles.count));
    BRIO_TRY(brio_label_greedy(graph, c->label, &c->stats.confused));
    count_labels(c, power);
    c->stats.label_seconds = brio_seconds() - start;
done:
    return status;
}

/* --- 5: faces --- */

static brio_status make_crust(crust *c, const brio_pole_graph *graph, bool triangulate, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    stage(c, 0.9, 1);
    BRIO_TRY(brio_crust_faces(graph, c->label, triangulate, mesh));
    for (size_t i = 0; i < 3 * mesh->num_vertices; i++) mesh->vertices[i] = ldexp(mesh->vertices[i], c->exponent);
    c->stats.crust_seconds = brio_seconds() - start;
done:
    return status;
}

static brio_status reconstruct(crust *c, const double *points, const brio_surface_options *options, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    brio_triangulation *power = NULL;
    brio_pole_graph graph = {.ctx = c->ctx};
    BRIO_TRY(prepare(c, points));
    BRIO_TRY(find_poles(c));
    double start = brio_seconds();
    stage(c, 0.45, 0.8);
    BRIO_TRY(brio_delaunay(c->ctx, c->poles.centre, c->poles.square, c->poles.count, &c->triangulation, &power));
    c->stats.power_seconds = brio_seconds() - start;
    BRIO_REQUIRE(c->ctx, brio_triangulation_stats(power)->dimension == 3, BRIO_ERR_NO_ANSWER,
                 "no inside found: the poles span no solid");
    BRIO_TRY(label_poles(c, power, &graph));
    BRIO_TRY(make_crust(c, &graph, options->triangulate, mesh));
done:
    brio_pole_graph_free(&graph);
    brio_triangulation_free(power);
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
    brio_release(ctx, c.label);
    brio_poles_free(ctx, &c.poles);
    return status;
}
