/* The Voronoi or power diagram of points in the plane, as the dual of their triangulation.
 *
 * A triangle is dual to the centre of its circle. Triangles with one circle, decided exactly, are one vertex:
 * neighbours are joined where the in-circle test is 0, and a class has the number of its first triangle. The region of
 * a point is the sequence of the classes of the triangles at it, counterclockwise.
 *
 * Based on: Aurenhammer. Power diagrams: properties, algorithms and applications. SIAM J. Computing 1987. */
#include "base/float_state.h"
#include "base/memory.h"
#include "plane/plane_centre.h"
#include "plane/plane_points.h"
#include "plane/plane_walk.h"
#include <assert.h>

typedef struct {
    brio_context *ctx;
    const brio_triangle *triangle;
    size_t count, hull; /* of finite triangles; of hull edges */
    size_t num_points;
    brio_plane_record *record;
    brio_plane_filter filter;
    uint32_t *corner; /* of each point that is a vertex: a triangle; BRIO_NO_TRIANGLE for other points */
    brio_diagram2 *out;
} dual;

/* --- vertices --- */

static uint32_t find_root(uint32_t *parent, uint32_t t) {
    assert(parent[t] <= t); /* the root is the least */
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
}

static bool have_one_circle(dual *d, uint32_t t, uint32_t mate) {
    const uint32_t *v = d->triangle[t].vertex;
    uint32_t other = d->triangle[brio_triangle_of(mate)].vertex[brio_edge_slot(mate)];
    const brio_plane_record *r = d->record;
    return brio_incircle_sign(&d->filter, r[v[0]], r[v[1]], r[v[2]], r[other], d->filter.general) == 0;
}

/* Numbers the classes of triangles of one circle in the order of their first triangles. */
static void number_circles(dual *d) {
    uint32_t *class = d->out->triangle_vertex, classes = 0;
    for (uint32_t t = 0; t < d->count; t++) class[t] = t;
    for (uint32_t t = 0; t < d->count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t mate = d->triangle[t].mate[i], other = brio_triangle_of(mate);
            if (other >= d->count || other < t || !have_one_circle(d, t, mate)) continue;
            uint32_t a = find_root(class, t), b = find_root(class, other);
            assert(a <= t && b <= other);
            class[a > b ? a : b] = a < b ? a : b; /* the root is the first triangle */
        }
    for (uint32_t t = 0; t < d->count; t++) class[t] = find_root(class, t);
    for (uint32_t t = 0; t < d->count; t++) class[t] = class[t] == t ? classes++ : class[class[t]];
    assert(classes <= d->count);
    d->out->num_vertices = classes;
}

/* Writes the centres of the first triangles of the classes. */
static void write_vertices(dual *d) {
    brio_plane_circles batch; /* no initializer, which would clear all of it */
    double centre[BRIO_CENTRE_BATCH][3];
    size_t written = 0, added = 0;
    batch.count = 0;
    for (size_t t = 0; t < d->count; t++) {
        const uint32_t *v = d->triangle[t].vertex;
        if (d->out->triangle_vertex[t] != added) continue;
        brio_plane_circles_add(&batch, d->record[v[0]], d->record[v[1]], d->record[v[2]]);
        if (++added < d->out->num_vertices && batch.count < BRIO_CENTRE_BATCH) continue;
        brio_plane_circles_solve(&batch, d->filter.general, centre);
        for (size_t i = 0; written < added; i++, written++)
            for (size_t k = 0; k < 2; k++) d->out->vertices[2 * written + k] = centre[i][k];
    }
}

static brio_status find_vertices(dual *d) {
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->out->triangle_vertex, d->count));
    number_circles(d);
    BRIO_FORWARD(brio_progress(d->ctx, "voronoi", 0.5));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->out->vertices, 2 * d->out->num_vertices));
    write_vertices(d);
    return BRIO_OK;
}

/* --- regions --- */

static uint32_t slot_of(const brio_triangle *t, uint32_t vertex) {
    assert(t->vertex[0] == vertex || t->vertex[1] == vertex || t->vertex[2] == vertex);
    return t->vertex[0] == vertex ? 0 : t->vertex[1] == vertex ? 1 : 2;
}

/* Returns the triangle before t, clockwise round a vertex of both, or the one after it. */
static uint32_t beside(const dual *d, uint32_t t, uint32_t vertex, bool after) {
    uint32_t i = slot_of(&d->triangle[t], vertex);
    return brio_triangle_of(d->triangle[t].mate[after ? brio_slot_after(i) : brio_slot_before(i)]);
}

