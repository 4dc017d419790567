/* Normals of vertices: the sum of the area vectors of the faces round each vertex. The area vector of a polygon does
 * not depend on how the polygon is cut into triangles. Faces that are nearly points or lines, whose directions are
 * noise, hardly count. Where the sum has no direction, because the faces have no area, the vertices at the same
 * position that edges of length 0 join to the vertex count as one vertex. The normal is 0 where their sum has no
 * direction.
 *
 * The surface is scaled to about 1 meanwhile, so that its area vectors neither overflow nor vanish. */
#include "mesh/vertex_normals.h"
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/union_find.h"
#include "mesh/edge_rings.h"
#include "mesh/extent.h"
#include "mesh/properties.h"
#include <math.h>
#include <string.h>

static const char *const NAMES[3] = {"nx", "ny", "nz"};

/* Writes the normal of the face, of length twice its area, both scaled. */
static void area_vector(const brio_mesh *m, size_t face, double scale, double *n) {
    const double *o = m->vertices + 3 * (size_t)m->face_vertices[m->face_offsets[face]];
    n[0] = n[1] = n[2] = 0;
    for (uint64_t h = m->face_offsets[face] + 2; h < m->face_offsets[face + 1]; h++) {
        double of_triangle[3];
        brio_scaled_normal(o, m->vertices + 3 * (size_t)m->face_vertices[h - 1],
                           m->vertices + 3 * (size_t)m->face_vertices[h], scale, of_triangle);
        for (int k = 0; k < 3; k++) n[k] += of_triangle[k];
    }
}

static void normalise(double *n) {
    double most = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    if (!(most > 0) || !brio_all_finite(n, 3)) {
        n[0] = n[1] = n[2] = 0;
        return;
    }
    for (int k = 0; k < 3; k++) n[k] /= most; /* so that squares do not underflow */
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) n[k] /= length;
}

/* Makes one set of the vertices that edges of length 0 join. */
static void join_vertices(const brio_mesh *m, uint32_t *parent) {
    for (size_t v = 0; v < m->num_vertices; v++) parent[v] = (uint32_t)v;
    for (size_t f = 0; f < m->num_faces; f++)
        for (uint64_t h = m->face_offsets[f], end = m->face_offsets[f + 1]; h < end; h++) {
            uint32_t v = m->face_vertices[h], w = m->face_vertices[h + 1 < end ? h + 1 : m->face_offsets[f]];
            const double *p = m->vertices + 3 * (size_t)v, *q = m->vertices + 3 * (size_t)w;
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) brio_unite(parent, v, w, true);
        }
}

static bool is_zero(const double *n) {
    return n[0] == 0 && n[1] == 0 && n[2] == 0;
}

/* Replaces each sum of 0 by the sum over the vertices that are joined to the vertex. */
static brio_status share_sums(brio_context *ctx, const brio_mesh *m, double *sum) {
    brio_status status = BRIO_OK;
    uint32_t *parent = NULL;
    double *total = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, parent, m->num_vertices));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, total, 3 * m->num_vertices));
    join_vertices(m, parent);
    for (size_t v = 0; v < m->num_vertices; v++) {
        size_t root = brio_find(parent, (uint32_t)v);
        for (size_t k = 0; k < 3; k++) total[3 * root + k] += sum[3 * v + k];
    }
    for (size_t v = 0; v < m->num_vertices; v++)
        if (is_zero(sum + 3 * v))
            memcpy(sum + 3 * v, total + 3 * (size_t)brio_find(parent, (uint32_t)v), 3 * sizeof *sum);
done:
    brio_release(ctx, parent);
    brio_release(ctx, total);
    return status;
}

brio_status brio_vertex_normals(const brio_mesh *mesh, double **normals) {
    brio_status status = BRIO_OK;
    double *sum = NULL;
    *normals = NULL;
    BRIO_TRY(brio_mesh_check_faces(mesh->context, mesh));
    BRIO_TRY(BRIO_ALLOC_ZERO(mesh->context, sum, 3 * mesh->num_vertices));
    double scale = brio_surface_scale(mesh);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        double n[3];
        if (mesh->face_offsets[f + 1] == mesh->face_offsets[f]) continue;
        area_vector(mesh, f, scale, n);
        for (uint64_t h = mesh->face_offsets[f]; h < mesh->face_offsets[f + 1]; h++)
            for (int k = 0; k < 3; k++) sum[3 * (size_t)mesh->face_vertices[h] + k] += n[k];
    }
    BRIO_TRY(share_sums(mesh->context, mesh, sum));
    for (size_t v = 0; v < mesh->num_vertices; v++) normalise(sum + 3 * v);
    *normals = sum;
    sum = NULL;
done:
    brio_release(mesh->context, sum);
    return status;
}

brio_status brio_mesh_add_normals(brio_mesh *mesh) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    size_t before = mesh->num_properties;
    double *normals = NULL;
    float *column[3];
    BRIO_TRY(brio_vertex_normals(mesh, &normals));
    for (int k = 0; k < 3; k++) {
        void *data;
        BRIO_TRY(brio_mesh_add_property(mesh, NAMES[k], BRIO_SCALAR_FLOAT32, &data));
        column[k] = data;
    }
    for (size_t v = 0; v < mesh->num_vertices; v++)
        for (int k = 0; k < 3; k++) column[k][v] = (float)normals[3 * v + (size_t)k];
done:
    if (status != BRIO_OK) brio_mesh_drop_properties(mesh, before);
    brio_release(mesh->context, normals);
    return status;
}
