/* Reading and writing of meshes whose edges collapse.
 *
 * Vertices are renumbered along a Hilbert curve, and triangles by their first vertex along it: what is near on the
 * surface is near in memory. A second order of the vertices follows the curve through the rotated surface, so that the
 * planes at which the two curves leave a neighbourhood cross each other. Ties go by the first half-edge of a vertex, so
 * that the result does not depend on how the caller numbers the vertices. */
#include "mesh/collapse_mesh.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include "mesh/collapse_guard.h"
#include "mesh/edge_rings.h"
#include "mesh/properties.h"
#include "order/curve.h"
#include <math.h>
#include <string.h>

/* --- quadrics --- */

/* The quadric of a triangle.
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997.
 * Differs from the paper: area weights the planes, and a small term draws each corner towards its original position. */

static const double PULL = 1e-3; /* weight of the original position, as a share of the weight of the planes; chosen */

/* Adds weight (n.x - d)^2; n need not have unit length. */
static void add_plane(brio_quadric *q, const double *n, double d, double weight) {
    int at = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) q->a[at++] += weight * n[i] * n[j];
        q->b[i] += weight * d * n[i];
    }
    q->c += weight * d * d;
}

static void add_point(brio_quadric *q, const double *p, double weight) {
    q->a[0] += weight, q->a[3] += weight, q->a[5] += weight;
    for (int i = 0; i < 3; i++) {
        q->b[i] += weight * p[i];
        q->c += weight * p[i] * p[i];
    }
}

/* Adds the plane of a triangle. Also adds the corner p with a small weight, which fixes the minimum where the planes
 *  do not determine one. */
static void quadric_add_triangle(brio_quadric *q, const double *p, const double *r, const double *s) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = r[k] - p[k], v[k] = s[k] - p[k];
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) return;
    for (int k = 0; k < 3; k++) n[k] /= length;
    add_plane(q, n, n[0] * p[0] + n[1] * p[1] + n[2] * p[2], length);
    add_point(q, p, PULL * length);
    q->area += length;
}

/* --- the mesh --- */

enum { NONE = BRIO_COLLAPSE_NONE, VERTICES_A_THREAD = 1 << 12 };

/* --- the order --- */

/* What is needed until the mesh is renumbered. */
typedef struct {
    brio_collapse_mesh *m;
    brio_mesh *mesh;
    uint32_t *vertex_number, *face_number; /* the new index of each of the caller's vertices and faces */
    uint64_t *items, *spare;               /* #V */
    uint32_t *ring;                        /* brio_edge_rings of the caller's mesh */
    double *position;                      /* #V by 3: rotated; then in the new order */
    uint32_t *vertex;                      /* #half-edges, in the new order */
} renumbering;

/* Writes to items the vertices that triangles use, in the order of their first half-edges. */
static size_t list_vertices(const renumbering *r) {
    size_t count = 0;
    for (size_t v = 0; v < r->mesh->num_vertices; v++) r->vertex_number[v] = NONE;
    for (size_t h = 0; h < r->m->num_faces * 3; h++) {
        uint32_t v = r->mesh->face_vertices[h];
        if (r->vertex_number[v] != NONE) continue;
        r->vertex_number[v] = 0;
        r->items[count++] = v;
    }
    return count;
}

static void number_vertices(void *user, size_t begin, size_t end, int thread) {
    const renumbering *r = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        r->m->vertex_name[i] = (uint32_t)r->items[i];
        r->vertex_number[(uint32_t)r->items[i]] = (uint32_t)i;
    }
}

/* Rotates by 60 degrees about the diagonal, which leaves no plane of the axes where it was. */
static void rotate_vertices(void *user, size_t begin, size_t end, int thread) {
    const renumbering *r = user;
    (void)thread;
    for (size_t v = begin; v < end; v++) {
        const double *p = r->mesh->vertices + 3 * (size_t)r->m->vertex_name[v];
        for (int k = 0; k < 3; k++)
            r->position[3 * v + (size_t)k] = (2 * p[k] - p[(k + 1) % 3] + 2 * p[(k + 2) % 3]) / 3;
        r->items[v] = v;
    }
}

