/* The co-cone and the tight co-cone.
 *
 *   1. Delaunay triangulation of the samples.
 *   2. The direction of each sample's pole.
 *   3. Candidates: the triangles whose dual Voronoi edges meet the co-cones of their samples, less those at sharp
 *      edges.
 *   4. Outer or inner, for each sample's pole and then for each tetrahedron.
 *   5. A manifold: the boundary between the labels; of that, the candidates (co-cone) or all of it (tight co-cone).
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000.
 *           Dey, Goswami. Tight cocone: a water-tight surface reconstructor. JCISE 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.2 and appendix A. */
#include "base/memory.h"
#include "reconstruct/boundary_samples.h"
#include "reconstruct/cocone_prune.h"
#include "reconstruct/flat_tetrahedra.h"
#include "reconstruct/manifold_extraction.h"
#include "reconstruct/sample_orientation.h"
#include "reconstruct/sampling_density.h"
#include <math.h>
#include <string.h>

brio_cocone_options brio_cocone_options_default(void) {
    return (brio_cocone_options){.seed = 1, .theta = 0.39269908169872414 /* pi / 8 */};
}

typedef struct {
    brio_context *ctx;
    const brio_cocone_options *options;
    size_t num_points;
    double *points; /* scaled by 2^-exponent to at most 1 */
    int exponent;
    brio_triangulation *delaunay;
    brio_pole_vectors dual;
    brio_cocones cocones;
    uint8_t *boundary; /* of each sample, with options->boundaries; else NULL */
    uint8_t *turned;
    brio_tet_labels labels;
    brio_cocone_stats stats;
    double lap;
} reconstruction;

/* Seconds since the last call. */
static double lap(reconstruction *r) {
    double now = brio_seconds(), seconds = now - r->lap;
    r->lap = now;
    return seconds;
}

static void stage(reconstruction *r, double from, double to) {
    r->ctx->progress_from = from;
    r->ctx->progress_to = to;
}

static brio_status scale_points(reconstruction *r, const double *points) {
    brio_status status = BRIO_OK;
    double most = 0;
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->points, 3 * r->num_points));
    for (size_t i = 0; i < 3 * r->num_points; i++) most = fmax(most, fabs(points[i]));
    if (isfinite(most)) frexp(most, &r->exponent);
    for (size_t i = 0; i < 3 * r->num_points; i++) r->points[i] = ldexp(points[i], -r->exponent) + 0.0; /* no -0 */
done:
    return status;
}

static brio_status triangulate(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_options o = brio_options_default();
    o.seed = r->options->seed;
    stage(r, 0, 0.5);
    BRIO_TRY(brio_delaunay(r->ctx, r->points, NULL, r->num_points, &o, &r->delaunay));
    const brio_stats *s = brio_triangulation_stats(r->delaunay);
    r->stats.samples = s->vertices;
    BRIO_REQUIRE(r->ctx, s->dimension == 3, BRIO_ERR_NO_ANSWER, "%zu distinct points of dimension %d bound no solid",
                 s->vertices, s->dimension);
    r->stats.delaunay_seconds = lap(r);
done:
    return status;
}

static brio_status find_candidates(reconstruction *r) {
    brio_status status = BRIO_OK;
    stage(r, 0.5, 0.65);
    BRIO_TRY(brio_pole_vectors_find(r->ctx, r->delaunay, r->points, r->num_points, r->options->theta, &r->dual));
    r->stats.poles_seconds = lap(r);
    BRIO_TRY(brio_cocones_new(r->ctx, &r->dual, &r->cocones));
    if (r->options->boundaries) {
        BRIO_TRY(brio_boundary_samples(r->ctx, &r->cocones, &r->boundary, &r->stats.boundary_samples));
        r->cocones.boundary = r->boundary;
    }
    brio_cocones_select(r->ctx, &r->cocones, &r->stats.candidates);
    BRIO_REQUIRE(r->ctx, r->stats.candidates > 0, BRIO_ERR_NO_ANSWER, "no triangle passes the co-cone test");
    r->stats.candidates_seconds = lap(r);
done:
    return status;
}

