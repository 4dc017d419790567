/* How much memory the offset of a mesh takes: by the samples of its flat and its round parts. */
#include "base/float_state.h"
#include "base/scale.h"
#include "mesh/edge_rings.h"
#include "mesh/extent.h"
#include "offset/work.h"
#include <math.h>

/* Measured on cubes, prisms, an L, spheres, tori and machined parts. Bytes: a sample; a corner of the mesh, for its
 * tree and its check; batches. Samples: a corner of a face, those of an edge in arcs as long as the error allows, those
 * of all round corners in 4 pi D / E, most of an area in units of D E. */
static const double SAMPLE_BYTES = 1250, CORNER_BYTES = 110, FIXED_BYTES = 4e6;
static const double A_CORNER = 0.9, AN_ARC = 4, A_BALL = 0.6, DENSEST = 10;

static const double PI = 3.141592653589793;

/* Writes twice the vector area of a face, times scale^2. */
static void normal_of(const brio_mesh *mesh, size_t f, double scale, double *n) {
    uint64_t begin = mesh->face_offsets[f], end = mesh->face_offsets[f + 1];
    n[0] = n[1] = n[2] = 0;
    for (uint64_t h = begin + 2; h < end; h++) {
        double t[3];
        brio_scaled_normal(mesh->vertices + 3 * (size_t)mesh->face_vertices[begin],
                           mesh->vertices + 3 * (size_t)mesh->face_vertices[h - 1],
                           mesh->vertices + 3 * (size_t)mesh->face_vertices[h], scale, t);
        for (int k = 0; k < 3; k++) n[k] += t[k];
    }
}

/* Writes the sum of the angles by which the surface turns across its edges. */
static brio_status turn_of(brio_context *ctx, const brio_mesh *mesh, double *turn) {
    brio_status status = BRIO_OK;
    uint32_t *ring = NULL;
    double(*normal)[3] = NULL, scale = brio_surface_scale(mesh);
    uint32_t *face = NULL;
    size_t corners = (size_t)mesh->face_offsets[mesh->num_faces];
    *turn = 0;
    BRIO_TRY(brio_edge_rings(ctx, mesh, &ring));
    BRIO_TRY(BRIO_ALLOC(ctx, normal, mesh->num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, face, corners));
    for (size_t f = 0; f < mesh->num_faces; f++) {
        normal_of(mesh, f, scale, normal[f]);
        for (uint64_t h = mesh->face_offsets[f]; h < mesh->face_offsets[f + 1]; h++) face[h] = (uint32_t)f;
    }
    for (size_t h = 0; h < corners; h++) {
        if (ring[h] <= h) continue;
        const double *m = normal[face[h]], *n = normal[face[ring[h]]];
        double lengths = brio_length(m) * brio_length(n);
        if (lengths > 0) *turn += acos(fmin(fmax(brio_dot(m, n) / lengths, -1), 1));
    }
done:
    brio_release(ctx, ring);
    brio_release(ctx, normal);
    brio_release(ctx, face);
    return status;
}

/* Returns the most samples that fit on an offset: as if it had the area of the mesh and of a ball around it. */
static double most_samples(const brio_mesh *mesh, double distance, double error) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double scale = brio_surface_scale(mesh), area = 0, square = 0;
    brio_box_add_corners(mesh, 0, mesh->face_offsets[mesh->num_faces], low, high);
    for (int k = 0; k < 3; k++) square += pow((high[k] - low[k]) * scale, 2);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        double n[3];
        normal_of(mesh, f, scale, n);
        area += 0.5 * brio_length(n);
    }
    area += 4 * PI * pow(0.5 * sqrt(square) + distance * scale, 2);
    return DENSEST * area / (distance * scale) / (error * scale);
}

brio_status brio_estimate_mesh_offset(brio_context *ctx, const brio_mesh *mesh, double distance,
                                      const brio_mesh_offset_options *options, uint64_t *bytes) {
    BRIO_DOOR;
    brio_mesh_offset_options o;
    double turn = 0;
    *bytes = 0;
    BRIO_FORWARD(brio_offset_settle(ctx, mesh, distance, options, &o));
    if (!mesh->num_faces) return BRIO_OK;
    BRIO_FORWARD(turn_of(ctx, mesh, &turn));
    double d = fabs(distance), corners = (double)mesh->face_offsets[mesh->num_faces];
    double samples = A_CORNER * corners + AN_ARC * turn / sqrt(8 * o.error / d) + A_BALL * 4 * PI * d / o.error;
    samples = fmin(samples, most_samples(mesh, d, o.error));
    double all = FIXED_BYTES + SAMPLE_BYTES * samples + CORNER_BYTES * corners;
    *bytes = all < 0x1p63 ? (uint64_t)all : UINT64_MAX;
    return BRIO_OK;
}
