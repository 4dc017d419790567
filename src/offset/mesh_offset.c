/* Offsets of closed meshes.
 *
 * The surface is made through samples on the exact offset: first those over the corners of the faces, then, round by
 * round, more of them where the surface through the samples is farther from the offset than allowed. When no such
 * place is left, the bound is proven for every triangle; then a net of points of the offset is held against the
 * surface, coarse first, so that no part is missed. What is found begins the rounds anew.
 *
 * Flat parts of the offset need samples at their corners only; round ones as many as the error asks for. Concave edges
 * are sharp, because samples are put on them.
 *
 * Based on: Boissonnat, Oudot. Provably good sampling and meshing of surfaces. Graphical Models 2005. Chen, Panozzo,
 * Dou, Chen, Liu. Half-space power diagrams and discrete surface offsets. IEEE TVCG 2019 (what an offset has to
 * keep). */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/scale.h"
#include "base/versioned.h"
#include "mesh/edge_rings.h"
#include "mesh/extent.h"
#include "mesh/split_vertices.h"
#include "offset/work.h"
#include <math.h>
#include <string.h>

enum {
    FEW_IDLE = 3,
    MOST_IDLE = 12, /* rounds with neither fewer faults nor many more samples; chosen */
    COARSEST = 16 /* cells of the first net along the longest side; chosen */,
    MOST_CATCHES = 3
};

static const double USUAL_ERROR = 0.01;    /* of the distance */
static const double AIM = 0.75;            /* of the error, for samples: so what stays a fault is within it; chosen */
static const double GROWTH = 1.05;         /* of the number of samples, that is many more; chosen */
static const double FINEST = 0.5;          /* spacing of the last net, in distances; chosen */
static const double LEAST_ERROR = 0x1p-38; /* of the greatest coordinate: what doubles can tell */

static const double FARTHEST = 0x1p30; /* of the size: where an offset hardly differs from a point's; chosen */
#define SWALLOWED "the offset by %g swallows the whole object: no inside is left"

static void offset_work_free(brio_offset_work *w) {
    brio_release(w->ctx, w->points);
    brio_release(w->ctx, w->triangles);
    brio_release(w->ctx, w->faults);
    brio_seen_free(w->ctx, &w->labels);
    brio_seen_free(w->ctx, &w->passed);
}

brio_status brio_offset_progress(brio_offset_work *w) {
    return brio_progress(w->ctx, "offset", w->share);
}

brio_status brio_offset_add(brio_offset_work *w, const double *p) {
    BRIO_EXPECT(w->ctx, w->num_points < UINT32_MAX, BRIO_ERR_TOO_LARGE, "an offset of more than 2^32 vertices");
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, w->points, w->point_capacity, 3 * w->num_points + 3));
    memcpy(w->points + 3 * w->num_points++, p, 3 * sizeof *p);
    return BRIO_OK;
}

brio_status brio_offset_add_apart(brio_offset_work *w, const brio_point_tree *tree, const double (*point)[3],
                                  size_t count, size_t *added) {
    brio_status status = BRIO_OK;
    uint8_t *chosen = NULL;
    const double apart = BRIO_OFFSET_APART * w->error;
    *added = 0;
    BRIO_TRY(BRIO_ALLOC(w->ctx, chosen, count));
    if (count) BRIO_TRY(brio_thin(w->ctx, point[0], count, apart, chosen, NULL));
    for (size_t i = 0; i < count; i++) {
        if (!chosen[i] || !(brio_nearest_square(tree, point[i], INFINITY) > apart * apart)) continue;
        BRIO_TRY(brio_offset_add(w, point[i]));
        ++*added;
    }
done:
    brio_release(w->ctx, chosen);
    return status;
}

/* Returns the largest of the bounds that are proven for the triangles. */
static double worst_of(const brio_offset_work *w) {
    double worst = w->error;
    for (size_t i = 0; i < w->num_faults; i++) worst = fmax(worst, w->faults[i].bound);
    return worst;
}

