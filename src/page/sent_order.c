/* The order of vertices and faces on a page: see sent_order.h.
 *
 * Faces: depth first across edges, so that a face mostly shares an edge with one of the last faces. Vertices: as these
 * faces first use them, then the others. Meshes without faces: along a Hilbert curve.
 *
 * The edges that a closed oriented manifold does not have are listed on the way, since both need the rings of edges. */
#include "page/sent_order.h"
#include "base/memory.h"
#include "base/team.h"
#include "mesh/edge_rings.h"
#include "order/curve.h"
#include <assert.h>
#include <string.h>

enum { POINTS_A_THREAD = 1 << 14 }; /* as in src/order */

void brio_sent_order_free(brio_sent_order *o) {
    brio_release(o->ctx, o->vertex);
    brio_release(o->ctx, o->place);
    brio_release(o->ctx, o->face);
    brio_release(o->ctx, o->face_of);
    brio_release(o->ctx, o->boundary);
    brio_release(o->ctx, o->nonmanifold);
    brio_release(o->ctx, o->flipped);
}

/* --- faces --- */

typedef struct {
    brio_sent_order *o;
    const uint32_t *ring;
    uint8_t *seen;   /* #F */
    uint32_t *stack; /* half-edges whose other faces wait */
    size_t depth, capacity;
} walk;

static inline uint32_t face_at(const brio_sent_order *o, uint32_t h) {
    return o->face_of ? o->face_of[h] : h / 3;
}

/* Lists a face that was entered across the edge of half-edge h; the edge before h comes up first. */
static brio_status visit(walk *w, uint32_t h) {
    brio_sent_order *o = w->o;
    uint32_t f = face_at(o, h), g = h;
    size_t corners = (size_t)(o->mesh->face_offsets[f + 1] - o->mesh->face_offsets[f]);
    w->seen[f] = 1;
    o->face[o->num_faces++] = f;
    o->num_triangles += corners - 2;
    BRIO_FORWARD(BRIO_RESERVE(o->ctx, w->stack, w->capacity, w->depth + corners));
    for (size_t i = 0; i < corners; i++, g = brio_sent_next(o, g)) w->stack[w->depth++] = g;
    return brio_look(o->ctx, corners);
}

static brio_status walk_from(walk *w, uint32_t first) {
    BRIO_FORWARD(visit(w, first));
    while (w->depth > 0) {
        uint32_t h = w->stack[--w->depth];
        for (uint32_t g = w->ring[h]; g != h; g = w->ring[g])
            if (!w->seen[face_at(w->o, g)]) BRIO_FORWARD(visit(w, g));
    }
    return BRIO_OK;
}

static brio_status order_faces(brio_sent_order *o, const uint32_t *ring) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = o->mesh;
    walk w = {.o = o, .ring = ring};
    BRIO_TRY(BRIO_ALLOC_ZERO(o->ctx, w.seen, m->num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(o->ctx, o->face, m->num_faces + 1));
    for (size_t f = 0; f < m->num_faces; f++) w.seen[f] = m->face_offsets[f + 1] - m->face_offsets[f] < 3;
    for (size_t f = 0; f < m->num_faces; f++)
        if (!w.seen[f]) BRIO_TRY(walk_from(&w, (uint32_t)m->face_offsets[f]));
done:
    brio_release(o->ctx, w.seen);
    brio_release(o->ctx, w.stack);
    return status;
}

/* --- edges --- */

static brio_status list_edge(brio_sent_order *o, uint32_t **list, size_t *count, size_t *capacity, uint32_t h) {
    BRIO_FORWARD(BRIO_RESERVE(o->ctx, *list, *capacity, *count + 1));
    (*list)[(*count)++] = h;
    return BRIO_OK;
}

static brio_status list_edges(brio_sent_order *o, const uint32_t *ring) {
    const uint32_t *v = o->mesh->face_vertices;
    size_t corners = (size_t)o->mesh->face_offsets[o->mesh->num_faces];
    for (uint32_t h = 0; h < corners; h++) {
        uint32_t g = ring[h];
        BRIO_FORWARD(brio_look(o->ctx, 1));
        if (g > h) continue; /* the last half-edge stands for the edge */
        if (g == h)
            BRIO_FORWARD(list_edge(o, &o->boundary, &o->num_boundary, &o->capacity[0], h));
        else if (ring[g] != h)
            BRIO_FORWARD(list_edge(o, &o->nonmanifold, &o->num_nonmanifold, &o->capacity[1], h));
        else if (v[g] == v[h])
            BRIO_FORWARD(list_edge(o, &o->flipped, &o->num_flipped, &o->capacity[2], h));
    }
    return BRIO_OK;
}

