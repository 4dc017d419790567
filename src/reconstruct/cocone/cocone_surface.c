/* The co-cone and the tight co-cone of one set of samples.
 *
 *   1. The Delaunay triangulation of the samples.
 *   2. The direction of each sample's pole.
 *   3. Candidates: the triangles whose dual Voronoi edges meet the co-cones of their samples, except those at sharp
 *      edges.
 *   4. Labels, outer or inner, for each sample's pole and then for each tetrahedron.
 *   5. A manifold: the candidates in the boundary between the labels (co-cone), or the whole boundary (tight co-cone).
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000.
 *           Dey, Goswami. Tight cocone: a water-tight surface reconstructor. JCISE 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.2 and appendix A. */
#include "reconstruct/cocone/cocone_surface.h"
#include "base/memory.h"
#include "dual/feature_size.h"
#include "reconstruct/cocone/boundary_samples.h"
#include "reconstruct/cocone/cocone_prune.h"
#include "reconstruct/cocone/flat_tetrahedra.h"
#include "reconstruct/cocone/manifold_extraction.h"
#include "reconstruct/cocone/sample_orientation.h"
#include "reconstruct/explanation/explanation.h"
#include <string.h>

/* Of the samples. Half a sphere has 0.01, scans of one side 0.05, closed models with sharp edges 0.08, noisy ones 0.29.
 * Chosen. */
static const double MOST_BOUNDARY = 0.15;

typedef struct {
    brio_context *ctx;
    const brio_surface_options *options;
    const brio_sample_evidence *evidence; /* or NULL */
    const double *points;
    size_t num_points;
    brio_cocone_surface *out;
    brio_triangulation *delaunay;
    brio_pole_vectors dual;
    brio_cocones cocones;
    uint8_t *turned;
    brio_tet_labels labels;
    double lap;
} reconstruction;

/* Adds the seconds since the last call to *seconds. */
static void lap(reconstruction *r, double *seconds) {
    double now = brio_seconds();
    *seconds += now - r->lap;
    r->lap = now;
}

static brio_status triangulate(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_delaunay_options o = {0};
    o.seed = r->options->seed;
    BRIO_TRY(brio_delaunay(r->ctx, r->points, NULL, r->num_points, &o, &r->delaunay));
    const brio_delaunay_stats *s = brio_triangulation_stats(r->delaunay);
    const uint32_t *representative = brio_triangulation_representatives(r->delaunay);
    r->out->stats.samples = s->vertices;
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->out->distinct, r->num_points));
    for (size_t p = 0; p < r->num_points; p++) r->out->distinct[p] = representative[p] == p;
    BRIO_REQUIRE(r->ctx, s->dimension == 3, BRIO_ERR_NO_ANSWER, "%zu distinct points of dimension %d bound no solid",
                 s->vertices, s->dimension);
    lap(r, &r->out->stats.delaunay_seconds);
done:
    return status;
}

/* Finds the boundary samples. With BRIO_BOUNDARIES_AUTO there are none where many would be: then the samples are too
 * few, or too noisy, all over, and their cells tell nothing of boundaries. */
static brio_status find_boundary(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_cocone_surface *out = r->out;
    size_t *count = &out->stats.boundary_samples;
    BRIO_TRY(brio_boundary_samples(r->ctx, &r->cocones, &out->boundary, count));
    if (r->options->boundaries == BRIO_BOUNDARIES_AUTO && (double)*count > MOST_BOUNDARY * (double)out->stats.samples) {
        memset(out->boundary, 0, r->num_points);
        *count = 0;
    }
    r->cocones.boundary = out->boundary;
done:
    return status;
}

static brio_status find_candidates(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_surface_stats *s = &r->out->stats;
    BRIO_TRY(brio_pole_vectors_find(r->ctx, r->delaunay, r->points, r->num_points, r->options->theta, &r->dual));
    lap(r, &s->poles_seconds);
    BRIO_TRY(brio_cocones_new(r->ctx, &r->dual, &r->cocones));
    if (r->options->boundaries) BRIO_TRY(find_boundary(r));
    BRIO_TRY(brio_cocones_select(r->ctx, &r->cocones, &s->candidates));
    BRIO_REQUIRE(r->ctx, s->candidates > 0, BRIO_ERR_NO_ANSWER, "no triangle passes the co-cone test");
    lap(r, &s->candidates_seconds);
done:
    return status;
}

