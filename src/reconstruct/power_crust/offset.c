/* Offset surfaces: the power crust of balls with other radii. Outwards by D, inner balls grow by D and outer ones
 * shrink by it; inwards the other way round. What is left of radius 0 or less is dropped. The labels are those of the
 * surface itself. Whatever the balls, their power crust is the closed boundary of a solid, so that parts of an offset
 * that meet merge, without cracks or self-overlaps to be cut away.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3.4.
 * Differs from the paper: the bounding points are moved out by 4 |D|, so that no outer ball they hold back vanishes. */
#include "base/float_state.h"
#include "base/memory.h"
#include "reconstruct/power_crust/power_crust.h"
#include <math.h>

static const double POLES_SHARE = 0.6, POWER_SHARE = 0.9; /* of the progress bar */
static const double MARGIN = 4;                           /* of the bounding points, in distances */

/* Changes the radii; keep[p] = 0 for the balls that vanish. */
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

static brio_status check_options(brio_context *ctx, double distance, const brio_power_crust_options *o) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, isfinite(distance), BRIO_ERR_ARGUMENT, "the distance of an offset is a finite number");
    BRIO_REQUIRE(ctx, o->open == 0, BRIO_ERR_ARGUMENT, "an offset surface has no holes: open is not for it");
    BRIO_REQUIRE(ctx, !o->normals, BRIO_ERR_ARGUMENT, "the points are not on an offset surface: no normals of theirs");
done:
    return status;
}

static brio_status make_offset(brio_labeled_poles *l, const double *points, size_t num_points, double distance,
                               const brio_power_crust_options *o, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    brio_pole_request request;
    BRIO_TRY(check_options(l->ctx, distance, o));
    BRIO_TRY(brio_pole_request_of(l->ctx, o, &request));
    request.margin = MARGIN * fabs(distance);
    request.until = POLES_SHARE;
    BRIO_TRY(brio_labeled_poles_find(l->ctx, points, num_points, &request, l));
    l->ctx->progress_from = POLES_SHARE;
    l->ctx->progress_to = POWER_SHARE;
    BRIO_REQUIRE(l->ctx, l->stats.inner > 0, BRIO_ERR_NO_ANSWER, "no inside found: no pole is inner");
    status = move_surface(l, distance);
    if (status == BRIO_OK) status = brio_make_crust(l, o, POWER_SHARE, mesh);
    if (status == BRIO_ERR_NO_ANSWER && distance < 0)
        return brio_fail(l->ctx, status, "the offset by %g swallows the whole object: no inside is left", distance);
done:
    return status;
}

brio_status brio_offset_surface(brio_context *ctx, const double *points, size_t num_points, double distance,
                                const brio_power_crust_options *options, brio_mesh **out,
                                brio_power_crust_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_power_crust_options standard = brio_power_crust_options_default();
    brio_labeled_poles l = {.ctx = ctx};
    brio_mesh *mesh = NULL;
    *out = NULL;
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(make_offset(&l, points, num_points, distance, options ? options : &standard, mesh));
    *out = mesh;
    mesh = NULL;
done:
    if (stats) *stats = l.stats;
    ctx->progress_from = 0;
    ctx->progress_to = 1;
    brio_mesh_free(mesh);
    brio_labeled_poles_free(&l);
    return status;
}
