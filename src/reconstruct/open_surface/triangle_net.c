/* Triangles of samples and their neighbours: the half-edges of a mesh whose vertices are the samples. */
#include "reconstruct/open_surface/triangle_net.h"
#include "base/places.h"
#include "base/vector.h"
#include "mesh/twins.h"
#include <math.h>
#include <string.h>

brio_status brio_triangle_net_new(brio_context *ctx, const double *points, size_t num_points, const uint32_t *faces,
                                  size_t num_faces, brio_triangle_net *out) {
    brio_status status = BRIO_OK;
    brio_mesh mesh = {.context = ctx, .num_vertices = num_points, .num_faces = num_faces};
    uint32_t *corners = NULL;
    *out = (brio_triangle_net){
        .ctx = ctx, .points = points, .num_points = num_points, .faces = faces, .num_faces = num_faces};
    BRIO_TRY(BRIO_ALLOC(ctx, mesh.face_offsets, num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, corners, 3 * num_faces));
    for (size_t f = 0; f <= num_faces; f++) mesh.face_offsets[f] = 3 * f;
    for (size_t h = 0; h < 3 * num_faces; h++) corners[h] = faces[h];
    mesh.face_vertices = corners;
    BRIO_TRY(brio_mesh_twins(ctx, &mesh, &out->twin));
done:
    brio_release(ctx, mesh.face_offsets);
    brio_release(ctx, corners);
    return status;
}

void brio_triangle_net_free(brio_triangle_net *n) {
    brio_release(n->ctx, n->twin);
    n->twin = NULL;
}

brio_status brio_net_leaving(const brio_triangle_net *n, size_t **first, uint32_t **leaving) {
    brio_status status = BRIO_OK;
    size_t *place = NULL;
    *first = NULL, *leaving = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(n->ctx, place, n->num_points));
    BRIO_TRY(BRIO_ALLOC(n->ctx, *first, n->num_points + 1));
    BRIO_TRY(BRIO_ALLOC(n->ctx, *leaving, 3 * n->num_faces));
    for (size_t h = 0; h < 3 * n->num_faces; h++) place[n->faces[h]]++;
    (*first)[n->num_points] = brio_counts_to_places(place, 1, n->num_points, 0);
    memcpy(*first, place, n->num_points * sizeof *place);
    for (size_t h = 0; h < 3 * n->num_faces; h++) (*leaving)[place[n->faces[h]]++] = (uint32_t)h;
done:
    brio_release(n->ctx, place);
    return status;
}

void brio_net_normal(const brio_triangle_net *n, size_t face, double normal[3]) {
    const double *o = brio_net_corner(n, 3 * face), *p = brio_net_corner(n, 3 * face + 1),
                 *q = brio_net_corner(n, 3 * face + 2);
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = p[k] - o[k], v[k] = q[k] - o[k];
    brio_cross(u, v, normal);
    double length = brio_length(normal);
    for (int k = 0; k < 3; k++) normal[k] = length > 0 ? normal[k] / length : 0;
}

/* Returns the cosine between two unit vectors. */
static double along(const double normal[3], const float to[3]) {
    return normal[0] * (double)to[0] + normal[1] * (double)to[1] + normal[2] * (double)to[2];
}

double brio_net_facing_at(const brio_triangle_net *n, const double normal[3], size_t half_edge) {
    return n->outside ? along(normal, n->outside[n->faces[half_edge]]) : 1;
}

double brio_net_facing(const brio_triangle_net *n, size_t face) {
    double normal[3], sum = 0;
    if (!n->outside) return 1;
    brio_net_normal(n, face, normal);
    for (size_t i = 0; i < 3; i++) sum += along(normal, n->outside[n->faces[3 * face + i]]);
    return sum / 3;
}

double brio_net_viewing(const brio_triangle_net *n, size_t face) {
    double normal[3], most = -2;
    if (!n->scanner) return 1;
    brio_net_normal(n, face, normal);
    for (size_t i = 0; i < 3; i++) {
        const float *to = n->scanner[n->faces[3 * face + i]];
        if (to[0] != 0 || to[1] != 0 || to[2] != 0) most = fmax(most, along(normal, to));
    }
    return most < -1.5 ? 1 : most;
}
