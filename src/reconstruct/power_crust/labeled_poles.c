/* From samples to labeled polar balls.
 *
 *   1. The Delaunay triangulation of the samples in canonical order, smoothed where they are noisy, and of eight
 *      bounding points.
 *   2. The poles of each sample: the farthest vertices of its Voronoi cell on either side of the surface.
 *   3. The regular triangulation of the polar balls, which is the dual of their power diagram.
 *   4. A label, inner or outer, for each pole.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.7, steps 1 to 4.
 * Differs from the paper: the bounding points have no poles and are not in the power diagram. Poles on the hull of the
 *                         regular triangulation are outer; otherwise the crust of small or clustered inputs would not
 *                         close. */
#include "reconstruct/power_crust/labeled_poles.h"
#include "base/memory.h"
#include "base/scale.h"
#include "dual/spacing.h"
#include "order/canonical_points.h"
#include "reconstruct/labels/label_solid.h"
#include "reconstruct/noise/sample_noise.h"
#include <math.h>
#include <string.h>

/* The sampling density that `sharp` stands for. Chosen. */
static const double SHARP_DENSITY = 0.5;
static const double TRIANGULATION_SHARE = 0.75; /* of the bar of the poles */

brio_status brio_pole_request_of(brio_context *ctx, const brio_pole_options *o, brio_noise noise, uint64_t seed,
                                 brio_pole_request *request) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, (unsigned)o->labeling < BRIO_LABELING_END, BRIO_ERR_ARGUMENT, "no such labeling: %d",
                 (int)o->labeling);
    BRIO_REQUIRE(ctx, o->sampling_density >= 0 && o->sampling_density < 1, BRIO_ERR_ARGUMENT,
                 "sampling density %g, expected 0 or a number between 0 and 1", o->sampling_density);
    BRIO_REQUIRE(ctx, (unsigned)noise < BRIO_NOISE_END, BRIO_ERR_ARGUMENT, "no such way with noise: %d", (int)noise);
    for (size_t i = 0; i < sizeof o->reserved / sizeof *o->reserved; i++)
        BRIO_REQUIRE(ctx, !o->reserved[i], BRIO_ERR_ARGUMENT, "brio_pole_options.reserved is not 0");
    *request = (brio_pole_request){.seed = seed,
                                   .filter = {.sampling_density = o->sampling_density, .both = o->sharp},
                                   .labeling = o->labeling,
                                   .experiment = BRIO_PART(ctx, labels),
                                   .noise = noise == BRIO_NOISE_AUTO && o->solid ? BRIO_NOISE_KEEP : noise,
                                   .solid = o->solid};
    if (o->sharp && o->sampling_density == 0) request->filter.sampling_density = SHARP_DENSITY;
done:
    return status;
}

/* --- 1: samples and bounding points --- */

/* Copies the samples in canonical order, scaled by 2^-exponent. From here on nothing depends on the caller's order. */
static brio_status take_samples(brio_labeled_poles *l, const double *points) {
    brio_status status = BRIO_OK;
    size_t n = l->num_samples;
    BRIO_TRY(BRIO_ALLOC(l->ctx, l->points, 3 * (n + BRIO_BOUNDING_POINTS)));
    BRIO_TRY(brio_canonical_points(l->ctx, points, n, &l->order));
    brio_copy_points(points, l->order, n, l->points);
    BRIO_TRY(brio_scale(l->ctx, l->points, 3 * n, -l->exponent, l->points));
done:
    return status;
}

/* Computes the bounding points: the corners of the samples' box, scaled five times about its centre and moved out by
 * `margin`. A side shorter than a fifth of the longest side counts as a fifth, so that flat inputs are bounded on both
 * sides. */
static void bounding_corners(const double *points, size_t n, double margin, double *corner) {
    double low[3], high[3], centre[3], half[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        low[k] = high[k] = points[k];
        for (size_t i = 1; i < n; i++) {
            low[k] = fmin(low[k], points[3 * i + (size_t)k]);
            high[k] = fmax(high[k], points[3 * i + (size_t)k]);
        }
        longest = fmax(longest, high[k] - low[k]);
    }
    if (longest == 0) longest = 1; /* all samples are at one position */
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5 * (low[k] + high[k]);
        half[k] = 2.5 * fmax(high[k] - low[k], longest / 5) + margin;
    }
    for (int i = 0; i < BRIO_BOUNDING_POINTS; i++)
        for (int k = 0; k < 3; k++) corner[3 * i + k] = centre[k] + (i >> k & 1 ? half[k] : -half[k]);
}

/* Smooths the samples if the request says so, or if it says AUTO and there is noise. */
static brio_status reduce_noise(brio_labeled_poles *l, const brio_pole_request *request) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    bool smooth = request->noise == BRIO_NOISE_SMOOTH;
    if (request->noise == BRIO_NOISE_AUTO) {
        BRIO_TRY(brio_noise_level(l->ctx, l->points, l->num_samples, &l->found.noise));
        smooth = l->found.noise > 0;
    }
    if (smooth) BRIO_TRY(brio_smooth_samples(l->ctx, l->points, l->num_samples));
    l->found.smoothed = smooth;
    l->found.noise_seconds = brio_seconds() - start;