/* Tests the surface and, when it passes or `prove` is set, proves its bound. */
static brio_status judge(brio_offset_work *w, bool prove) {
    BRIO_FORWARD(brio_offset_test(w));
    if (!w->num_faults || prove) BRIO_FORWARD(brio_offset_prove(w));
    if (w->num_triangles) w->share = fmax(w->share, 0.9 * (1 - (double)w->num_faults / (double)w->num_triangles));
    return BRIO_OK;
}

/* Adds samples until the surface through them is proven to be within the error, or nothing more helps. */
static brio_status refine(brio_offset_work *w, size_t *rounds) {
    size_t least = SIZE_MAX, points = 0, added = 1;
    for (int idle = 0; added && idle < MOST_IDLE; ++*rounds) {
        BRIO_FORWARD(brio_offset_connect(w));
        BRIO_FORWARD(judge(w, idle >= FEW_IDLE));
        if (idle >= FEW_IDLE && worst_of(w) <= w->error / AIM) return BRIO_OK;
        if (!w->num_faults) return BRIO_OK;
        idle = w->num_faults < least || (double)w->num_points > GROWTH * (double)points ? 0 : idle + 1;
        if (!idle) points = w->num_points, least = w->num_faults;
        BRIO_FORWARD(brio_offset_mend(w, &added));
    }
    return brio_offset_prove(w);
}

static brio_status make(brio_offset_work *w, size_t *rounds) {
    const brio_box *box = &w->field.solid->tree.boxes[0];
    double size = 0, finest = FINEST * w->field.distance;
    for (int k = 0; k < 3; k++) size = fmax(size, box->high[k] - box->low[k]);
    if (!w->field.inwards) size += 2 * w->field.distance;
    BRIO_FORWARD(brio_offset_seed(w));
    BRIO_FORWARD(refine(w, rounds));
    for (double spacing = size / COARSEST, reached = 0;; spacing *= 0.5) {
        size_t added = 1;
        for (int i = 0; i < MOST_CATCHES && added; i++) {
            BRIO_FORWARD(brio_offset_catch(w, spacing, &reached, &added));
            if (added) BRIO_FORWARD(refine(w, rounds));
        }
        if (spacing <= finest || reached > spacing) break;
    }
    return BRIO_OK;
}

/* Makes the mesh, of the vertices that are used. */
static brio_status give(const brio_offset_work *w, int exponent, brio_mesh **out) {
    brio_status status = BRIO_OK;
    uint64_t *offsets = NULL;
    size_t n = w->num_triangles;
    BRIO_TRY(brio_mesh_new(w->ctx, out));
    BRIO_TRY(brio_mesh_set_vertices(*out, w->points, w->num_points));
    BRIO_TRY(brio_scale_vertices(w->ctx, (*out)->vertices, w->num_points, exponent));
    BRIO_TRY(BRIO_ALLOC(w->ctx, offsets, n + 1));
    for (size_t i = 0; i <= n; i++) offsets[i] = 3 * i;
    BRIO_TRY(brio_mesh_set_faces(*out, offsets, w->triangles[0], n));
    BRIO_TRY(brio_mesh_split_vertices(w->ctx, *out));
done:
    brio_release(w->ctx, offsets);
    return status;
}

/* Returns the longest side of the box of the vertices that faces use. */
static double size_of(const brio_mesh *mesh) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, size = 0;
    if (mesh->num_faces) brio_box_add_corners(mesh, 0, mesh->face_offsets[mesh->num_faces], low, high);
    for (int k = 0; k < 3; k++) size = fmax(size, high[k] - low[k]);
    return size;
}