static void keep_second_order(void *user, size_t begin, size_t end, int thread) {
    const renumbering *r = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) r->m->second_order[i] = (uint32_t)r->items[i];
}

/* Finds both orders of the vertices. */
static brio_status order_vertices(renumbering *r) {
    brio_status status = BRIO_OK;
    brio_collapse_mesh *m = r->m;
    brio_context *ctx = m->ctx;
    size_t room = r->mesh->num_vertices;
    BRIO_TRY(BRIO_ALLOC(ctx, r->vertex_number, room));
    BRIO_TRY(BRIO_ALLOC(ctx, r->items, room));
    BRIO_TRY(BRIO_ALLOC(ctx, r->spare, room));
    size_t n = m->num_vertices = list_vertices(r);
    int threads = brio_threads(ctx, n, VERTICES_A_THREAD);
    BRIO_TRY(BRIO_ALLOC(ctx, m->vertex_name, n));
    BRIO_TRY(BRIO_ALLOC(ctx, m->second_order, n));
    BRIO_TRY(BRIO_ALLOC(ctx, r->position, 3 * n));
    BRIO_TRY(brio_sort_along_curve(ctx, r->mesh->vertices, r->items, r->spare, n, threads));
    BRIO_TRY(brio_for(ctx, threads, n, number_vertices, r));
    BRIO_TRY(brio_for(ctx, threads, n, rotate_vertices, r));
    BRIO_TRY(brio_sort_along_curve(ctx, r->position, r->items, r->spare, n, threads));
    BRIO_TRY(brio_for(ctx, threads, n, keep_second_order, r));
done:
    brio_release(ctx, r->items);
    brio_release(ctx, r->spare);
    r->items = r->spare = NULL;
    return status;
}

static uint32_t first_vertex(const renumbering *r, size_t f) {
    const uint32_t *v = r->mesh->face_vertices + 3 * f;
    uint32_t a = r->vertex_number[v[0]], b = r->vertex_number[v[1]], c = r->vertex_number[v[2]], least = a < b ? a : b;
    return least < c ? least : c;
}

/* Sorts the faces by first vertex, by counting. */
static brio_status order_faces(renumbering *r) {
    brio_status status = BRIO_OK;
    brio_collapse_mesh *m = r->m;
    uint32_t *start = NULL, sum = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(m->ctx, start, m->num_vertices));
    BRIO_TRY(BRIO_ALLOC(m->ctx, m->face_name, m->num_faces));
    BRIO_TRY(BRIO_ALLOC(m->ctx, r->face_number, m->num_faces));
    for (size_t f = 0; f < m->num_faces; f++) start[first_vertex(r, f)]++;
    for (size_t v = 0; v < m->num_vertices; v++) {
        uint32_t count = start[v];
        start[v] = sum;
        sum += count;
    }
    for (size_t f = 0; f < m->num_faces; f++) {
        uint32_t to = start[first_vertex(r, f)]++;
        m->face_name[to] = (uint32_t)f;
        r->face_number[f] = to;
    }
done:
    brio_release(m->ctx, start);
    return status;
}

/* --- the new numbers --- */

static void move_faces(void *user, size_t begin, size_t end, int thread) {
    const renumbering *r = user;
    (void)thread;
    for (size_t f = begin; f < end; f++)
        for (size_t i = 0; i < 3; i++) {
            size_t old = 3 * (size_t)r->m->face_name[f] + i;
            uint32_t mate = r->ring[old];
            r->vertex[3 * f + i] = r->vertex_number[r->mesh->face_vertices[old]];
            r->m->mate[3 * f + i] = 3 * r->face_number[mate / 3] + mate % 3;
        }
}

