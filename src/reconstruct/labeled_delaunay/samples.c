/* The samples of the labeled Delaunay triangulation: the caller's points in canonical order, scaled, without strays,
 * and smoothed first where they are noisier than the log-odds of the votes were measured for. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/scale.h"
#include "dual/spacing.h"
#include "base/sort.h"
#include "order/canonical_points.h"
#include "reconstruct/labeled_delaunay/reconstruction.h"
#include "reconstruct/labeled_delaunay/stray_samples.h"
#include "reconstruct/noise/sample_noise.h"
#include "triangulation/triangulation.h"
#include <math.h>
#include <string.h>

/* As brio_least_noise finds it. Surfaces of samples with more than LEAST_NOISE are smoothed: between what generated
 * solids show without noise and with a noise of 0.3 spacings in each coordinate. Samples with more than MOST_NOISE are
 * smoothed before: above all that these showed with that noise, for which the log-odds were measured. */
static const double LEAST_NOISE = 0.085, MOST_NOISE = 0.13;

brio_status brio_take_samples(brio_reconstruction *r, const double *points) {
    brio_status status = BRIO_OK;
    size_t n = r->num_points;
    r->exponent = brio_exponent(brio_greatest(points, 3 * n));
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->points, 3 * n));
    BRIO_TRY(brio_canonical_points(r->ctx, points, n, &r->order));
    brio_copy_points(points, r->order, n, r->points);
    BRIO_TRY(brio_scale(r->ctx, r->points, 3 * n, -r->exponent, r->points));
    r->evidence.order = r->order;
    r->evidence.exponent = r->exponent;
done:
    return status;
}

brio_status brio_triangulate_samples(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_triangulate(r->ctx, r->points, r->num_points, r->options->seed, &r->delaunay));
    const brio_delaunay_stats *s = brio_triangulation_stats(r->delaunay);
    r->stats.samples = s->vertices;
    BRIO_REQUIRE(r->ctx, s->dimension == 3, BRIO_ERR_NO_ANSWER, "%zu distinct points of dimension %d bound no solid",
                 s->vertices, s->dimension);
    brio_lap(r, &r->stats.delaunay_seconds);
done:
    return status;
}

brio_status brio_measure_spacing(brio_reconstruction *r, float *second) {
    if (!r->spacing) {
        brio_status status = BRIO_ALLOC(r->ctx, r->spacing, r->num_points);
        if (status != BRIO_OK) return status;
    }
    return brio_sample_spacing(r->ctx, r->delaunay, r->points, r->num_points, r->spacing, second);
}

brio_status brio_drop_strays(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    uint8_t *stray = NULL;
    float *second = NULL;
    size_t kept = 0;
    BRIO_TRY(BRIO_ALLOC(r->ctx, second, r->num_points));
    BRIO_TRY(brio_measure_spacing(r, second));
    BRIO_TRY(BRIO_ALLOC(r->ctx, stray, r->num_points));
    BRIO_TRY(brio_find_strays(r->ctx, r->delaunay, r->points, r->num_points, r->spacing, second, stray));
    for (size_t p = 0; p < r->num_points; p++) r->stats.strays += stray[p];
    if (!r->stats.strays) goto done;
    for (size_t p = 0; p < r->num_points; p++) {
        if (stray[p]) continue;
        for (size_t k = 0; k < 3; k++) r->points[3 * kept + k] = r->points[3 * p + k];
        r->order[kept++] = r->order[p];
    }
    r->num_points = kept;
    brio_triangulation_free(r->delaunay);
    r->delaunay = NULL;
    BRIO_TRY(brio_triangulate_samples(r));
    BRIO_TRY(brio_measure_spacing(r, NULL));
done:
    brio_release(r->ctx, stray);
    brio_release(r->ctx, second);
    return status;
}