static brio_status find_faces_of_corners(brio_sent_order *o) {
    const uint64_t *offsets = o->mesh->face_offsets;
    size_t f = 0;
    while (f < o->mesh->num_faces && offsets[f + 1] == 3 * (f + 1)) f++;
    if (f == o->mesh->num_faces) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(o->ctx, o->face_of, offsets[o->mesh->num_faces] + 1));
    for (f = 0; f < o->mesh->num_faces; f++)
        for (uint64_t h = offsets[f]; h < offsets[f + 1]; h++) o->face_of[h] = (uint32_t)f;
    return BRIO_OK;
}

/* --- vertices --- */

/* Sorts all vertices along a curve, and takes `most` of them evenly. */
static brio_status order_along_curve(brio_sent_order *o, size_t most) {
    brio_status status = BRIO_OK;
    size_t n = o->mesh->num_vertices, sent = n < most ? n : most;
    uint64_t *items = NULL, *spare = NULL;
    BRIO_TRY(BRIO_ALLOC(o->ctx, items, n + 1));
    BRIO_TRY(BRIO_ALLOC(o->ctx, spare, n + 1));
    for (size_t i = 0; i < n; i++) items[i] = i;
    BRIO_TRY(
        brio_sort_along_curve(o->ctx, o->mesh->vertices, items, spare, n, brio_threads(o->ctx, n, POINTS_A_THREAD)));
    BRIO_TRY(BRIO_ALLOC(o->ctx, o->vertex, sent + 1));
    for (size_t i = 0; i < sent; i++) o->vertex[i] = (uint32_t)items[(uint64_t)i * n / sent];
    o->num_vertices = sent;
done:
    brio_release(o->ctx, items);
    brio_release(o->ctx, spare);
    return status;
}

static brio_status order_by_use(brio_sent_order *o) {
    const brio_mesh *m = o->mesh;
    size_t n = 0;
    BRIO_FORWARD(BRIO_ALLOC(o->ctx, o->vertex, m->num_vertices + 1));
    for (size_t i = 0; i < o->num_faces; i++)
        for (uint64_t h = m->face_offsets[o->face[i]]; h < m->face_offsets[o->face[i] + 1]; h++) {
            uint32_t v = m->face_vertices[h];
            if (o->place[v] != UINT32_MAX) continue;
            o->place[v] = (uint32_t)n;
            o->vertex[n++] = v;
        }
    for (size_t v = 0; v < m->num_vertices; v++) {
        if (o->place[v] != UINT32_MAX) continue;
        o->place[v] = (uint32_t)n;
        o->vertex[n++] = (uint32_t)v;
    }
    o->num_vertices = n;
    assert(n == m->num_vertices); /* I1 */
    return BRIO_OK;
}

static brio_status order_vertices(brio_sent_order *o, size_t most) {
    const brio_mesh *m = o->mesh;
    bool cloud = !m->num_faces && !m->num_tetrahedra && !m->num_edges;
    if (cloud) return order_along_curve(o, most);
    BRIO_FORWARD(BRIO_ALLOC(o->ctx, o->place, m->num_vertices + 1));
    memset(o->place, 0xff, (m->num_vertices + 1) * sizeof *o->place);
    if (o->num_faces) return order_by_use(o);
    BRIO_FORWARD(order_along_curve(o, SIZE_MAX));
    for (size_t i = 0; i < o->num_vertices; i++) o->place[o->vertex[i]] = (uint32_t)i;
    return BRIO_OK;
}

brio_status brio_sent_order_find(brio_context *ctx, const brio_mesh *mesh, size_t most, brio_sent_order *out) {
    brio_status status = BRIO_OK;
    uint32_t *ring = NULL;
    *out = (brio_sent_order){.ctx = ctx, .mesh = mesh};
    if (mesh->num_faces) {
        BRIO_TRY(find_faces_of_corners(out));
        BRIO_TRY(brio_edge_rings(ctx, mesh, &ring));
        BRIO_TRY(order_faces(out, ring));
        BRIO_TRY(list_edges(out, ring));
    }
    BRIO_TRY(order_vertices(out, most));
done:
    brio_release(ctx, ring);
    return status;
}