done:
    return status;
}

static brio_status prepare(brio_labeled_poles *l, const double *points, const brio_pole_request *request) {
    brio_status status = BRIO_OK;
    size_t n = l->num_samples;
    BRIO_REQUIRE(l->ctx, n > 0, BRIO_ERR_NO_ANSWER, "no points, no surface");
    BRIO_TRY(brio_refuse_points(l->ctx, points, n)); /* before anything is read by their number */
    l->exponent = brio_exponent(fmax(request->margin, brio_greatest(points, 3 * n)));
    BRIO_TRY(take_samples(l, points));
    if (!request->representative) { /* nothing needs the caller's order any more */
        brio_release(l->ctx, l->order);
        l->order = NULL;
    }
    BRIO_TRY(reduce_noise(l, request));
    bounding_corners(l->points, n, ldexp(request->margin, -l->exponent), l->points + 3 * n);
done:
    return status;
}

/* --- 2: poles --- */

static brio_status measure_spacing(brio_labeled_poles *l, const brio_triangulation *delaunay) {
    brio_status status = BRIO_OK;
    double *of_sample = NULL;
    BRIO_TRY(BRIO_ALLOC(l->ctx, of_sample, l->num_samples));
    BRIO_TRY(BRIO_ALLOC(l->ctx, l->spacing, l->poles.count));
    BRIO_TRY(brio_sample_spacing(l->ctx, delaunay, l->points, l->num_samples, of_sample, NULL));
    brio_pole_spacing(&l->poles, l->num_samples, of_sample, l->spacing);
done:
    brio_release(l->ctx, of_sample);
    return status;
}

static brio_status keep_representatives(brio_labeled_poles *l, const brio_triangulation *delaunay) {
    brio_status status = BRIO_ALLOC(l->ctx, l->representative, l->num_samples);
    if (status != BRIO_OK) return status;
    memcpy(l->representative, brio_triangulation_representatives(delaunay), l->num_samples * sizeof *l->representative);
    return BRIO_OK;
}

static brio_status find_poles(brio_labeled_poles *l, const brio_pole_request *request) {
    brio_status status = BRIO_OK;
    brio_triangulation *delaunay = NULL;
    brio_pole_filter filter = request->filter;
    const brio_bar bar = brio_progress_bar(l->ctx);
    double start = brio_seconds();
    if (!request->solid && !request->experiment && request->labeling == BRIO_LABELING_GLOBAL)
        filter.shapes = BRIO_TRUSTED_SHAPE;
    brio_progress_part(l->ctx, bar, 0, TRIANGULATION_SHARE);
    BRIO_TRY(
        brio_delaunay(l->ctx, l->points, NULL, l->num_samples + BRIO_BOUNDING_POINTS, &l->triangulation, &delaunay));
    l->found.samples = brio_triangulation_stats(delaunay)->vertices - BRIO_BOUNDING_POINTS;
    BRIO_REQUIRE(l->ctx, l->found.samples >= 4, BRIO_ERR_NO_ANSWER, "%zu distinct points span no solid",
                 l->found.samples);
    l->found.delaunay_seconds = brio_seconds() - start;
    start = brio_seconds();
    brio_progress_part(l->ctx, bar, TRIANGULATION_SHARE, 1);
    BRIO_TRY(brio_poles_find(l->ctx, delaunay, l->points, l->num_samples, &filter, &l->poles));
    if (request->spacing) BRIO_TRY(measure_spacing(l, delaunay));
    if (request->representative) BRIO_TRY(keep_representatives(l, delaunay));
    l->stats.poles = l->poles.count;
    l->stats.bad_cells = l->poles.bad_cells;
    l->found.poles_seconds = brio_seconds() - start;
done:
    brio_progress_part(l->ctx, bar, 0, 1);
    brio_triangulation_free(delaunay);
    return status;
}

/* --- 3 and 4: power diagram and labels --- */

static brio_status triangulate_poles(brio_labeled_poles *l) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    BRIO_TRY(brio_delaunay(l->ctx, l->poles.centre, l->poles.square, l->poles.count, &l->triangulation, &l->power));
    l->stats.power_seconds += brio_seconds() - start;
    BRIO_REQUIRE(l->ctx, brio_triangulation_stats(l->power)->dimension == 3,
                 BRIO_BECAUSE(l->ctx, NO_INSIDE, BRIO_ERR_NO_ANSWER), "no inside found: the poles span no solid");
    l->diagram = brio_power_diagram_of(&l->poles, l->points, l->num_samples, l->power);
done:
    return status;
}

static void count_labels(brio_labeled_poles *l) {
    const brio_delaunay_stats *s = brio_triangulation_stats(l->power);
    l->stats.hidden_poles = s->hidden + s->duplicates;
    l->stats.inner = 0;
    for (size_t p = 0; p < l->poles.count; p++) l->stats.inner += l->label[p] == BRIO_LABEL_INNER;
    l->stats.outer = l->poles.count - l->stats.inner;
}

