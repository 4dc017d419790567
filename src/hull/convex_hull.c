/* The convex hull of a point set as a mesh.
 *
 *   1. Points that are certainly inside are skipped (interior.c).
 *   2. The candidates, copied in an insertion order, by default a biased randomized one, are inserted one by one
 *      (polytope.c). Hulls so flat that doubles hold no point inside come from the Delaunay triangulation
 *      (delaunay_polytope.c).
 *   3. Triangles of one plane become one polygon between strictly extreme points (hull_faces.c). So the result depends
 *      on the points only, and not on the way to it.
 *   4. Polygons are cut into fans of triangles, unless the caller wants polygons.
 *
 * Based on: Clarkson, Shor. Applications of random sampling in computational geometry, II. DCG 1989.
 *           Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/versioned.h"
#include "hull/hull_faces.h"
#include "hull/interior.h"
#include "order/canonical_points.h"
#include "order/order.h"
#include <assert.h>
#include <string.h>

typedef struct {
    brio_context *ctx;
    const double *points;
    size_t num_points;
    uint32_t *index;           /* of the candidates, ascending, in the end of the records */
    brio_hull_records records; /* the candidates in the order of insertion */
    brio_hull_polygons faces;  /* corners are records, in the end vertices of the mesh */
    brio_convex_hull_stats stats;
    double lap;
    brio_convex_hull_options options;
} hull;

static void lap(hull *h, double *seconds) {
    double now = brio_seconds();
    *seconds += now - h->lap;
    h->lap = now;
}

/* Copies the candidates in the order of insertion. They were finite when the call began, but another thread of
 * the caller may have written to them since; from here on the hull is that of the copies. */
static brio_status take_records(hull *h, size_t n) {
    brio_status status = BRIO_OK;
    double *rows = NULL;
    uint32_t *order = NULL;
    const brio_delaunay_options o = {
        .order = h->options.order, .round_ratio = h->options.round_ratio, .seed = h->options.seed};
    BRIO_TRY(BRIO_ALLOC(h->ctx, rows, 3 * n));
    BRIO_TRY(BRIO_ALLOC(h->ctx, order, n));
    BRIO_TRY(BRIO_ALLOC(h->ctx, h->records.record, n + 1));
    brio_copy_points(h->points, h->index, n, rows);
    BRIO_REQUIRE(h->ctx, brio_all_finite(rows, 3 * n), BRIO_ERR_NOT_FINITE,
                 "the points changed during the call, to numbers that are not finite");
    BRIO_TRY(brio_order_points(h->ctx, &(brio_input){rows, NULL, n}, &o, order, NULL, NULL, NULL));
    for (size_t r = 0; r < n; r++) {
        const double *p = rows + 3 * (size_t)order[r];
        for (int k = 0; k < 3; k++) h->records.record[r][k] = p[k] + 0.0; /* no -0 */
        h->records.record[r][3] = 0;
        order[r] = h->index[order[r]];
    }
    memcpy(h->index, order, n * sizeof *order);
    h->records.index = h->index;
    h->records.count = n;
done:
    brio_release(h->ctx, rows);
    brio_release(h->ctx, order);
    return status;
}

static brio_status wrap_solid(hull *h, const uint32_t corner[4]) {
    brio_status status = BRIO_OK;
    brio_polytope p = {0};
    BRIO_TRY(brio_polytope_build(h->ctx, &h->records, corner, h->options.seed, &p));
    h->stats.created = p.created;
    h->stats.destroyed = p.destroyed;
    h->stats.walk_steps = p.walk_steps;
    h->stats.beyond_calls = p.beyond_calls;
    h->stats.exact_calls = p.exact_calls;
    if (p.count == 0) {
        brio_polytope_free(h->ctx, &p);
        BRIO_TRY(brio_polytope_by_delaunay(h->ctx, &h->records, &p));
    }
    BRIO_TRY(brio_hull_faces(h->ctx, &p, &h->records, &h->faces));
done:
    brio_polytope_free(h->ctx, &p);
    return status;
}

static brio_status find_faces(hull *h) {
    brio_status status = BRIO_OK;
    brio_filter filter;
    uint32_t corner[4];
    const brio_bar bar = brio_progress_bar(h->ctx);
    brio_progress_part(h->ctx, bar, 0, 0.1);
    BRIO_TRY(brio_hull_candidates(h->ctx, h->points, h->num_points, &h->index, &h->stats.candidates));
    lap(h, &h->stats.skip_seconds);
    brio_progress_part(h->ctx, bar, 0.1, 1);
    BRIO_TRY(take_records(h, h->stats.candidates));
    const double(*record)[4] = (const double(*)[4])h->records.record;
    brio_filter_for(&filter, record, h->records.count, false);
    int dimension = h->stats.dimension = brio_general_position(&filter, record, h->records.count, corner);
    if (dimension == 3)
        BRIO_TRY(wrap_solid(h, corner));
    else
        BRIO_TRY(brio_flat_hull(h->ctx, &h->records, dimension, corner, &h->faces));
    h->stats.facets = dimension >= 2 ? h->faces.count : 0;
    lap(h, &h->stats.hull_seconds);
done:
    brio_progress_part(h->ctx, bar, 0, 1);
    return status;
}

/* Numbers the corners by ascending index of the caller, and makes them the vertices of the mesh.
 * samples  NULL, or receives for each vertex the index of its point. */
