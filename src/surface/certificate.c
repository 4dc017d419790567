/* The certificate of a polygon mesh: what connectivity alone says of a surface.
 *
 * The half-edges of each edge are linked into rings (edge_rings). Two union-finds run over the rings: of the faces,
 * joined across edges, whose sets are the components; and of the corners, joined at both ends of every edge of two
 * faces, whose sets are the fans: a vertex is manifold when its corners form one fan. A component has the vertices and
 * edges its faces use; a vertex in several components counts once in each.
 *
 * Where the surface is not a manifold, these conventions hold. An edge joins all its faces into one component, however
 * many they are; but only an edge of two faces continues a fan. A boundary loop is a set of boundary edges connected
 * through fans and across edges of more than two faces: a cycle where the surface is manifold, while two loops that
 * touch where two fans share a vertex stay two. A face with fewer than three corners, or with a vertex twice, makes
 * each of its vertices (each it has twice) non-manifold. An odd 2 - chi - loops, as of a Moebius strip, is rounded
 * down.
 *
 * The union-finds link to the lower index and halve paths, so that a root is the first element of its set and nothing
 * depends on the order of the work; O(log n) amortised for a find. */
#include "surface/edge_rings.h"
#include <math.h>

typedef struct {
    const brio_mesh *mesh;
    size_t corners;
    uint32_t *ring;    /* #corners: edge rings */
    uint32_t *face_of; /* #corners */
    uint32_t *fan;     /* #corners: union-find of the corners */
    uint32_t *patch;   /* #F: union-find of the faces */
    uint8_t *vertex;   /* #V: bits of vertex_state */
} topology;

enum vertex_state { VERTEX_SEEN = 1, VERTEX_TWO_FANS = 2, VERTEX_IN_DEGENERATE_FACE = 4 };

typedef struct {
    int64_t faces, edges, vertices, loops;
} component;

/* --- union-find --- */

static uint32_t find(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

static void unite(uint32_t *parent, uint32_t i, uint32_t j) {
    i = find(parent, i);
    j = find(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

/* --- connectivity --- */

static uint32_t next_corner(const topology *t, uint32_t h) {
    const uint64_t *offsets = t->mesh->face_offsets;
    uint32_t f = t->face_of[h];
    return h + 1 < offsets[f + 1] ? h + 1 : (uint32_t)offsets[f];
}

static void topology_free(brio_context *ctx, topology *t) {
    brio_release(ctx, t->ring);
    brio_release(ctx, t->face_of);
    brio_release(ctx, t->fan);
    brio_release(ctx, t->patch);
    brio_release(ctx, t->vertex);
}

/* On failure the caller frees what there is. */
static brio_status topology_new(brio_context *ctx, const brio_mesh *mesh, topology *t) {
    brio_status status = BRIO_OK;
    *t = (topology){.mesh = mesh, .corners = mesh->num_faces ? mesh->face_offsets[mesh->num_faces] : 0};
    BRIO_TRY(brio_edge_rings(ctx, mesh, &t->ring));
    BRIO_TRY(BRIO_ALLOC(ctx, t->face_of, t->corners));
    BRIO_TRY(BRIO_ALLOC(ctx, t->fan, t->corners));
    BRIO_TRY(BRIO_ALLOC(ctx, t->patch, mesh->num_faces));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t->vertex, mesh->num_vertices));
    for (size_t f = 0; f < mesh->num_faces; f++) {
        t->patch[f] = (uint32_t)f;
        for (uint64_t h = mesh->face_offsets[f]; h < mesh->face_offsets[f + 1]; h++) {
            t->face_of[h] = (uint32_t)f;
            t->fan[h] = (uint32_t)h;
        }
    }
done:
    return status;
}

static void join_faces(topology *t) {
    for (uint32_t h = 0; h < t->corners; h++)
        if (t->ring[h] > h) unite(t->patch, t->face_of[h], t->face_of[t->ring[h]]);
}

/* Joins the corners at either end of each edge of two faces or, where `crowded`, of more. */
static void join_corners(topology *t, bool crowded) {
    const uint32_t *v = t->mesh->face_vertices;
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t g = t->ring[h];
        if (g <= h || crowded != (t->ring[g] != h)) continue;
        uint32_t h_end = next_corner(t, h), g_end = next_corner(t, g);
        bool same_way = v[h] == v[g];
        unite(t->fan, h, same_way ? g : g_end);
        unite(t->fan, h_end, same_way ? g_end : g);
    }
}

/* Marks vertices that a face has twice, and those of faces with fewer than three corners; returns the number of such
 * faces, those without any corner included. */