static brio_status label(reconstruction *r) {
    brio_status status = BRIO_OK;
    float *own = NULL;
    unsigned used;
    BRIO_TRY(brio_orient_samples(r->ctx, &r->cocones, &r->turned));
    if (r->evidence) BRIO_TRY(brio_orient_by_evidence(r->ctx, r->evidence, &r->cocones, r->turned, &own, &used));
    r->labels = (brio_tet_labels){.cocones = &r->cocones,
                                  .dual = &r->dual,
                                  .turned = r->turned,
                                  .watertight = r->options->method == BRIO_SURFACE_TIGHT_COCONE};
    BRIO_TRY(brio_tet_labels_vote(r->ctx, &r->labels));
    BRIO_TRY(brio_cocone_prune(r->ctx, &r->labels, &r->out->stats.pruned));
    BRIO_TRY(brio_tet_labels_spread(r->ctx, &r->labels));
    BRIO_TRY(brio_flatten(r->ctx, &r->labels));
    lap(r, &r->out->stats.labels_seconds);
done:
    brio_release(r->ctx, own);
    return status;
}

static brio_status extract_as(reconstruction *r, const struct brio_extraction_part *part) {
    brio_status status = BRIO_OK;
    brio_cocone_surface *out = r->out;
    BRIO_TRY(part->extract(part->user, r->ctx, &r->cocones, &out->stats.pruned, &out->faces, &out->num_faces));
    BRIO_REQUIRE(r->ctx, out->num_faces > 0, BRIO_ERR_NO_ANSWER, "no triangle is left of %zu candidates",
                 out->stats.candidates);
    lap(r, &out->stats.manifold_seconds);
done:
    return status;
}

static brio_status extract(reconstruction *r) {
    brio_status status = BRIO_OK;
    brio_cocone_surface *out = r->out;
    brio_facets boundary = {0};
    BRIO_TRY(brio_make_manifold(r->ctx, &r->labels, &boundary, &out->stats.relabeled));
    BRIO_TRY(brio_extract_faces(r->ctx, &r->labels, r->options->method != BRIO_SURFACE_TIGHT_COCONE, &boundary,
                                &out->faces, &out->num_faces));
    BRIO_REQUIRE(r->ctx, out->num_faces > 0, BRIO_BECAUSE(r->ctx, NO_INSIDE, BRIO_ERR_NO_ANSWER), "no inside found");
    lap(r, &out->stats.manifold_seconds);
done:
    brio_release(r->ctx, boundary.facet);
    return status;
}

/* Tells how the surface came to be. An experiment's has no labels. */
static brio_status explain(reconstruction *r) {
    const brio_explained s = {.options = r->options,
                              .delaunay = r->delaunay,
                              .dual = &r->dual,
                              .points = r->points,
                              .num_points = r->num_points,
                              .num_samples = r->num_points,
                              .order = r->evidence->order,
                              .exponent = r->evidence->exponent,
                              .theta = r->options->theta,
                              .label = r->labels.label,
                              .faces = r->out->faces,
                              .num_faces = r->out->num_faces};
    return brio_explain(r->ctx, &s);
}

static brio_status find_density(reconstruction *r) {
    brio_status status = BRIO_OK;
    if (r->options->density) BRIO_TRY(brio_feature_sizes(r->ctx, &r->dual, &r->out->size));
    lap(r, &r->out->stats.density_seconds);
done:
    return status;
}

static void release(reconstruction *r) {
    brio_tet_labels_free(r->ctx, &r->labels);
    brio_release(r->ctx, r->turned);
    brio_cocones_free(r->ctx, &r->cocones);
    brio_pole_vectors_free(r->ctx, &r->dual);
    brio_triangulation_free(r->delaunay);
}

brio_status brio_cocone_surface_find(brio_context *ctx, const double *points, size_t num_points,
                                     const brio_surface_options *options, const brio_sample_evidence *evidence,
                                     brio_cocone_surface *out) {
    brio_status status = BRIO_OK;
    reconstruction r = {.ctx = ctx,
                        .options = options,
                        .evidence = evidence,
                        .points = points,
                        .num_points = num_points,
                        .out = out,
                        .lap = brio_seconds()};
    const struct brio_extraction_part *part = BRIO_PART(ctx, extraction);
    const brio_bar bar = brio_progress_bar(ctx);
    *out = (brio_cocone_surface){0};
    brio_progress_part(ctx, bar, 0, 0.5);
    BRIO_TRY(triangulate(&r));
    brio_progress_part(ctx, bar, 0.5, 0.65);
    BRIO_TRY(find_candidates(&r));
    brio_progress_part(ctx, bar, 0.65, 0.8);
    if (!part) BRIO_TRY(label(&r));
    brio_progress_part(ctx, bar, 0.8, 1);
    BRIO_TRY(part ? extract_as(&r, part) : extract(&r));
    BRIO_TRY(find_density(&r));
    if (options->explanation) BRIO_TRY(explain(&r));
done:
    brio_progress_part(ctx, bar, 0, 1);
    release(&r);
    return status;
}

void brio_cocone_surface_free(brio_context *ctx, brio_cocone_surface *surface) {
    brio_release(ctx, surface->faces);
    brio_release(ctx, surface->boundary);
    brio_release(ctx, surface->size);
    brio_release(ctx, surface->distinct);
}