static void move_vertices(void *user, size_t begin, size_t end, int thread) {
    const renumbering *r = user;
    brio_collapse_mesh *m = r->m;
    (void)thread;
    for (size_t v = begin; v < end; v++) {
        size_t old = m->vertex_name[v];
        memcpy(r->position + 3 * v, r->mesh->vertices + 3 * old, 3 * sizeof *r->position);
        if (m->spacing) m->spacing[v] = m->options->spacing[old];
    }
}

static brio_status renumber(renumbering *r) {
    brio_status status = BRIO_OK;
    brio_collapse_mesh *m = r->m;
    brio_context *ctx = m->ctx;
    BRIO_TRY(brio_edge_rings(ctx, r->mesh, &r->ring));
    BRIO_TRY(order_vertices(r));
    BRIO_TRY(order_faces(r));
    BRIO_TRY(BRIO_ALLOC(ctx, r->vertex, 3 * m->num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, m->mate, 3 * m->num_faces));
    if (m->options->spacing) BRIO_TRY(BRIO_ALLOC(ctx, m->spacing, m->num_vertices));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, m->num_faces, VERTICES_A_THREAD), m->num_faces, move_faces, r));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, m->num_vertices, VERTICES_A_THREAD), m->num_vertices, move_vertices, r));
    m->vertex = r->vertex;
    m->position = r->position;
done:
    brio_release(ctx, r->ring);
    brio_release(ctx, r->vertex_number);
    brio_release(ctx, r->face_number);
    r->ring = r->vertex_number = r->face_number = NULL;
    return status;
}

static void renumbering_free(brio_context *ctx, renumbering *r) {
    brio_release(ctx, r->position);
    brio_release(ctx, r->vertex);
}

/* --- what is refused --- */

static brio_status check_edges(brio_collapse_mesh *m) {
    for (uint32_t h = 0; h < 3 * m->num_faces; h++) {
        uint32_t g = m->mate[h], u = m->vertex[h], v = brio_collapse_end(m, h);
        BRIO_EXPECT(m->ctx, g == h || (m->mate[g] == h && m->vertex[g] == v), BRIO_ERR_ARGUMENT,
                    "the surface is not manifold and oriented at the edge from vertex %u to %u", m->vertex_name[u],
                    m->vertex_name[v]);
        if (g == h) m->marks[u] = m->marks[v] = BRIO_COLLAPSE_BOUNDARY;
    }
    return BRIO_OK;
}

/* Returns the number of half-edges that start where h starts and belong to the fan of triangles of h. */
static uint32_t fan_size(const brio_collapse_mesh *m, uint32_t h) {
    uint32_t size = 1, g = h, side = brio_collapse_before(g);
    for (; m->mate[side] != side; side = brio_collapse_before(g)) {
        g = m->mate[side];
        if (g == h) return size;
        size++;
    }
    for (g = h; m->mate[g] != g; size++) g = brio_collapse_next(m->mate[g]); /* from h in the opposite direction */
    return size;
}

/* Refuses vertices with several fans, because a collapse moves one fan only. Sets half_edge. */
static brio_status check_fans(brio_collapse_mesh *m) {
    brio_status status = BRIO_OK;
    uint32_t *degree = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(m->ctx, degree, m->num_vertices));
    for (uint32_t h = 0; h < 3 * m->num_faces; h++) {
        degree[m->vertex[h]]++;
        m->half_edge[m->vertex[h]] = h;
    }
    for (size_t v = 0; v < m->num_vertices; v++)
        BRIO_REQUIRE(m->ctx, degree[v] == fan_size(m, m->half_edge[v]), BRIO_ERR_ARGUMENT,
                     "the surface is not manifold at vertex %u: its triangles are several fans", m->vertex_name[v]);
done:
    brio_release(m->ctx, degree);
    return status;
}

