/* The power crust: the faces of the power diagram of the polar balls between inner and outer cells. On request,
 * simplified to fewer triangles.
 *
 * Based on: Amenta, Choi, Kolluri. The power crust, unions of balls, and the medial axis transform. CGTA 2001.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.7. */
#include "reconstruct/power_crust/power_crust.h"
#include "reconstruct/surface/method.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/scale.h"
#include "reconstruct/power_crust/crust_explanation.h"
#include "reconstruct/power_crust/crust_faces.h"
#include "reconstruct/power_crust/sample_normals.h"
#include "mesh/properties.h"
#include "mesh/simplify.h"
#include <math.h>

static const double POLES_SHARE = 0.9; /* of the progress bar */
static const double FACES_SHARE = 0.3; /* of the bar of the crust, the faces before the simplification */
static const double LONGEST_COLLAPSE = 1.5, COLLAPSE_TOLERANCE = 0.1; /* in spacings */

/* Simplifies the mesh to a quarter of its faces, or to as few as the limits allow. */
static brio_status simplify(brio_labeled_poles *l, size_t polygons, brio_mesh *mesh, double *seconds) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    brio_collapse_options o = {.target_faces = polygons / 4,
                               .spacing = brio_mesh_property(mesh, "spacing")->data,
                               .longest = LONGEST_COLLAPSE,
                               .embedded = true,
                               .tolerance = COLLAPSE_TOLERANCE};
    BRIO_TRY(brio_collapse_edges(l->ctx, mesh, &o));
    *seconds = brio_seconds() - start;
done:
    return status;
}

brio_status brio_make_crust(brio_labeled_poles *l, const brio_surface_options *o, brio_mesh *mesh, double *normals,
                            brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    const brio_bar bar = brio_progress_bar(l->ctx);
    double start = brio_seconds();
    brio_crust_options options = {!o->polygons, o->open, l->spacing};
    brio_crust_counts counts;
    brio_progress_part(l->ctx, bar, 0, o->simplify ? FACES_SHARE : 1);
    BRIO_TRY(brio_crust_faces(&l->diagram, l->label, &options, mesh, &counts));
    stats->left_out = counts.left_out;
    stats->crust_seconds = brio_seconds() - start;
    if (normals) BRIO_TRY(brio_sample_normals(&l->diagram, l->label, l->representative, l->order, mesh, normals));
    brio_progress_part(l->ctx, bar, FACES_SHARE, 1);
    if (o->simplify) BRIO_TRY(simplify(l, counts.faces, mesh, &stats->simplify_seconds));
    brio_mesh_drop_properties(mesh, 0);
    BRIO_TRY(brio_scale_vertices(l->ctx, mesh->vertices, mesh->num_vertices, l->exponent));
done:
    brio_progress_part(l->ctx, bar, 0, 1);
    return status;
}

void brio_give_pole_stats(const brio_labeled_poles *l, brio_surface_stats *stats) {
    stats->poles = l->stats;
    stats->samples = l->found.samples;
    stats->noise = l->found.noise;
    stats->smoothed = l->found.smoothed;
    stats->noise_seconds = l->found.noise_seconds;
    stats->delaunay_seconds = l->found.delaunay_seconds;
    stats->poles_seconds = l->found.poles_seconds;
}

brio_method_fn brio_power_crust;

brio_status brio_power_crust(brio_context *ctx, const double *points, size_t num_points,
                             const brio_surface_options *options, brio_mesh *mesh, brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    brio_labeled_poles l = {.ctx = ctx};
    brio_pole_request request;
    const brio_bar bar = brio_progress_bar(ctx);
    brio_keep_begin(ctx);
    BRIO_TRY(brio_pole_request_of(ctx, &options->poles, options->noise, options->seed, &request));
    request.spacing = options->open > 0 || options->simplify;
    request.representative = options->normals || options->explanation;
    brio_progress_part(ctx, bar, 0, POLES_SHARE);
    BRIO_TRY(brio_labeled_poles_find(ctx, points, num_points, &request, &l));
    if (options->poles.solid) brio_labeled_poles_close_hull(&l);
    brio_progress_part(ctx, bar, POLES_SHARE, 1);
    BRIO_TRY(brio_make_crust(&l, options, mesh, options->normals, stats));
    BRIO_TRY(brio_explain_crust(&l, options));
    BRIO_TRY(brio_mesh_add_samples(mesh, num_points, NULL));
done:
    brio_give_pole_stats(&l, stats);
    brio_progress_part(ctx, bar, 0, 1);
    brio_labeled_poles_free(&l);
    brio_keep_end(ctx);
    return status;
}
