/* Triangles of samples and their neighbours. */
#ifndef BRIO_RECONSTRUCT_TRIANGLE_NET_H
#define BRIO_RECONSTRUCT_TRIANGLE_NET_H

#include "base/sort.h"
#include "mesh/twins.h"

/** A manifold of triangles whose vertices are samples. Half-edges are those of mesh/twins.h. */
typedef struct {
    brio_context *ctx;
    const double *points; /* #P by 3 */
    size_t num_points;
    const uint32_t *faces; /* #F by 3 */
    size_t num_faces;
    uint32_t *twin;            /* 3 #F */
    const float (*outside)[3]; /* #P: unit vectors from the samples to the outside, or NULL */
    const float (*scanner)[3]; /* #P: unit vectors from the samples to their scanners, or zero; or NULL */
} brio_triangle_net;

/** Links the triangles across their edges.
 *  points, faces  kept: they must outlive the net.
 *  out            freed with brio_triangle_net_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_triangle_net_new(brio_context *ctx, const double *points, size_t num_points, const uint32_t *faces,
                                  size_t num_faces, brio_triangle_net *out);
void brio_triangle_net_free(brio_triangle_net *n);

static inline const double *brio_net_corner(const brio_triangle_net *n, size_t half_edge) {
    return n->points + 3 * (size_t)n->faces[half_edge];
}

/** Lists the half-edges that start at each sample.
 *  first    #P + 1, written: those of sample p are leaving[first[p]] to leaving[first[p + 1] - 1], in ascending order.
 *  leaving  3 #F, written.
 *  The caller frees both with brio_release, on failure too. Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_net_leaving(const brio_triangle_net *n, size_t **first, uint32_t **leaving);

/** Returns whether a triangle is on the other side of a half-edge's edge. */
static inline bool brio_net_has_twin(const brio_triangle_net *n, size_t half_edge) {
    return n->twin[half_edge] != BRIO_NO_HALF_EDGE;
}

/** Returns a hash of the positions of a triangle's corners, whatever their order: it decides between triangles that
 *  tie. */
static inline uint64_t brio_net_hash(const brio_triangle_net *n, size_t face) {
    uint64_t sum = 0;
    for (size_t k = 0; k < 3; k++) sum += brio_position_hash(brio_net_corner(n, 3 * face + k));
    return brio_mix(sum);
}

/** Writes the unit normal of a triangle, 0 if its corners are collinear. */
void brio_net_normal(const brio_triangle_net *n, size_t face, double normal[3]);

/** Returns the cosine between a triangle's normal and what the sample where a half-edge starts takes for the outside; 1
 *  if it does not say. */
double brio_net_facing_at(const brio_triangle_net *n, const double normal[3], size_t half_edge);

/** Returns the mean cosine between the normal of a triangle and what its samples take for the outside; 1 if they do not
 *  say. */
double brio_net_facing(const brio_triangle_net *n, size_t face);

/** Returns the largest cosine between the normal of a triangle and the directions from its samples to their scanners:
 *  under 0, none of these saw this side of it. 1 if no scanner is known. */
double brio_net_viewing(const brio_triangle_net *n, size_t face);

#endif