brio_status brio_offset_settle(brio_context *ctx, const brio_mesh *mesh, double distance,
                               const brio_mesh_offset_options *options, brio_mesh_offset_options *o) {
    *o = (brio_mesh_offset_options){0};
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_mesh_offset_options, options, o));
    BRIO_FORWARD(brio_mesh_check_faces(ctx, mesh));
    BRIO_FORWARD(brio_refuse_vertices(ctx, mesh->vertices, mesh->num_vertices, "the mesh"));
    double most = brio_greatest(mesh->vertices, 3 * mesh->num_vertices), size = size_of(mesh);
    BRIO_EXPECT(ctx, isfinite(distance) && distance != 0, BRIO_ERR_ARGUMENT,
                "the distance of an offset of a mesh is a finite number and not 0");
    BRIO_EXPECT(ctx, isfinite(o->error) && o->error >= 0, BRIO_ERR_ARGUMENT,
                "the error of an offset is a finite number, 0 or more");
    if (o->error == 0) o->error = USUAL_ERROR * fabs(distance);
    BRIO_EXPECT(ctx, o->error < fabs(distance), BRIO_ERR_ARGUMENT,
                "the error %g of an offset is not less than its distance %g", o->error, fabs(distance));
    BRIO_EXPECT(ctx, mesh->num_faces > 0, BRIO_BECAUSE(ctx, OPEN_MESH, BRIO_ERR_NO_ANSWER),
                "the mesh has no inside: it has no faces");
    BRIO_EXPECT(ctx, -distance <= size, BRIO_BECAUSE(ctx, SWALLOWED, BRIO_ERR_NO_ANSWER), SWALLOWED, distance);
    BRIO_EXPECT(ctx, distance / FARTHEST <= size, BRIO_ERR_ARGUMENT,
                "the distance %g of the offset is more than 2^30 times the size %g of the mesh", distance, size);
    most = fmax(most, fabs(distance));
    BRIO_EXPECT(ctx, o->error > LEAST_ERROR * most, BRIO_ERR_ARGUMENT,
                "an error of %g is too small for doubles at coordinates of %g", o->error, most);
    return BRIO_OK;
}

brio_status brio_mesh_offset(brio_context *ctx, const brio_mesh *mesh, double distance,
                             const brio_mesh_offset_options *options, brio_mesh **out, brio_mesh_offset_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_mesh_offset_options o;
    brio_mesh_offset_stats s = {0};
    brio_solid solid = {{0}};
    brio_mesh scaled = *mesh;
    double *vertices = NULL;
    brio_offset_work w = {.ctx = ctx};
    *out = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_mesh_offset_stats, stats));
    BRIO_TRY(brio_offset_settle(ctx, mesh, distance, options, &o));
    int exponent = brio_exponent(fmax(brio_greatest(mesh->vertices, 3 * mesh->num_vertices), fabs(distance)));
    BRIO_TRY(BRIO_ALLOC(ctx, vertices, 3 * mesh->num_vertices));
    BRIO_TRY(brio_scale(ctx, mesh->vertices, 3 * mesh->num_vertices, -exponent, vertices));
    scaled.vertices = vertices;
    BRIO_TRY(brio_solid_new(ctx, &scaled, &solid));
    w.field = (brio_offset_field){&solid, ldexp(fabs(distance), -exponent), distance < 0};
    w.error = ldexp(AIM * o.error, -exponent);
    BRIO_TRY(make(&w, &s.rounds));
    BRIO_REQUIRE(ctx, w.num_triangles > 0, BRIO_BECAUSE(ctx, SWALLOWED, BRIO_ERR_NO_ANSWER), SWALLOWED, distance);
    BRIO_TRY(give(&w, exponent, out));
    s.samples = w.num_points;
    s.error = ldexp(worst_of(&w), exponent);
    BRIO_GIVE(brio_mesh_offset_stats, stats, &s);
done:
    offset_work_free(&w);
    brio_solid_free(ctx, &solid);
    brio_release(ctx, vertices);
    if (status != BRIO_OK) {
        brio_mesh_free(*out);
        *out = NULL;
    }
    return status;
}