static brio_status place_vertices(hull *h, brio_mesh *mesh, uint32_t *samples) {
    brio_status status = BRIO_OK;
    uint32_t *vertex = NULL, used = 0;
    uint64_t corners = h->faces.first[h->faces.count];
    BRIO_TRY(BRIO_ALLOC_ZERO(h->ctx, vertex, h->num_points));
    for (uint64_t c = 0; c < corners; c++) vertex[h->index[h->faces.corner[c]]] = 1;
    for (size_t p = 0; p < h->num_points; p++) h->stats.vertices += vertex[p];
    BRIO_TRY(brio_mesh_set_vertices(mesh, NULL, h->stats.vertices));
    for (size_t p = 0; p < h->num_points; p++) {
        BRIO_TRY(brio_look(h->ctx, 1));
        if (!vertex[p]) continue;
        memcpy(mesh->vertices + 3 * (size_t)used, h->points + 3 * p, 3 * sizeof *mesh->vertices);
        if (samples) samples[used] = (uint32_t)p;
        vertex[p] = used++;
    }
    assert(used == h->stats.vertices);
    for (uint64_t c = 0; c < corners; c++) h->faces.corner[c] = vertex[h->index[h->faces.corner[c]]];
done:
    brio_release(h->ctx, vertex);
    return status;
}

/* Sorts the faces by their first two vertices, which no two faces share. */
static brio_status sort_faces(hull *h, uint32_t *order) {
    brio_status status = BRIO_OK;
    uint64_t *key = NULL;
    const brio_hull_polygons *f = &h->faces;
    BRIO_TRY(BRIO_ALLOC(h->ctx, key, f->count));
    for (uint32_t i = 0; i < f->count; i++) {
        const uint32_t *corner = f->corner + f->first[i];
        key[i] = (uint64_t)corner[0] << 32 | corner[1];
        order[i] = i;
    }
    BRIO_TRY(brio_radix_sort(h->ctx, key, order, f->count, 64));
done:
    brio_release(h->ctx, key);
    return status;
}

/* Writes a polygon, or its fan of triangles, to *corner and the offsets behind *offset; moves both on. */
static void put_face(const uint32_t *v, size_t size, bool whole, uint64_t **offset, uint32_t **corner) {
    for (size_t i = 2; i < size && !whole; i++) {
        const uint32_t triangle[3] = {v[0], v[i - 1], v[i]};
        memcpy(*corner, triangle, sizeof triangle);
        *corner += 3;
        (*offset)[1] = (*offset)[0] + 3;
        ++*offset;
    }
    if (!whole) return;
    memcpy(*corner, v, size * sizeof *v);
    *corner += size;
    (*offset)[1] = (*offset)[0] + size;
    ++*offset;
}

static brio_status put_faces(hull *h, bool whole, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    const brio_hull_polygons *f = &h->faces;
    uint32_t *order = NULL;
    size_t corners = f->first[f->count], triangles = corners - 2 * f->count;
    BRIO_TRY(BRIO_ALLOC(h->ctx, order, f->count));
    BRIO_TRY(sort_faces(h, order));
    mesh->num_faces = whole ? f->count : triangles;
    BRIO_TRY(BRIO_ALLOC(h->ctx, mesh->face_offsets, mesh->num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(h->ctx, mesh->face_vertices, whole ? corners : 3 * triangles));
    uint64_t *offset = mesh->face_offsets;
    uint32_t *corner = mesh->face_vertices;
    *offset = 0;
    for (size_t i = 0; i < f->count; i++) {
        uint64_t from = f->first[order[i]];
        put_face(f->corner + from, f->first[order[i] + 1] - from, whole, &offset, &corner);
    }
    assert(offset == mesh->face_offsets + mesh->num_faces && *offset == (size_t)(corner - mesh->face_vertices));
done:
    brio_release(h->ctx, order);
    return status;
}

static brio_status make_mesh(hull *h, const brio_convex_hull_options *o, brio_mesh *mesh) {
    if (h->stats.dimension < 0) return BRIO_OK;
    BRIO_FORWARD(place_vertices(h, mesh, o->samples));
    if (h->stats.dimension >= 2)
        BRIO_FORWARD(put_faces(h, o->polygons, mesh));
    else if (h->stats.dimension == 1)
        BRIO_FORWARD(brio_mesh_set_edges(mesh, h->faces.corner, 1));
    lap(h, &h->stats.mesh_seconds);
    return BRIO_OK;
}

brio_status brio_convex_hull(brio_context *ctx, const double *points, size_t num_points,
                             const brio_convex_hull_options *options, brio_mesh **out, brio_convex_hull_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_convex_hull_options o = {0};
    hull h = {.ctx = ctx, .points = points, .num_points = num_points, .lap = brio_seconds()};
    brio_mesh *mesh = NULL;
    *out = NULL;
    h.stats.points = num_points;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_convex_hull_stats, stats));
    BRIO_TRY(BRIO_TAKE(ctx, brio_convex_hull_options, options, &o));
    BRIO_REQUIRE(ctx, o.round_ratio >= 0 && o.round_ratio < 1, BRIO_ERR_ARGUMENT,
                 "round ratio %g is not between 0 and 1", o.round_ratio);
    BRIO_REQUIRE(ctx, (unsigned)o.order < BRIO_ORDER_END, BRIO_ERR_ARGUMENT, "no insertion order %d", (int)o.order);
    BRIO_TRY(brio_refuse_points(ctx, points, num_points));
    if (!o.seed) o.seed = BRIO_SEED;
    h.options = o;
    BRIO_TRY(find_faces(&h));
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(make_mesh(&h, &o, mesh));
    *out = mesh;
    mesh = NULL;
done:
    BRIO_GIVE(brio_convex_hull_stats, stats, &h.stats);
    brio_mesh_free(mesh);
    brio_hull_polygons_free(ctx, &h.faces);
    brio_release(ctx, h.records.record);
    brio_release(ctx, h.index);
    return status;
}