/* The samples that one scanner saw. */
typedef struct {
    const brio_reconstruction *r;
    uint64_t *scanner; /* of each sample: hash of the place, 0 if it is not known */
    uint32_t *sample;  /* sorted by that */
    double *points;    /* of one scanner */
} scanners;

static bool is_finite(const double *p) {
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

static brio_status sort_by_scanner(scanners *s) {
    brio_status status = BRIO_OK;
    const brio_reconstruction *r = s->r;
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, s->scanner, r->num_points));
    BRIO_TRY(BRIO_ALLOC(r->ctx, s->sample, r->num_points));
    for (size_t p = 0; p < r->num_points; p++) {
        double place[3];
        s->sample[p] = (uint32_t)p;
        if (!brio_scanner_place(&r->evidence, p, place) || !is_finite(place)) continue;
        for (size_t k = 0; k < 3; k++) s->scanner[p] = brio_hash(s->scanner[p], brio_double_key(place[k]));
    }
    BRIO_TRY(brio_radix_sort(r->ctx, s->scanner, s->sample, r->num_points, 64));
done:
    return status;
}

/* Undoes the rounding of the samples that one scanner saw, if their depths are rounded.   count  more than 0. */
static brio_status unround_some(brio_reconstruction *r, const uint32_t *sample, size_t count, double *points,
                                brio_rounding *all) {
    brio_status status = BRIO_OK;
    brio_rounding one;
    double place[3];
    bool is_known = brio_scanner_place(&r->evidence, sample[0], place) && is_finite(place);
    for (size_t i = 0; i < count; i++) memcpy(points + 3 * i, r->points + 3 * (size_t)sample[i], 3 * sizeof *points);
    BRIO_TRY(brio_unround_samples(r->ctx, points, count, is_known ? place : NULL, &one));
    if (one.moved == 0) goto done;
    for (size_t i = 0; i < count; i++) memcpy(r->points + 3 * (size_t)sample[i], points + 3 * i, 3 * sizeof *points);
    if (one.moved > all->moved) all->step = one.step;
    all->moved += one.moved;
done:
    return status;
}

/* Undoes the rounding of depths, which hides the noise, of each scanner alone. Tells the step of the one that saw
 * most. */
static brio_status unround(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    scanners s = {.r = r};
    brio_rounding all = {0};
    size_t n = r->num_points;
    BRIO_TRY(sort_by_scanner(&s));
    BRIO_TRY(BRIO_ALLOC(r->ctx, s.points, 3 * n));
    for (size_t begin = 0, end; begin < n; begin = end) {
        for (end = begin + 1; end < n && s.scanner[end] == s.scanner[begin];) end++;
        BRIO_TRY(unround_some(r, s.sample + begin, end - begin, s.points, &all));
    }
    r->stats.unrounded = all.moved;
    r->stats.rounding = ldexp(all.step, r->exponent);
done:
    brio_release(r->ctx, s.scanner);
    brio_release(r->ctx, s.sample);
    brio_release(r->ctx, s.points);
    return status;
}

brio_status brio_treat_noise(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_noise how = r->options->noise;
    brio_least_scatter scatter;
    if (how != BRIO_NOISE_KEEP) BRIO_TRY(unround(r));
    BRIO_TRY(brio_least_noise(r->ctx, r->points, r->num_points, &scatter));
    r->left = r->stats.noise = scatter.level;
    r->is_layered = scatter.layered;
    r->stats.smoothed = how == BRIO_NOISE_SMOOTH || (how == BRIO_NOISE_AUTO && r->stats.noise > LEAST_NOISE);
    if (r->stats.smoothed && r->stats.noise > MOST_NOISE && !(how == BRIO_NOISE_AUTO && scatter.layered)) {
        BRIO_TRY(brio_smooth_samples(r->ctx, r->points, r->num_points));
        BRIO_TRY(brio_least_noise(r->ctx, r->points, r->num_points, &scatter));
        r->left = scatter.level;
    }
    brio_lap(r, &r->stats.noise_seconds);
done:
    return status;
}