/* Returns the triangle where the region of a vertex begins: the first one counterclockwise from the hull, or t
 * inside. */
static uint32_t first_round(const dual *d, uint32_t t, uint32_t vertex) {
    for (uint32_t at = t;;) {
        uint32_t before = beside(d, at, vertex, false);
        if (before >= d->count) return at;
        if (before == t) return t;
        at = before;
    }
}

/* Writes the region of a vertex of triangle t. Returns the number of its items. */
static size_t write_region(const dual *d, uint32_t t, uint32_t vertex, uint32_t *out) {
    const uint32_t *class = d->out->triangle_vertex;
    uint32_t first = first_round(d, t, vertex), at = first;
    size_t n = 0;
    if (beside(d, first, vertex, false) >= d->count) out[n++] = BRIO_INFINITE;
    do {
        if (!n || out[n - 1] != class[at]) out[n++] = class[at];
        at = beside(d, at, vertex, true);
    } while (at < d->count && at != first);
    return n > 1 && out[0] == out[n - 1] ? n - 1 : n;
}

static brio_status find_regions(dual *d) {
    brio_diagram2 *out = d->out;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->corner, d->num_points));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, out->offsets, d->num_points + 1));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, out->items, 3 * d->count + d->hull));
    for (size_t p = 0; p < d->num_points; p++) d->corner[p] = BRIO_NO_TRIANGLE;
    for (uint32_t t = 0; t < d->count; t++)
        for (int i = 0; i < 3; i++) d->corner[d->triangle[t].vertex[i]] = t;
    out->offsets[0] = 0;
    for (size_t p = 0; p < d->num_points; p++) {
        uint64_t begin = out->offsets[p];
        bool owns = d->corner[p] != BRIO_NO_TRIANGLE;
        out->offsets[p + 1] = begin + (owns ? write_region(d, d->corner[p], (uint32_t)p, out->items + begin) : 0);
    }
    assert(out->offsets[d->num_points] <= 3 * d->count + d->hull);
    return BRIO_RESIZE(d->ctx, out->items, out->offsets[d->num_points]);
}

/* --- the object --- */

static brio_status fill(dual *d) {
    BRIO_FORWARD(brio_progress(d->ctx, "voronoi", 0));
    BRIO_FORWARD(find_vertices(d));
    BRIO_FORWARD(find_regions(d));
    return brio_progress(d->ctx, "voronoi", 1);
}

static brio_status diagram_new(brio_context *ctx, const brio_triangulation2 *t, brio_diagram2 **out) {
    brio_status status = BRIO_ALLOC_ZERO(ctx, *out, 1);
    if (status != BRIO_OK) return status;
    **out = (brio_diagram2){
        .size = sizeof **out, .num_triangles = t->stats.triangles, .num_points = t->stats.points, .context = ctx};
    return BRIO_OK;
}

brio_status brio_voronoi2(brio_context *ctx, const brio_triangulation2 *t, const double *points, const double *weights,
                          size_t num_points, brio_diagram2 **out) {
    BRIO_DOOR;
    brio_plane_input given = {points, weights, num_points, 2, {0, 1, 2}, 0, NULL};
    dual d = {.ctx = ctx, .triangle = t->triangle, .num_points = num_points};
    brio_status status = BRIO_OK;
    *out = NULL;
    d.count = t->stats.triangles, d.hull = t->stats.hull_edges;
    BRIO_TRY(brio_plane_take_points(ctx, t, &given, &d.record));
    brio_plane_input_key(&given, &d.filter);
    brio_plane_filter_for(&d.filter, (const brio_plane_record *)d.record, num_points, weights != NULL);
    BRIO_TRY(diagram_new(ctx, t, &d.out));
    BRIO_TRY(fill(&d));
    *out = d.out;
    d.out = NULL;
done:
    brio_diagram2_free(d.out);
    brio_release(ctx, d.record);
    brio_release(ctx, d.corner);
    return status;
}

void brio_diagram2_free(brio_diagram2 *diagram) {
    if (!diagram) return;
    brio_context *ctx = diagram->context;
    brio_release(ctx, diagram->vertices);
    brio_release(ctx, diagram->triangle_vertex);
    brio_release(ctx, diagram->offsets);
    brio_release(ctx, diagram->items);
    brio_release(ctx, diagram);
}