static brio_status check_faces(brio_context *ctx, const brio_mesh *mesh) {
    BRIO_FORWARD(brio_mesh_check_faces(ctx, mesh));
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *v = mesh->face_vertices + 3 * f;
        BRIO_EXPECT(ctx, mesh->face_offsets[f + 1] == 3 * (f + 1), BRIO_ERR_ARGUMENT, "face %zu is not a triangle", f);
        BRIO_EXPECT(ctx, v[0] != v[1] && v[1] != v[2] && v[2] != v[0], BRIO_ERR_ARGUMENT,
                    "the surface is not manifold: face %zu has vertex %u twice", f, v[0] == v[1] ? v[0] : v[2]);
    }
    return BRIO_OK;
}

/* --- quadrics of the mesh --- */

/* Sums the quadrics of the triangles round each vertex inside the surface. Those of the boundary do not collapse. */
static void add_quadrics(void *user, size_t begin, size_t end, int thread) {
    brio_collapse_mesh *m = user;
    (void)thread;
    for (size_t v = begin; v < end; v++) {
        uint32_t h = m->half_edge[v], g = h;
        m->quadric[v] = (brio_quadric){0};
        if (m->marks[v] & BRIO_COLLAPSE_BOUNDARY) continue;
        do
            quadric_add_triangle(&m->quadric[v], brio_collapse_at(m, (uint32_t)v),
                                 brio_collapse_at(m, brio_collapse_end(m, g)),
                                 brio_collapse_at(m, m->vertex[brio_collapse_before(g)]));
        while ((g = brio_collapse_turn(m, g)) != h);
    }
}

/* Returns what an error, an area times a squared length, is multiplied by to be in a unit in which the largest
 * coordinate of a vertex of a triangle is about 1. */
static double unit_of(const double *position, size_t num_vertices) {
    double most = 0;
    int exponent;
    for (size_t i = 0; i < 3 * num_vertices; i++) most = fmax(most, fabs(position[i]));
    frexp(most, &exponent);
    return ldexp(1, -4 * exponent);
}

/* Gives the caller's mesh the new order, now that nothing is refused any more. */
static void take_over(renumbering *r) {
    brio_collapse_mesh *m = r->m;
    memcpy(r->mesh->vertices, r->position, 3 * m->num_vertices * sizeof *r->position);
    memcpy(r->mesh->face_vertices, r->vertex, 3 * m->num_faces * sizeof *r->vertex);
    m->position = r->mesh->vertices;
    m->vertex = r->mesh->face_vertices;
}

brio_status brio_collapse_mesh_new(brio_context *ctx, brio_mesh *mesh, const brio_collapse_options *options,
                                   brio_collapse_mesh *m) {
    brio_status status = BRIO_OK;
    renumbering r = {.m = m, .mesh = mesh};
    *m = (brio_collapse_mesh){.ctx = ctx, .options = options, .num_faces = mesh->num_faces};
    BRIO_TRY(check_faces(ctx, mesh));
    if (mesh->num_faces == 0) goto done;
    BRIO_TRY(renumber(&r));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, m->marks, m->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, m->half_edge, m->num_vertices));
    BRIO_TRY(check_edges(m));
    BRIO_TRY(check_fans(m));
    m->unit = unit_of(r.position, m->num_vertices);
    take_over(&r);
    renumbering_free(ctx, &r);
    r.position = NULL, r.vertex = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, m->quadric, m->num_vertices));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, m->num_vertices, VERTICES_A_THREAD), m->num_vertices, add_quadrics, m));
    BRIO_TRY(BRIO_ALLOC(ctx, m->error, 3 * m->num_faces));
done:
    renumbering_free(ctx, &r);
    return status;
}

/* --- end --- */

