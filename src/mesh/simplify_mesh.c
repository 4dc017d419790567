/* Simplification of a mesh as a whole: one tolerance everywhere, edges of any length. See simplify.c for the collapses.
 *
 * Products of seven lengths, as the quadrics' solutions have them, would overflow or vanish with coordinates beyond 2^HUGE or
 * below 2^-HUGE: such meshes are scaled meanwhile. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/versioned.h"
#include "mesh/simplify.h"
#include "mesh/simplify_any.h"
#include <math.h>
#include <stdlib.h>

enum { HUGE_EXPONENT = 100 };

static const brio_mesh_simplify_options STANDARD = {.size = sizeof STANDARD};

BRIO_OPTIONS_INIT(brio_mesh_simplify_options)

/* Returns the exponent of the largest coordinate if that is out of range, or 0. */
static int exponent_of(const brio_mesh *mesh) {
    int exponent = brio_exponent(brio_greatest(mesh->vertices, 3 * mesh->num_vertices));
    return abs(exponent) > HUGE_EXPONENT ? exponent : 0;
}

static brio_status collapse(brio_context *ctx, brio_mesh *mesh, const brio_mesh_simplify_options *o, double tolerance) {
    /* the tolerance is one length, not a share of a spacing */
    brio_collapse_options options = {
        .target_faces = o->target_faces, .longest = INFINITY, .embedded = true, .tolerance = tolerance};
    return brio_collapse_edges(ctx, mesh, &options);
}

brio_status brio_mesh_simplify(brio_context *ctx, brio_mesh *mesh, const brio_mesh_simplify_options *options) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_mesh_simplify_options o = STANDARD;
    BRIO_TRY(BRIO_TAKE(ctx, brio_mesh_simplify_options, options, &o));
    BRIO_REQUIRE(ctx, o.tolerance >= 0 && o.tolerance < INFINITY, BRIO_ERR_ARGUMENT,
                 "a tolerance of %g, expected a finite number, 0 or more", o.tolerance);
    BRIO_REQUIRE(ctx, o.target_faces > 0 || o.tolerance > 0, BRIO_ERR_ARGUMENT,
                 "neither a number of faces nor a tolerance to simplify to");
    BRIO_REQUIRE(ctx, !mesh->num_edges && !mesh->num_tetrahedra, BRIO_ERR_ARGUMENT,
                 "a mesh with tetrahedra, or with edges that no face has: only faces are simplified");
    BRIO_TRY(brio_refuse_not_finite(ctx, mesh->vertices, NULL, mesh->num_vertices, NULL));
    if (o.any) BRIO_TRY(brio_mesh_take_apart(ctx, mesh));
    int exponent = exponent_of(mesh);
    if (exponent) BRIO_TRY(brio_scale(ctx, mesh->vertices, 3 * mesh->num_vertices, -exponent, mesh->vertices));
    status = collapse(ctx, mesh, &o, o.tolerance > 0 ? ldexp(o.tolerance, -exponent) : INFINITY);
    if (exponent) {
        brio_status scaled = brio_scale_vertices(ctx, mesh->vertices, mesh->num_vertices, exponent);
        if (status == BRIO_OK) status = scaled;
    }
    if (o.any && status == BRIO_OK) status = brio_mesh_put_together(ctx, mesh);
done:
    return status;
}
