/* The power crust: the faces of the power diagram of the polar balls between inner and outer cells. On request,
 * simplified to fewer triangles.
 *
 * Based on: Amenta, Choi, Kolluri. The power crust, unions of balls, and the medial axis transform. CGTA 2001.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.7. */
#include "reconstruct/power_crust/power_crust.h"
#include "base/float_state.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "base/scale.h"
#include "reconstruct/power_crust/crust_faces.h"
#include "reconstruct/power_crust/sample_normals.h"
#include "mesh/properties.h"
#include "mesh/simplify.h"
#include <math.h>

static const double POLES_SHARE = 0.9; /* of the progress bar */
static const double FACES_SHARE = 0.3; /* of the bar of the crust, the faces before the simplification */
static const double LONGEST_COLLAPSE = 1.5, COLLAPSE_TOLERANCE = 0.1; /* in spacings */

static const brio_power_crust_options STANDARD = {.size = sizeof STANDARD, .seed = 1};

BRIO_OPTIONS_INIT(brio_power_crust_options)

/* Simplifies the mesh to a quarter of its faces, or to as few as the limits allow. */
static brio_status simplify(brio_labeled_poles *l, size_t polygons, brio_mesh *mesh, double *seconds) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    brio_collapse_options o = {.target_faces = polygons / 4,
                               .spacing = brio_mesh_property(mesh, "spacing")->data,
                               .longest = LONGEST_COLLAPSE,
                               .tolerance = COLLAPSE_TOLERANCE};
    BRIO_TRY(brio_collapse_edges(l->ctx, mesh, &o));
    *seconds = brio_seconds() - start;
done:
    return status;
}

brio_status brio_make_crust(brio_labeled_poles *l, const brio_power_crust_options *o, brio_mesh *mesh, double *normals,
                            brio_power_crust_stats *stats) {
    brio_status status = BRIO_OK;
    const brio_bar bar = brio_progress_bar(l->ctx);
    double start = brio_seconds();
    brio_crust_options options = {o->triangulate || o->simplify, o->open, l->spacing};
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

brio_status brio_power_crust(brio_context *ctx, const double *points, size_t num_points,
                             const brio_power_crust_options *options, brio_mesh **out, double *normals,
                             brio_power_crust_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_power_crust_options o = STANDARD;
    brio_power_crust_stats s = {0};
    brio_labeled_poles l = {.ctx = ctx};
    brio_pole_request request;
    brio_mesh *mesh = NULL;
    const brio_bar bar = brio_progress_bar(ctx);
    *out = NULL;
    brio_keep_begin(ctx);
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_power_crust_stats, stats));
    BRIO_TRY(BRIO_TAKE(ctx, brio_power_crust_options, options, &o));
    BRIO_TRY(brio_pole_request_of(ctx, &o.poles, o.seed, &request));
    BRIO_REQUIRE(ctx, o.open >= 0 && o.open < INFINITY, BRIO_ERR_ARGUMENT,
                 "open: %g spacings, expected a finite number, 0 or more", o.open);
    request.spacing = o.open > 0 || o.simplify;
    request.representative = normals != NULL;
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    brio_progress_part(ctx, bar, 0, POLES_SHARE);
    BRIO_TRY(brio_labeled_poles_find(ctx, points, num_points, &request, &l));
    if (o.poles.solid) brio_labeled_poles_close_hull(&l);
    brio_progress_part(ctx, bar, POLES_SHARE, 1);
    BRIO_TRY(brio_make_crust(&l, &o, mesh, normals, &s));
    *out = mesh;
    mesh = NULL;
done:
    s.poles = l.stats;
    BRIO_GIVE(brio_power_crust_stats, stats, &s);
    brio_progress_part(ctx, bar, 0, 1);
    brio_mesh_free(mesh);
    brio_labeled_poles_free(&l);
    brio_keep_end(ctx);
    return status;
}
