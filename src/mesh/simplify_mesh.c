/* Simplification of a mesh as a whole: one tolerance everywhere, edges of any length. See simplify.c for the collapses.
 *
 * Products of seven lengths, as the quadrics' solutions have them, would overflow or vanish with coordinates beyond
 * 2^HUGE or below 2^-HUGE: such meshes are scaled meanwhile. */
#include "base/context.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/versioned.h"
#include "mesh/cut_polygon.h"
#include "mesh/edge_rings.h"
#include "mesh/properties.h"
#include "mesh/simplify.h"
#include "mesh/split_vertices.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- any mesh --- */

/* Any mesh made fit for the collapse of edges, and put together again.
 *
 * Edges collapse on manifold, oriented meshes of triangles. Other meshes are taken apart where they are not: the parts
 * meet at boundaries, and vertices of boundaries stay where they are. So the parts fit together afterwards, and what
 * was joined at a vertex or an edge still is. */

static const uint32_t NONE = UINT32_MAX;

/* --- triangles --- */

typedef struct {
    brio_context *ctx;
    const brio_mesh *mesh;
    uint32_t (*triangles)[3];
    uint32_t *face; /* of each triangle, the polygon that it is part of */
    size_t count, capacity, face_capacity;
} cutting;

static brio_status add_triangle(cutting *c, const uint32_t corners[3], size_t face) {
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->triangles, c->capacity, c->count + 1));
    BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->face, c->face_capacity, c->count + 1));
    memcpy(c->triangles[c->count], corners, 3 * sizeof *corners);
    c->face[c->count++] = (uint32_t)face;
    return BRIO_OK;
}

static brio_status cut_face(cutting *c, size_t face, uint32_t *room, uint32_t (*parts)[3]) {
    const brio_mesh *m = c->mesh;
    size_t corners = (size_t)(m->face_offsets[face + 1] - m->face_offsets[face]);
    if (corners < 3) return BRIO_OK;
    brio_cut_polygon(m->vertices, m->face_vertices + m->face_offsets[face], corners, room, parts);
    for (size_t i = 0; i + 2 < corners; i++) BRIO_FORWARD(add_triangle(c, parts[i], face));
    return BRIO_OK;
}

static brio_status cut_faces(cutting *c) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = c->mesh;
    uint32_t *room = NULL, (*parts)[3] = NULL;
    size_t most = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        size_t corners = (size_t)(m->face_offsets[f + 1] - m->face_offsets[f]);
        if (corners > most) most = corners;
    }
    BRIO_TRY(BRIO_ALLOC(c->ctx, room, most + 1));
    BRIO_TRY(BRIO_ALLOC(c->ctx, parts, most + 1));
    for (size_t f = 0; f < m->num_faces; f++) BRIO_TRY(cut_face(c, f, room, parts));
done:
    brio_release(c->ctx, room);
    brio_release(c->ctx, parts);
    return status;
}

/* Gives the faces of a mesh, and their properties, to the triangles. */
static brio_status take_triangles(cutting *c, brio_mesh *m) {
    brio_status status = BRIO_OK;
    uint64_t *offsets = NULL;
    char *rows = NULL;
    BRIO_TRY(BRIO_ALLOC(c->ctx, offsets, c->count + 1));
    for (size_t t = 0; t <= c->count; t++) offsets[t] = 3 * t;
    for (size_t i = 0; i < m->num_face_properties; i++) {
        brio_property *p = &m->face_properties[i];
        size_t size = brio_scalar_size(p->type);
        BRIO_TRY(BRIO_ALLOC(c->ctx, rows, c->count * size + 1));
        for (size_t t = 0; t < c->count; t++) memcpy(rows + t * size, (char *)p->data + c->face[t] * size, size);
        brio_release(c->ctx, p->data);
        p->data = rows;
        rows = NULL;
    }
    brio_release(c->ctx, m->face_vertices);
    brio_release(c->ctx, m->face_offsets);
    m->face_vertices = (uint32_t *)(void *)c->triangles;
    m->face_offsets = offsets;
    m->num_faces = c->count;
    c->triangles = NULL;
    offsets = NULL;
done:
    brio_release(c->ctx, offsets);
    return status;
}