static brio_status label_along_graph(brio_labeled_poles *l, const brio_pole_request *request) {
    brio_status status = BRIO_OK;
    brio_labeling_stats s = {0};
    const struct brio_label_part *part = request->experiment;
    bool global = !part && request->labeling == BRIO_LABELING_GLOBAL;
    brio_pole_evidence evidence = {part ? part->least_weight : 0, global};
    BRIO_TRY(brio_pole_graph_new(l->ctx, &l->diagram, evidence, &l->graph));
    if (part)
        BRIO_TRY(part->label(part->user, &l->graph, l->label, &s));
    else
        BRIO_TRY(global ? brio_label_global(&l->graph, l->label, &s) : brio_label_greedy(&l->graph, l->label, &s));
    l->stats.confused = s.confused;
    l->stats.undecided = s.undecided;
    l->stats.toggled = s.toggled;
    l->stats.energy_greedy = s.energy_greedy;
    brio_signed_graph signs = brio_pole_signs(&l->graph);
    BRIO_TRY(brio_label_energy(&signs, l->label, &l->stats.energy));
done:
    return status;
}

static brio_status label_poles(brio_labeled_poles *l, const brio_pole_request *request) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    BRIO_TRY(BRIO_ALLOC_ZERO(l->ctx, l->label, l->poles.count));
    if (request->solid) {
        BRIO_TRY(brio_label_by_solid(l->ctx, &l->poles, l->exponent, request->solid, l->label));
    } else {
        BRIO_TRY(label_along_graph(l, request));
    }
    count_labels(l);
    l->stats.label_seconds = brio_seconds() - start;
done:
    return status;
}

brio_status brio_labeled_poles_find(brio_context *ctx, const double *points, size_t num_points,
                                    const brio_pole_request *request, brio_labeled_poles *l) {
    brio_status status = BRIO_OK;
    const brio_bar bar = brio_progress_bar(ctx);
    *l = (brio_labeled_poles){.ctx = ctx, .num_samples = num_points, .triangulation = {.seed = request->seed}};
    l->graph.ctx = ctx;
    brio_progress_part(ctx, bar, 0, 0.05);
    BRIO_TRY(prepare(l, points, request));
    brio_progress_part(ctx, bar, 0.05, 0.5);
    BRIO_TRY(find_poles(l, request));
    brio_progress_part(ctx, bar, 0.5, 0.89);
    BRIO_TRY(triangulate_poles(l));
    brio_progress_part(ctx, bar, 0.89, 1);
    BRIO_TRY(label_poles(l, request));
done:
    brio_progress_part(ctx, bar, 0, 1);
    return status;
}

/* --- fewer poles --- */

static void close_up(brio_labeled_poles *l, const uint8_t *keep) {
    brio_poles *poles = &l->poles;
    size_t n = 0;
    for (size_t p = 0; p < poles->count; p++) {
        if (!keep[p]) continue;
        for (size_t k = 0; k < 3; k++) poles->centre[3 * n + k] = poles->centre[3 * p + k];
        for (size_t i = 0; i < 4; i++) poles->touched[4 * n + i] = poles->touched[4 * p + i];
        poles->square[n] = poles->square[p];
        poles->bounding[n] = poles->bounding[p];
        l->label[n] = l->label[p];
        if (l->spacing) l->spacing[n] = l->spacing[p];
        n++;
    }
    poles->count = n;
}

brio_status brio_labeled_poles_keep(brio_labeled_poles *l, const uint8_t *keep) {
    brio_status status = BRIO_OK;
    close_up(l, keep);
    for (size_t i = 0; i < 2 * l->num_samples; i++) l->poles.of_sample[i] = BRIO_NO_POLE;
    brio_pole_graph_free(&l->graph);
    l->graph = (brio_pole_graph){.ctx = l->ctx};
    brio_triangulation_free(l->power);
    l->power = NULL;
    BRIO_TRY(triangulate_poles(l));
    count_labels(l);
done:
    return status;
}

void brio_labeled_poles_close_hull(brio_labeled_poles *l) {
    const brio_tetrahedra *power = &l->diagram.power;
    for (size_t tet = l->diagram.num_finite; tet < power->count; tet++)
        for (int i = 0; i < 3; i++) l->label[power->tet[tet].vertex[i]] = BRIO_LABEL_OUTER;
    count_labels(l);
}

void brio_labeled_poles_free(brio_labeled_poles *l) {
    brio_pole_graph_free(&l->graph);
    brio_triangulation_free(l->power);
    brio_release(l->ctx, l->points);
    brio_release(l->ctx, l->order);
    brio_release(l->ctx, l->spacing);
    brio_release(l->ctx, l->representative);
    brio_release(l->ctx, l->label);
    brio_poles_free(l->ctx, &l->poles);
}