static brio_status mark_degenerate_faces(brio_context *ctx, topology *t, size_t *degenerate) {
    brio_status status = BRIO_OK;
    const brio_mesh *mesh = t->mesh;
    uint32_t *last_face = NULL; /* of each vertex, plus 1 */
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, last_face, mesh->num_vertices));
    *degenerate = 0;
    for (uint32_t f = 0; f < mesh->num_faces; f++) {
        uint64_t first = mesh->face_offsets[f], end = mesh->face_offsets[f + 1];
        bool bad = end - first < 3;
        for (uint64_t h = first; h < end; h++) {
            uint32_t v = mesh->face_vertices[h];
            bool twice = last_face[v] == f + 1;
            if (twice || end - first < 3) t->vertex[v] |= VERTEX_IN_DEGENERATE_FACE;
            bad |= twice;
            last_face[v] = f + 1;
        }
        *degenerate += bad;
    }
done:
    brio_release(ctx, last_face);
    return status;
}

/* --- edges --- */

static void count_edges(const topology *t, brio_certificate *out) {
    const uint32_t *v = t->mesh->face_vertices;
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t g = t->ring[h];
        if (g > h) continue; /* only the last half-edge of a ring speaks for its edge */
        if (g == h)
            out->boundary_edges++;
        else if (t->ring[g] != h)
            out->nonmanifold_edges++;
        else if (v[g] == v[h])
            out->flipped_edges++;
    }
}

/* --- components --- */

/* Makes the table of components, in the order of their first faces, and lets number[f] be the component of face f. */
static brio_status list_components(brio_context *ctx, topology *t, component **components, size_t *count,
                                   uint32_t **number) {
    brio_status status = BRIO_OK;
    size_t num_faces = t->mesh->num_faces;
    *count = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, *number, num_faces));
    for (uint32_t f = 0; f < num_faces; f++) {
        uint32_t root = find(t->patch, f);
        (*number)[f] = root == f ? (uint32_t)(*count)++ : (*number)[root];
    }
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, *components, *count));
    for (uint32_t f = 0; f < num_faces; f++) (*components)[(*number)[f]].faces++;
    for (uint32_t h = 0; h < t->corners; h++)
        if (t->ring[h] <= h) (*components)[(*number)[t->face_of[h]]].edges++;
done:
    return status;
}

/* Counts one vertex for each fan in the component of the fan. */
static void count_fans(topology *t, const uint32_t *number, component *components) {
    for (uint32_t h = 0; h < t->corners; h++) {
        if (t->fan[h] != h) continue;
        uint8_t *state = &t->vertex[t->mesh->face_vertices[h]];
        if (*state & VERTEX_SEEN) *state |= VERTEX_TWO_FANS;
        *state |= VERTEX_SEEN;
        components[number[t->face_of[h]]].vertices++;
    }
}

/* Takes back what count_fans counted too much: several fans of one vertex in the same component. */
static brio_status recount_pinched_vertices(brio_context *ctx, const topology *t, const uint32_t *number,
                                            component *components) {
    brio_status status = BRIO_OK;
    uint64_t *fans = NULL; /* (vertex, component) */
    size_t count = 0, capacity = 0;
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t v = t->mesh->face_vertices[h];
        if (t->fan[h] != h || !(t->vertex[v] & VERTEX_TWO_FANS)) continue;
        BRIO_TRY(BRIO_RESERVE(ctx, fans, capacity, count + 1));
        fans[count++] = (uint64_t)v << 32 | number[t->face_of[h]];
    }
    brio_sort_keys(fans, count);
    for (size_t i = 1; i < count; i++)
        if (fans[i] == fans[i - 1]) components[(uint32_t)fans[i]].vertices--;
done:
    brio_release(ctx, fans);
    return status;
}

/* Joins fans across edges of more than two faces, and at the two ends of each boundary edge: every set with such an
 * edge is a boundary loop. This is the end of t->fan as the partition into fans. */
static brio_status count_loops(brio_context *ctx, topology *t, const uint32_t *number, component *components) {
    brio_status status = BRIO_OK;
    uint8_t *counted = NULL; /* of each root of a set */
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, counted, t->corners));
    join_corners(t, true);
    for (uint32_t h = 0; h < t->corners; h++)
        if (t->ring[h] == h) unite(t->fan, h, next_corner(t, h));
    for (uint32_t h = 0; h < t->corners; h++) {
        if (t->ring[h] != h) continue;
        uint32_t root = find(t->fan, h);
        if (!counted[root]) components[number[t->face_of[h]]].loops++;
        counted[root] = 1;
    }
done:
    brio_release(ctx, counted);
    return status;
}

static int64_t genus_of(const component *c) {
    int64_t twice = 2 - (c->vertices - c->edges + c->faces) - c->loops;
    return twice >= 0 ? twice / 2 : -((1 - twice) / 2);
}