/* --- apart and together --- */

/* Cuts polygons into triangles, drops faces without three distinct corners, and gives each fan of faces its own
 * vertices, so that the
 *  mesh is manifold and oriented. Each vertex knows where it comes from by a property that is the last one. Faces keep
 *  their properties. Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY. */
static brio_status mesh_take_apart(brio_context *ctx, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    cutting c = {.ctx = ctx, .mesh = mesh};
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(cut_faces(&c));
    BRIO_TRY(take_triangles(&c, mesh));
    BRIO_TRY(brio_mesh_append_property(mesh, "vertex", BRIO_SCALAR_UINT32));
    uint32_t *origin = mesh->properties[mesh->num_properties - 1].data;
    for (uint32_t v = 0; v < mesh->num_vertices; v++) origin[v] = v;
    BRIO_TRY(brio_mesh_cut_apart(ctx, mesh));
done:
    brio_release(ctx, c.triangles);
    brio_release(ctx, c.face);
    return status;
}

/* Joins vertices that come from one, which are where it was, and removes the last property. */
static brio_status mesh_put_together(brio_context *ctx, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    const uint32_t *origin = mesh->properties[mesh->num_properties - 1].data;
    uint32_t *first = NULL, *number = NULL, most = 0, kept = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++)
        if (origin[v] > most) most = origin[v];
    BRIO_TRY(BRIO_ALLOC(ctx, first, (size_t)most + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, number, mesh->num_vertices));
    for (size_t i = 0; i <= most; i++) first[i] = NONE;
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        uint32_t from = origin[v];
        bool is_new = first[from] == NONE;
        if (is_new) first[from] = kept++;
        number[v] = first[from];
        if (!is_new) continue;
        memmove(mesh->vertices + 3 * (size_t)number[v], mesh->vertices + 3 * v, 3 * sizeof *mesh->vertices);
        brio_properties_move(mesh->properties, mesh->num_properties, v, number[v]);
    }
    mesh->num_vertices = kept;
    for (size_t h = 0; h < 3 * mesh->num_faces; h++) mesh->face_vertices[h] = number[mesh->face_vertices[h]];
    brio_mesh_drop_properties(mesh, mesh->num_properties - 1);
done:
    brio_release(ctx, first);
    brio_release(ctx, number);
    return status;
}

/* --- the choice --- */

enum { HUGE_EXPONENT = 100 };

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
    brio_mesh_simplify_options o = {0};
    BRIO_TRY(BRIO_TAKE(ctx, brio_mesh_simplify_options, options, &o));
    BRIO_REQUIRE(ctx, o.tolerance >= 0 && o.tolerance < INFINITY, BRIO_ERR_ARGUMENT,
                 "a tolerance of %g, expected a finite number, 0 or more", o.tolerance);
    BRIO_REQUIRE(ctx, o.target_faces > 0 || o.tolerance > 0, BRIO_ERR_ARGUMENT,
                 "neither a number of faces nor a tolerance to simplify to");
    BRIO_REQUIRE(ctx, !mesh->num_edges && !mesh->num_tetrahedra, BRIO_ERR_ARGUMENT,
                 "a mesh with tetrahedra, or with edges that no face has: only faces are simplified");
    BRIO_TRY(brio_refuse_not_finite(ctx, mesh->vertices, NULL, mesh->num_vertices, NULL));
    if (o.any) BRIO_TRY(mesh_take_apart(ctx, mesh));
    int exponent = exponent_of(mesh);
    if (exponent) BRIO_TRY(brio_scale(ctx, mesh->vertices, 3 * mesh->num_vertices, -exponent, mesh->vertices));
    status = collapse(ctx, mesh, &o, o.tolerance > 0 ? ldexp(o.tolerance, -exponent) : INFINITY);
    if (exponent) {
        brio_status scaled = brio_scale_vertices(ctx, mesh->vertices, mesh->num_vertices, exponent);
        if (status == BRIO_OK) status = scaled;
    }
    if (o.any && status == BRIO_OK) status = mesh_put_together(ctx, mesh);
done:
    return status;
}