/* Writes to `left` what is left of n items, in the order of their names below num_names. Returns how many are left. */
static size_t list_by_name(const uint32_t *name, const uint32_t *use, size_t stride, size_t n, uint32_t *left,
                           size_t num_names) {
    size_t count = 0;
    for (size_t i = 0; i < num_names; i++) left[i] = NONE;
    for (size_t i = 0; i < n; i++)
        if (use[stride * i] != NONE) left[name[i]] = (uint32_t)i;
    for (size_t i = 0; i < num_names; i++)
        if (left[i] != NONE) left[count++] = left[i];
    return count;
}

/* Writes the vertices that are left to the caller's mesh, and to number[v] the index of vertex v there. */
static brio_status write_vertices(const brio_collapse_mesh *m, brio_mesh *mesh, uint32_t *number) {
    brio_status status = BRIO_OK;
    uint32_t *left = NULL;
    double *position = NULL;
    BRIO_TRY(BRIO_ALLOC(m->ctx, left, mesh->num_vertices));
    size_t count = list_by_name(m->vertex_name, m->half_edge, 1, m->num_vertices, left, mesh->num_vertices);
    BRIO_TRY(BRIO_ALLOC(m->ctx, position, 3 * count));
    for (size_t i = 0; i < count; i++) {
        memcpy(position + 3 * i, brio_collapse_at(m, left[i]), 3 * sizeof *position);
        number[left[i]] = (uint32_t)i;
        brio_properties_move(mesh->properties, mesh->num_properties, m->vertex_name[left[i]], i);
    }
    if (count) memcpy(mesh->vertices, position, 3 * count * sizeof *position);
    mesh->num_vertices = count;
done:
    brio_release(m->ctx, left);
    brio_release(m->ctx, position);
    return status;
}

static brio_status write_faces(const brio_collapse_mesh *m, brio_mesh *mesh, const uint32_t *number) {
    brio_status status = BRIO_OK;
    uint32_t *left = NULL, *corners = NULL;
    BRIO_TRY(BRIO_ALLOC(m->ctx, left, m->num_faces));
    size_t count = list_by_name(m->face_name, m->vertex, 3, m->num_faces, left, m->num_faces);
    BRIO_TRY(BRIO_ALLOC(m->ctx, corners, 3 * count));
    for (size_t f = 0; f < count; f++) {
        for (size_t i = 0; i < 3; i++) corners[3 * f + i] = number[m->vertex[3 * (size_t)left[f] + i]];
        brio_properties_move(mesh->face_properties, mesh->num_face_properties, m->face_name[left[f]], f);
    }
    if (count) memcpy(mesh->face_vertices, corners, 3 * count * sizeof *corners);
    mesh->num_faces = count; /* the offsets are those of triangles already */
done:
    brio_release(m->ctx, left);
    brio_release(m->ctx, corners);
    return status;
}

/* Frees what only collapses need. */
static void free_workspace(brio_collapse_mesh *m) {
    brio_release(m->ctx, m->mate);
    brio_release(m->ctx, m->error);
    brio_release(m->ctx, m->marks);
    brio_release(m->ctx, m->spacing);
    brio_release(m->ctx, m->quadric);
    brio_release(m->ctx, m->second_order);
    brio_collapse_guard_free(m->ctx, m->guard);
    m->guard = NULL;
    m->mate = m->second_order = NULL;
    m->error = NULL, m->marks = NULL, m->spacing = NULL, m->quadric = NULL;
}

brio_status brio_collapse_mesh_write(brio_collapse_mesh *m, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    uint32_t *number = NULL;
    free_workspace(m);
    BRIO_TRY(BRIO_ALLOC(m->ctx, number, m->num_vertices));
    BRIO_TRY(write_vertices(m, mesh, number));
    BRIO_TRY(write_faces(m, mesh, number));
done:
    brio_release(m->ctx, number);
    return status;
}

void brio_collapse_mesh_free(brio_collapse_mesh *m) {
    free_workspace(m);
    brio_release(m->ctx, m->half_edge);
    brio_release(m->ctx, m->vertex_name);
    brio_release(m->ctx, m->face_name);
}
