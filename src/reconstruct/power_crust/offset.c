/* Offset surfaces: the power crust of balls with other radii.
 *
 * For the offset by D, the radius of each inner ball grows by D, and that of each outer ball shrinks by D; D may be
 * negative. Balls without a positive radius are dropped. The labels stay. The power crust of any balls is the closed
 * boundary of a solid, so parts of an offset that meet are merged, without cracks or overlaps.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3.4.
 * Differs from the paper: the bounding points are moved out by 4 |D|, so that no
 *                         outer ball through one vanishes. */
#include "base/finite.h"
#include "base/memory.h"
#include "base/scale.h"
#include "mesh/properties.h"
#include "reconstruct/power_crust/power_crust.h"
#include "reconstruct/surface/method.h"
#include <float.h>
#include <math.h>

static const double POLES_SHARE = 0.6; /* of the progress bar */
static const double MOVE_SHARE = 0.75; /* of the bar of what follows */
static const double MARGIN = 4;        /* of the bounding points, in distances */
static const double FARTHEST =
    0x1p60; /* of the greatest coordinate: where doubles tell nothing of the points; chosen */
#define SWALLOWED "the offset by %g swallows the whole object: no inside is left"

/* Changes the radii. Sets keep[p] to 0 for balls whose radius is not positive, and to 1 for others. */
static void change_radii(brio_labeled_poles *l, double distance, uint8_t *keep) {
    double scaled = ldexp(distance, -l->exponent);
    for (size_t p = 0; p < l->poles.count; p++) {
        double radius = sqrt(l->poles.square[p]) + (l->label[p] == BRIO_LABEL_INNER ? scaled : -scaled);
        keep[p] = radius > 0;
        l->poles.square[p] = radius * radius;
    }
}

static brio_status move_surface(brio_labeled_poles *l, double distance) {
    brio_status status = BRIO_OK;
    uint8_t *keep = NULL;
    BRIO_TRY(BRIO_ALLOC(l->ctx, keep, l->poles.count));
    change_radii(l, distance, keep);
    BRIO_TRY(brio_labeled_poles_keep(l, keep));
    brio_labeled_poles_close_hull(l);
done:
    brio_release(l->ctx, keep);
    return status;
}

static brio_status find_balls(brio_labeled_poles *l, const double *points, size_t num_points,
                              const brio_surface_options *o) {
    brio_status status = BRIO_OK;
    const double distance = o->distance;
    brio_pole_request request;
    BRIO_REQUIRE(l->ctx, isfinite(distance), BRIO_ERR_ARGUMENT, "the distance of an offset is a finite number");
    BRIO_TRY(brio_refuse_many(l->ctx, num_points));
    double most = fmin(brio_greatest(points, 3 * num_points), DBL_MAX * 0x1p-64);
    BRIO_REQUIRE(l->ctx, num_points == 0 || distance <= FARTHEST * most, BRIO_ERR_ARGUMENT,
                 "the distance %g of the offset is more than 2^60 times the greatest coordinate %g", distance, most);
    BRIO_REQUIRE(l->ctx, num_points == 0 || -distance <= FARTHEST * most,
                 BRIO_BECAUSE(l->ctx, SWALLOWED, BRIO_ERR_NO_ANSWER), SWALLOWED, distance);
    BRIO_TRY(brio_pole_request_of(l->ctx, &o->poles, o->noise, o->seed, &request));
    request.spacing = o->simplify;
    request.margin = MARGIN * fabs(distance);
    BRIO_TRY(brio_labeled_poles_find(l->ctx, points, num_points, &request, l));
    BRIO_REQUIRE(l->ctx, l->stats.inner > 0, BRIO_BECAUSE(l->ctx, NO_INSIDE, BRIO_ERR_NO_ANSWER),
                 "no inside found: no pole is inner");
done:
    return status;
}

static brio_status make_offset(brio_labeled_poles *l, const brio_surface_options *o, brio_mesh *mesh,
                               brio_surface_stats *stats) {
    const brio_bar bar = brio_progress_bar(l->ctx);
    brio_progress_part(l->ctx, bar, 0, MOVE_SHARE);
    brio_status status = move_surface(l, o->distance);
    brio_progress_part(l->ctx, bar, MOVE_SHARE, 1);
    if (status == BRIO_OK) status = brio_make_crust(l, o, mesh, NULL, stats);
    brio_progress_part(l->ctx, bar, 0, 1);
    if (status == BRIO_ERR_NO_ANSWER && o->distance < 0)
        return brio_fail(l->ctx, BRIO_BECAUSE(l->ctx, SWALLOWED, status), SWALLOWED, o->distance);
    return status;
}

brio_method_fn brio_offset_surface;

brio_status brio_offset_surface(brio_context *ctx, const double *points, size_t num_points,
                                const brio_surface_options *options, brio_mesh *mesh, brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    brio_labeled_poles l = {.ctx = ctx};
    const brio_bar bar = brio_progress_bar(ctx);
    brio_progress_part(ctx, bar, 0, POLES_SHARE);
    BRIO_TRY(find_balls(&l, points, num_points, options));
    brio_progress_part(ctx, bar, POLES_SHARE, 1);
    BRIO_TRY(make_offset(&l, options, mesh, stats));
    BRIO_TRY(brio_mesh_add_samples(mesh, num_points, NULL));
done:
    brio_give_pole_stats(&l, stats);
    brio_progress_part(ctx, bar, 0, 1);
    brio_labeled_poles_free(&l);
    return status;
}