/* Writes the genera, largest component first. */
static brio_status list_genera(brio_context *ctx, const component *components, size_t count, brio_certificate *out) {
    brio_status status = BRIO_OK;
    uint64_t *order = NULL; /* (complement of the number of faces, component) */
    BRIO_TRY(BRIO_ALLOC(ctx, order, count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->genera, count));
    for (size_t i = 0; i < count; i++) order[i] = (uint64_t)(UINT32_MAX - components[i].faces) << 32 | i;
    brio_sort_keys(order, count);
    for (size_t i = 0; i < count; i++) {
        const component *c = &components[(uint32_t)order[i]];
        out->genera[i] = genus_of(c);
        out->genus += out->genera[i];
        out->boundary_loops += (size_t)c->loops;
    }
    out->components = count;
done:
    brio_release(ctx, order);
    return status;
}

static brio_status certify_components(brio_context *ctx, topology *t, brio_certificate *out) {
    brio_status status = BRIO_OK;
    component *components = NULL;
    uint32_t *number = NULL;
    size_t count = 0;
    BRIO_TRY(list_components(ctx, t, &components, &count, &number));
    join_corners(t, false);
    count_fans(t, number, components);
    BRIO_TRY(recount_pinched_vertices(ctx, t, number, components));
    BRIO_TRY(count_loops(ctx, t, number, components));
    BRIO_TRY(list_genera(ctx, components, count, out));
done:
    brio_release(ctx, components);
    brio_release(ctx, number);
    return status;
}

static brio_status certify_topology(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    brio_status status = BRIO_OK;
    topology t = {0};
    size_t degenerate_faces;
    BRIO_TRY(topology_new(ctx, mesh, &t));
    BRIO_TRY(mark_degenerate_faces(ctx, &t, &degenerate_faces));
    join_faces(&t);
    count_edges(&t, out);
    BRIO_TRY(certify_components(ctx, &t, out));
    for (size_t v = 0; v < mesh->num_vertices; v++)
        out->nonmanifold_vertices += (t.vertex[v] & (VERTEX_TWO_FANS | VERTEX_IN_DEGENERATE_FACE)) != 0;
    out->closed = t.corners > 0 && !out->boundary_edges && !out->nonmanifold_edges;
    out->manifold = !out->nonmanifold_edges && !out->nonmanifold_vertices && !degenerate_faces;
    out->oriented = !out->flipped_edges;
done:
    topology_free(ctx, &t);
    return status;
}

/* --- measure --- */

/* Centre of the box of the vertices that faces use: volumes are summed about it, so that a surface far from the origin
 * loses no digits. */
static void centre_of_faces(const brio_mesh *mesh, double centre[3]) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint64_t h = 0; h < mesh->face_offsets[mesh->num_faces]; h++)
        for (int k = 0; k < 3; k++) {
            double x = mesh->vertices[3 * (size_t)mesh->face_vertices[h] + k];
            if (x < low[k]) low[k] = x;
            if (x > high[k]) high[k] = x;
        }
    for (int k = 0; k < 3; k++) centre[k] = 0.5 * low[k] + 0.5 * high[k];
}

/* Adds area and volume of the faces, each cut into a fan of triangles from its first corner. */
static void measure_faces(const brio_mesh *mesh, brio_certificate *out) {
    double centre[3];
    if (!mesh->num_faces || !mesh->face_offsets[mesh->num_faces]) return;
    centre_of_faces(mesh, centre);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *corners = mesh->face_vertices + mesh->face_offsets[f];
        uint64_t count = mesh->face_offsets[f + 1] - mesh->face_offsets[f];
        for (uint64_t i = 2; i < count; i++) {
            const double *a = mesh->vertices + 3 * (size_t)corners[0];
            const double *b = mesh->vertices + 3 * (size_t)corners[i - 1];
            const double *c = mesh->vertices + 3 * (size_t)corners[i];
            double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
            double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
            out->area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
            out->volume += ((a[0] - centre[0]) * n[0] + (a[1] - centre[1]) * n[1] + (a[2] - centre[2]) * n[2]) / 6;
        }
    }
}

brio_status brio_mesh_certificate(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out) {
    brio_status status = BRIO_OK;
    *out = (brio_certificate){.self_intersections = -1, .context = ctx};
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(certify_topology(ctx, mesh, out));
    measure_faces(mesh, out);
done:
    if (status != BRIO_OK) brio_certificate_free(out);
    return status;
}

void brio_certificate_free(brio_certificate *certificate) {
    if (!certificate || !certificate->context) return;
    brio_release(certificate->context, certificate->genera);
    *certificate = (brio_certificate){0};
}
