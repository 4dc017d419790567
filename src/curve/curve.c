/* Curves through points of a plane: polylines with corners and ends.
 *
 *   points -> coordinates in their plane -> canonical order -> Delaunay edges (edges.c) -> links, which both ends wish
 *   (links.c) -> gaps taken out (gaps.c) -> chains and corners (chains.c) -> a mesh of edges
 *
 * Links are Delaunay edges, so no two cross. A point has two links at most, so curves do not branch.
 *
 * Based on: Dey, Wenger. Fast reconstruction of curves with sharp corners. IJCGA 2002.
 *           Amenta, Bern, Eppstein. The crust and the beta-skeleton. GMIP 1998.
 * Differs from the papers: links.c and gaps.c say how. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "curve/samples_mesh.h"
#include "curve/work.h"
#include <math.h>

/* From this share of fat links on the points lie on an area and not on curves. Measured: none along curves, 12 to 50 %
 * of points at random or on a shaken grid. */
static const double MOST_FAT = 0.1;

/* --- the result --- */

typedef struct {
    brio_context *ctx;
    const double *points;
    size_t num_points;
    const uint32_t *order; /* the point of each row */
    const brio_curve_work *work;
    const brio_curve_chains *chains;
} result;

/* Marks the points that are vertices. Rows at the position of another one have no edges; where no row has, all are at
 * one position. */
static void mark_vertices(const result *r, uint32_t *vertex) {
    const uint32_t *start = r->work->start;
    for (size_t p = 0; p < r->num_points; p++)
        vertex[r->order[p]] = start[p + 1] > start[p] || (p == 0 && !start[r->num_points]) ? 0 : BRIO_INFINITE;
}

/* Writes the edges along the curves, and what vertices are told of their curves. */
static void write_chains(const result *r, const uint32_t *vertex, uint32_t *edges, int32_t *curve, uint8_t *corner) {
    const brio_curve_chains *c = r->chains;
    size_t place = 0;
    for (size_t i = 0; i < c->num_curves; i++)
        for (uint32_t k = c->begin[i]; k < c->begin[i + 1]; k++) {
            uint32_t v = vertex[r->order[c->row[k]]];
            curve[v] = (int32_t)i;
            corner[v] = c->corner[k];
            if (k + 1 == c->begin[i + 1] && !c->closed[i]) continue;
            uint32_t next = k + 1 < c->begin[i + 1] ? k + 1 : c->begin[i];
            edges[place++] = v;
            edges[place++] = vertex[r->order[c->row[next]]];
        }
}

static brio_status make_mesh(const result *r, brio_mesh **out) {
    brio_context *ctx = r->ctx;
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    uint32_t *vertex = NULL, *edges = NULL;
    void *curve, *corner;
    BRIO_TRY(BRIO_ALLOC(ctx, vertex, r->num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, edges, 2 * r->work->num_links));
    mark_vertices(r, vertex);
    BRIO_TRY(brio_samples_mesh(ctx, r->points, r->num_points, vertex, &mesh));
    BRIO_TRY(brio_mesh_add_property(mesh, "curve", BRIO_SCALAR_INT32, &curve));
    BRIO_TRY(brio_mesh_add_property(mesh, "corner", BRIO_SCALAR_UINT8, &corner));
    for (size_t v = 0; v < mesh->num_vertices; v++) ((int32_t *)curve)[v] = -1;
    write_chains(r, vertex, edges, curve, corner);
    BRIO_TRY(brio_mesh_set_edges(mesh, edges, r->work->num_links));
    *out = mesh;
    mesh = NULL;
done:
    brio_mesh_free(mesh);
    brio_release(ctx, vertex);
    brio_release(ctx, edges);
    return status;
}

/* --- the interface --- */

static brio_status refuse_area(const brio_curve_work *w, size_t *fat) {
    *fat = brio_curve_count_fat(w);
    BRIO_EXPECT(w->ctx, (double)*fat <= MOST_FAT * (double)w->num_links, BRIO_ERR_NO_ANSWER,
                "the points lie on an area, not on curves: %zu of %zu edges that would link them have points nearly as "
                "near on either side",
                *fat, w->num_links);
    return BRIO_OK;
}

static brio_status link_all(brio_curve_work *w, const brio_curve_options *o) {
    brio_status status = BRIO_OK;
    uint32_t *rows = NULL;
    BRIO_TRY(BRIO_ALLOC(w->ctx, rows, w->num_rows));
    for (size_t p = 0; p < w->num_rows; p++) rows[p] = (uint32_t)p;
    BRIO_TRY(brio_curve_link(w, rows, w->num_rows));
    if (!o->closed) BRIO_TRY(brio_curve_find_gaps(w, o->open));
done:
    brio_release(w->ctx, rows);
    return status;
}

static void count_curves(const brio_curve_work *w, const brio_curve_chains *c, const brio_mesh *mesh,
                         brio_curve_stats *s) {
    s->samples = mesh->num_vertices;
    s->edges = w->num_links;
    s->gaps = w->num_gaps;
    s->curves = c->num_curves;
    s->corners = c->num_corners;
    for (size_t i = 0; i < c->num_curves; i++) s->closed += c->closed[i];
    s->ends = 2 * (s->curves - s->closed);
    s->isolated = mesh->num_vertices - (c->num_curves ? c->begin[c->num_curves] : 0);
}

brio_status brio_curve(brio_context *ctx, const double *points, size_t num_points, const brio_curve_options *options,
                       brio_mesh **out, brio_curve_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_curve_options o = {0};
    brio_curve_stats mine = {.points = num_points};
    brio_flat_points flat = {.frame = {0}};
    brio_curve_work w = {.ctx = ctx, .num_rows = num_points};
    brio_curve_chains chains = {0};
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_curve_options, options, &o));
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_curve_stats, stats));
    BRIO_REQUIRE(ctx, o.open >= 0 && (o.open == 0 || o.open >= 1), BRIO_ERR_ARGUMENT,
                 "open is %g; it is 0, or 1 or more", o.open);
    double start = brio_seconds();
    BRIO_TRY(brio_flat_points_take(ctx, points, num_points, &flat));
    w.at = (const double(*)[2])flat.at;
    BRIO_TRY(brio_curve_edges(&w));
    mine.delaunay_seconds = brio_seconds() - start;
    BRIO_TRY(link_all(&w, &o));
    BRIO_TRY(refuse_area(&w, &mine.fat));
    BRIO_TRY(brio_curve_trace(&w, &chains));
    BRIO_TRY(make_mesh(&(result){ctx, points, num_points, flat.order, &w, &chains}, out));
    count_curves(&w, &chains, *out, &mine);
    mine.thickness = ldexp(flat.frame.thickness, flat.exponent);
    mine.curve_seconds = brio_seconds() - start - mine.delaunay_seconds;
    BRIO_GIVE(brio_curve_stats, stats, &mine);
done:
    brio_curve_work_free(&w);
    brio_curve_chains_free(ctx, &chains);
    brio_flat_points_free(ctx, &flat);
    return status;
}
