/* The co-cone: from points and options to a mesh.
 *
 * The samples are taken in canonical order and scaled by a power of two to coordinates of at most 1, so that nothing
 * overflows or underflows. Their triangles come from the whole set (cocone_surface.c), or from pieces whose triangles
 * are matched (super_cocone.c). Pieces are scaled one at a time. */
#include "base/memory.h"
#include "base/scale.h"
#include "order/canonical_points.h"
#include "mesh/properties.h"
#include "reconstruct/surface/method.h"
#include "reconstruct/cocone/sampling_density.h"
#include "reconstruct/cocone/super_cocone.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double THETA = 0.39269908169872414; /* pi / 8, what 0 stands for */

/* Replaces the ranks of samples by the caller's indices. */
static brio_status name_samples(brio_context *ctx, const uint32_t *order, size_t n, brio_cocone_surface *s) {
    brio_status status = BRIO_OK;
    uint8_t *boundary = NULL;
    double *size = NULL;
    for (size_t c = 0; c < 3 * s->num_faces; c++) s->faces[c] = order[s->faces[c]];
    if (s->boundary) BRIO_TRY(BRIO_ALLOC(ctx, boundary, n));
    if (s->size) BRIO_TRY(BRIO_ALLOC(ctx, size, n));
    for (size_t r = 0; r < n; r++) {
        if (boundary) boundary[order[r]] = s->boundary[r];
        if (size) size[order[r]] = s->size[r];
    }
    brio_release(ctx, s->boundary);
    brio_release(ctx, s->size);
    s->boundary = boundary, s->size = size;
    boundary = NULL, size = NULL;
done:
    brio_release(ctx, boundary);
    brio_release(ctx, size);
    return status;
}

/* Finds the co-cone of the whole set, scaled by 2^-exponent. */
static brio_status find_surface(brio_context *ctx, const double *points, size_t num_points, int exponent,
                                const brio_surface_options *options, brio_cocone_surface *surface) {
    brio_status status = BRIO_OK;
    double *scaled = NULL;
    uint32_t *order = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, scaled, 3 * num_points));
    BRIO_TRY(brio_canonical_points(ctx, points, num_points, &order));
    brio_copy_points(points, order, num_points, scaled);
    BRIO_TRY(brio_scale(ctx, scaled, 3 * num_points, -exponent, scaled));
    brio_sample_evidence evidence = {.order = order, .exponent = exponent};
    BRIO_TRY(brio_take_evidence(ctx, options->evidence, num_points, &evidence));
    BRIO_TRY(brio_cocone_surface_find(ctx, scaled, num_points, options, &evidence, surface));
    BRIO_TRY(name_samples(ctx, order, num_points, surface));
done:
    brio_release(ctx, scaled);
    brio_release(ctx, order);
    return status;
}

/* Moves the triangles into a mesh of the points. */
static brio_status fill_mesh(const double *points, size_t num_points, brio_cocone_surface *s, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_mesh_set_vertices(mesh, points, num_points));
    BRIO_TRY(BRIO_ALLOC(mesh->context, mesh->face_offsets, s->num_faces + 1));
    for (size_t f = 0; f <= s->num_faces; f++) mesh->face_offsets[f] = 3 * f;
    mesh->face_vertices = s->faces;
    mesh->num_faces = s->num_faces;
    s->faces = NULL;
done:
    return status;
}

static brio_status count_unused(const brio_mesh *mesh, brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    uint8_t *used = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(mesh->context, used, mesh->num_vertices));
    for (size_t c = 0; c < 3 * mesh->num_faces; c++)
        count += !used[mesh->face_vertices[c]], used[mesh->face_vertices[c]] = 1;
    stats->unused = stats->samples - count;
done:
    brio_release(mesh->context, used);
    return status;
}

/* Adds the properties that options.density asks for. */
static brio_status add_properties(const brio_cocone_surface *s, int exponent, brio_mesh *mesh,
                                  brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    double start = brio_seconds();
    BRIO_TRY(brio_sampling_density(s->size, exponent, mesh, stats));
    if (s->boundary) {
        uint8_t *property = NULL;
        BRIO_TRY(brio_mesh_add_property(mesh, "boundary", BRIO_SCALAR_UINT8, (void **)&property));
        memcpy(property, s->boundary, mesh->num_vertices);
    }
    stats->density_seconds += brio_seconds() - start;
done:
    return status;
}

static brio_status check_options(brio_context *ctx, const brio_surface_options *o) {
    BRIO_EXPECT(ctx, o->theta > 0 && o->theta < 1.57, BRIO_ERR_ARGUMENT, "theta is %g, expected a number in (0, pi/2)",
                o->theta);
    BRIO_EXPECT(ctx, !BRIO_PART(ctx, extraction) || (o->method == BRIO_SURFACE_COCONE && o->pieces <= 1),
                BRIO_ERR_ARGUMENT, "candidates, pruned and walk are extractions of the co-cone in one piece");
    BRIO_EXPECT(ctx, !o->explanation || o->pieces <= 1, BRIO_ERR_ARGUMENT,
                "an explanation is of a co-cone in one piece");
    BRIO_EXPECT(ctx, !o->evidence || o->pieces <= 1, BRIO_ERR_ARGUMENT, "evidence is for a co-cone in one piece");
    return BRIO_OK;
}

/* Names each vertex after its point: they have the same numbers. */
static brio_status add_samples(brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    uint32_t *samples = NULL;
    BRIO_TRY(BRIO_ALLOC(mesh->context, samples, mesh->num_vertices));
    for (size_t v = 0; v < mesh->num_vertices; v++) samples[v] = (uint32_t)v;
    BRIO_TRY(brio_mesh_add_samples(mesh, mesh->num_vertices, samples));
done:
    brio_release(mesh->context, samples);
    return status;
}

brio_method_fn brio_cocone;

brio_status brio_cocone(brio_context *ctx, const double *points, size_t num_points, const brio_surface_options *options,
                        brio_mesh *mesh, brio_surface_stats *stats) {
    brio_status status = BRIO_OK;
    brio_surface_options o = *options;
    brio_cocone_surface surface = {0};
    if (o.theta == 0) o.theta = THETA;
    BRIO_TRY(check_options(ctx, &o));
    int exponent = brio_exponent(brio_greatest(points, 3 * num_points));
    BRIO_TRY(o.pieces > 1 ? brio_super_cocone(ctx, points, num_points, exponent, &o, &surface)
                          : find_surface(ctx, points, num_points, exponent, &o, &surface));
    BRIO_TRY(fill_mesh(points, num_points, &surface, mesh));
    BRIO_TRY(count_unused(mesh, &surface.stats));
    if (o.density) BRIO_TRY(add_properties(&surface, exponent, mesh, &surface.stats));
    BRIO_TRY(add_samples(mesh));
    if (o.normals) BRIO_TRY(brio_point_normals(ctx, points, num_points, mesh, NULL, o.normals));
done:
    *stats = surface.stats;
    brio_cocone_surface_free(ctx, &surface);
    return status;
}
