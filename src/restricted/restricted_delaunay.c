/* The restricted Delaunay triangulation of samples on a known surface, and the closed-ball property.
 *
 *   samples -> Delaunay triangulation -> surface cut by the Voronoi cells (cut.c) -> triangles, one for each Voronoi
 *   edge that meets the surface -> which cells, facets and edges meet it in closed balls (closed_ball.c)
 *
 * If all do, the triangles are homeomorphic to the surface. Everything is decided by exact signs. Ties are broken in
 * two stages: the surface is translated by an infinitely small vector, and the samples' triangulation is the perturbed
 * one of brio_delaunay, whose perturbation counts as smaller still. The surface may cross itself: the cells cut it as
 * it is connected, and the triangles are then homeomorphic to it as a mesh.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 2.7.
 *           Edelsbrunner, Shah. Triangulating topological spaces. IJCGA 1997. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "restricted/work.h"
#include <string.h>

/* Refuses what is no closed manifold of triangles. */
static brio_status check_surface(brio_context *ctx, const brio_mesh *surface) {
    brio_status status = BRIO_OK;
    brio_certificate c = {.size = sizeof c};
    BRIO_TRY(brio_refuse_vertices(ctx, surface->vertices, surface->num_vertices, "the surface"));
    for (size_t f = 0; f < surface->num_faces; f++)
        BRIO_REQUIRE(ctx, surface->face_offsets[f] == 3 * f && surface->face_offsets[f + 1] == 3 * f + 3,
                     BRIO_ERR_ARGUMENT, "face %zu of the surface has %d corners; all faces must be triangles", f,
                     (int)(surface->face_offsets[f + 1] - surface->face_offsets[f]));
    BRIO_TRY(brio_mesh_certificate(ctx, surface, &c));
    BRIO_REQUIRE(
        ctx, c.closed && c.manifold, BRIO_BECAUSE(ctx, NOT_CLOSED, BRIO_ERR_ARGUMENT),
        "the surface is no closed manifold: %zu faces, %zu boundary edges, %zu edges of more than two faces, %zu "
        "vertices where more than one sheet meets",
        surface->num_faces, c.boundary_edges, c.nonmanifold_edges, c.nonmanifold_vertices);
done:
    brio_certificate_free(&c);
    return status;
}

static brio_status begin(brio_restriction *r, const brio_triangulation *t) {
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    BRIO_EXPECT(
        r->ctx, s->dimension == 3, BRIO_ERR_NO_ANSWER,
        "the samples have dimension %d: they have no tetrahedra, whose spheres the surface could be held against",
        s->dimension);
    r->tet = brio_triangulation_tetrahedra(t);
    r->first_sample = r->tet[0].vertex[0];
    BRIO_FORWARD(brio_triangulation_incident_tetrahedra(r->ctx, t, &r->tets));
    return brio_triangulation_neighbours(r->ctx, t, &r->neighbours);
}

static void end(brio_restriction *r) {
    brio_incidences_free(&r->tets);
    brio_incidences_free(&r->neighbours);
    brio_release(r->ctx, r->end);
    brio_release(r->ctx, r->side);
    brio_release(r->ctx, r->edge_of);
    brio_release(r->ctx, r->cell);
    brio_release(r->ctx, r->first);
    brio_release(r->ctx, r->met);
    brio_release(r->ctx, r->crossing);
    brio_release(r->ctx, r->piece);
}

/* Makes the triangles of the crossings, which are sorted, each once, seen from the side of the face that is met
 * first. */
static brio_status make_mesh(const brio_restriction *r, size_t num_points, const uint8_t *bad, brio_mesh **out) {
    brio_context *ctx = r->ctx;
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    uint64_t *offsets = NULL;
    uint32_t *corners = NULL;
    void *good;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, offsets, r->num_crossings + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, corners, 3 * r->num_crossings));
    offsets[0] = 0;
    for (size_t i = 0; i < r->num_crossings; i++) {
        const brio_crossing *c = &r->crossing[i];
        if (i > 0 && !memcmp(c->sample, c[-1].sample, sizeof c->sample)) continue;
        for (int k = 0; k < 3; k++) corners[3 * count + (size_t)k] = c->sample[c->sign > 0 || k == 0 ? k : 3 - k];
        count++;
        offsets[count] = 3 * (uint64_t)count;
    }
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(brio_mesh_set_vertices(mesh, r->points, num_points));
    BRIO_TRY(brio_mesh_set_faces(mesh, offsets, corners, count));
    BRIO_TRY(brio_mesh_add_property(mesh, "closed_ball", BRIO_SCALAR_UINT8, &good));
    for (size_t p = 0; p < num_points; p++) ((uint8_t *)good)[p] = !bad[p];
    *out = mesh;
    mesh = NULL;
done:
    brio_mesh_free(mesh);
    brio_release(ctx, offsets);
    brio_release(ctx, corners);
    return status;
}

static void fill_stats(const brio_restriction *r, const brio_ball_counts *n, brio_restricted_stats *stats) {
    stats->cells = n->cells, stats->facets = n->facets, stats->edges = n->edges;
    stats->bad_cells = n->bad_cells, stats->bad_facets = n->bad_facets, stats->bad_edges = n->bad_edges;
    stats->crossings = r->num_crossings;
    stats->closed_ball = !n->bad_cells && !n->bad_facets && !n->bad_edges;
    stats->exact_calls = r->counts.exact;
    stats->ties = r->counts.ties;
}

brio_status brio_restricted_delaunay(brio_context *ctx, const double *points, size_t num_points,
                                     const brio_mesh *surface, brio_mesh **out, brio_restricted_stats *stats) {
    BRIO_DOOR;
    brio_restriction r = {.ctx = ctx, .points = points, .surface = surface};
    brio_restricted_stats mine = {.size = sizeof mine};
    brio_ball_counts balls;
    brio_triangulation *t = NULL;
    uint8_t *bad = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_restricted_stats, stats));
    BRIO_TRY(check_surface(ctx, surface));
    double start = brio_seconds();
    BRIO_TRY(brio_delaunay(ctx, points, NULL, num_points, NULL, &t));
    BRIO_TRY(begin(&r, t));
    mine.delaunay_seconds = brio_seconds() - start;
    BRIO_TRY(brio_restriction_edges(&r));
    BRIO_TRY(brio_restriction_cut(&r));
    BRIO_TRY(brio_restriction_sort(&r));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, bad, num_points));
    BRIO_TRY(brio_restriction_balls(&r, &balls, bad));
    fill_stats(&r, &balls, &mine);
    BRIO_TRY(make_mesh(&r, num_points, bad, out));
    mine.cut_seconds = brio_seconds() - start - mine.delaunay_seconds;
    BRIO_GIVE(brio_restricted_stats, stats, &mine);
done:
    end(&r);
    brio_triangulation_free(t);
    brio_release(ctx, bad);
    return status;
}
