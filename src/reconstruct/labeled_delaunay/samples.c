/* The samples of the labeled Delaunay triangulation: the caller's points in canonical order, scaled, without strays,
 * and smoothed first where they are noisier than the log-odds of the votes were measured for. */
#include "base/memory.h"
#include "base/scale.h"
#include "dual/spacing.h"
#include "order/canonical_points.h"
#include "reconstruct/labeled_delaunay/reconstruction.h"
#include "reconstruct/labeled_delaunay/stray_samples.h"
#include "reconstruct/noise/sample_noise.h"

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
done:
    return status;
}

brio_status brio_triangulate_samples(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_delaunay_options o = {0};
    o.seed = r->options->seed;
    BRIO_TRY(brio_delaunay(r->ctx, r->points, NULL, r->num_points, &o, &r->delaunay));
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

brio_status brio_treat_noise(brio_reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_noise how = r->options->noise;
    brio_least_scatter scatter;
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
