/* What the methods of a plane begin and end with: points with their coordinates there, and a mesh whose vertices are
 * the distinct positions of points. */
#ifndef BRIO_CURVE_SAMPLES_MESH_H
#define BRIO_CURVE_SAMPLES_MESH_H

#include "base/context.h"

/** Makes a mesh of the points that stand for themselves, in their order, with the property "sample" (uint32), the index
 *  of the point.
 *  vertex  #P: in, BRIO_INFINITE for points that are no vertices; out, the vertex of each other one.
 *  out     owned by the caller. */
brio_status brio_samples_mesh(brio_context *ctx, const double *points, size_t num_points, uint32_t *vertex,
                              brio_mesh **out);

/** Points in canonical order, times a power of two that brings the greatest coordinate near 1, and their plane. */
typedef struct {
    uint32_t *order; /* the point of each row */
    double (*at)[2];
    int exponent; /* of the power of two */
    brio_plane_frame frame;
} brio_flat_points;

/** Takes the points, which are in a plane up to 2^-20 of their extent; writes their coordinates there.
 *  out  zero; to be freed with brio_flat_points_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_ANSWER (no points; points off a plane),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_flat_points_take(brio_context *ctx, const double *points, size_t num_points, brio_flat_points *out);

void brio_flat_points_free(brio_context *ctx, brio_flat_points *flat);

#endif
