/* brio/offset.h: the surface at a distance from a closed mesh. Of points, see BRIO_SURFACE_OFFSET. */
#ifndef BRIO_OFFSET_H
#define BRIO_OFFSET_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_mesh_offset_options {
    size_t size;
    double
        error; /* most distance of the result from the exact offset, in the unit of the mesh, above 0 and less than the
                        offset's distance; 0: a hundredth of that */
} brio_mesh_offset_options;

typedef struct brio_mesh_offset_stats {
    size_t size;
    size_t samples; /* points of the exact offset that were found */
    size_t rounds;  /* in which they were triangulated */
    double
        error; /* as it is proven: no place of the result is nearer to the mesh, or farther from it, than the distance by
                          more than this. At most the error asked for, but where the surface could not be mended. */
} brio_mesh_offset_stats;

/** Computes the offset of the solid that a closed mesh bounds: for a positive distance the boundary of all points that
 *  are at most so far from the solid, round about its convex edges and corners and sharp over concave ones; for a
 *  negative distance the boundary of the points of the solid that are at least so far from its surface, sharp at convex
 *  edges and round about concave ones. The faces count, not the vertices: the mesh may be as coarse as it likes. Parts
 *  of an offset that meet are merged; parts of the solid that are too thin vanish, and so do small ones of the offset
 *  thinner than twice the error. Guarantees: closed, manifold, oriented, and free of self-intersections; where the
 *  offset touches itself, the result is joined or apart, within the error. No two vertices are at one position, but a
 *  fourteenth of the error from each other at least: so single precision (STL) keeps the surface a manifold where the
 *  error is more than 3e-6 of the greatest coordinate. The vertices are on the exact offset, up to a fiftieth of the
 *  error; the whole surface is within stats.error of it, which is proven for every triangle. The other way round, no
 *  point of a net on the exact offset, half a distance wide, is farther than twice the error from the result. The net
 *  is wider where it would have more than eight million points; what is smaller than the net may be missing. Flat parts
 *  have few triangles.
 *  mesh      closed: each edge, with vertices at one position taken as one, has as many half-edges in one direction as
 *            in the other. Several components, pinched edges and overlapping pieces are allowed.
 *  distance  not 0, in the unit of the mesh.   options  NULL for the defaults.   out  owned by the caller, triangles.
 *  stats     NULL, or receives what was found.
 *  Cost: some ten triangulations of the samples; about 1,100 bytes a sample. There are as many samples as corners of
 *  faces at least, and about 4 pi D / E more for each ball's worth of round parts, for the distance D and the error E.
 *  Returns BRIO_OK; BRIO_ERR_ARGUMENT (an index out of range, a distance that is 0, not finite or more than 2^30 times
 *  the size of the mesh, an error that is not below the distance or too small for doubles); BRIO_ERR_NO_ANSWER (the
 *  mesh is not closed, or an inward offset leaves nothing); BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Boissonnat Oudot 2005]; docs/algorithms.md. */
BRIO_API brio_status brio_mesh_offset(brio_context *ctx, const brio_mesh *mesh, double distance,
                                      const brio_mesh_offset_options *options, brio_mesh **out,
                                      brio_mesh_offset_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