static brio_status label(reconstruction *r) {
    brio_status status = BRIO_OK;
    stage(r, 0.65, 0.8);
    BRIO_TRY(brio_orient_samples(r->ctx, &r->cocones, &r->turned));
    r->labels = (brio_tet_labels){.cocones = &r->cocones, .turned = r->turned, .watertight = r->options->tight};
    BRIO_TRY(brio_tet_labels_vote(r->ctx, &r->labels));
    BRIO_TRY(brio_cocone_prune(r->ctx, &r->labels, &r->stats.pruned));
    BRIO_TRY(brio_tet_labels_spread(r->ctx, &r->labels));
    BRIO_TRY(brio_flatten(r->ctx, &r->labels));
    r->stats.labels_seconds = lap(r);
done:
    return status;
}

static brio_status extract(reconstruction *r, const double *points, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    stage(r, 0.8, 0.9);
    BRIO_TRY(brio_make_manifold(r->ctx, &r->labels, &r->stats.relabelled));
    BRIO_TRY(brio_mesh_set_vertices(mesh, points, r->num_points));
    BRIO_TRY(brio_extract_faces(r->ctx, &r->labels, !r->options->tight, mesh));
    BRIO_REQUIRE(r->ctx, mesh->num_faces > 0, BRIO_ERR_NO_ANSWER, "no inside found");
    r->stats.manifold_seconds = lap(r);
done:
    return status;
}

static brio_status count_unused(reconstruction *r, const brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    uint8_t *used = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, used, r->num_points));
    for (size_t c = 0; c < 3 * mesh->num_faces; c++)
        count += !used[mesh->face_vertices[c]], used[mesh->face_vertices[c]] = 1;
    r->stats.unused = r->stats.samples - count;
done:
    brio_release(r->ctx, used);
    return status;
}

static brio_status measure_density(reconstruction *r, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    if (!r->options->density) return BRIO_OK;
    stage(r, 0.9, 1);
    BRIO_TRY(brio_sampling_density(r->ctx, &r->dual, r->exponent, mesh, &r->stats));
    if (r->options->boundaries) {
        uint8_t *property = NULL;
        BRIO_TRY(brio_mesh_add_property(mesh, "boundary", BRIO_UINT8, (void **)&property));
        memcpy(property, r->boundary, r->num_points);
    }
    r->stats.density_seconds = lap(r);
done:
    return status;
}

static brio_status reconstruct(reconstruction *r, const double *points, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(r->ctx, r->options->theta > 0 && r->options->theta < 1.57, BRIO_ERR_ARGUMENT,
                 "theta is %g, expected a number in (0, pi/2)", r->options->theta);
    BRIO_TRY(scale_points(r, points));
    BRIO_TRY(triangulate(r));
    BRIO_TRY(find_candidates(r));
    BRIO_TRY(label(r));
    BRIO_TRY(extract(r, points, mesh));
    BRIO_TRY(count_unused(r, mesh));
    BRIO_TRY(measure_density(r, mesh));
done:
    return status;
}

static void release(reconstruction *r) {
    brio_tet_labels_free(r->ctx, &r->labels);
    brio_release(r->ctx, r->turned);
    brio_release(r->ctx, r->boundary);
    brio_cocones_free(r->ctx, &r->cocones);
    brio_pole_vectors_free(r->ctx, &r->dual);
    brio_triangulation_free(r->delaunay);
    brio_release(r->ctx, r->points);
}

brio_status brio_cocone(brio_context *ctx, const double *points, size_t num_points, const brio_cocone_options *options,
                        brio_mesh **out, brio_cocone_stats *stats) {
    brio_status status = BRIO_OK;
    brio_cocone_options standard = brio_cocone_options_default();
    brio_mesh *mesh = NULL;
    reconstruction r = {
        .ctx = ctx, .options = options ? options : &standard, .num_points = num_points, .lap = brio_seconds()};
    *out = NULL;
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(reconstruct(&r, points, mesh));
    *out = mesh;
    mesh = NULL;
done:
    if (stats) *stats = r.stats;
    stage(&r, 0, 1);
    brio_mesh_free(mesh);
    release(&r);
    return status;
}
