/* Simplification of a triangle mesh by edge collapses that keep it what it is as a combinatorial surface. */
#ifndef BRIO_SURFACE_SIMPLIFY_H
#define BRIO_SURFACE_SIMPLIFY_H

#include "base/context.h"

typedef struct {
    size_t target_faces;   /* stops there, or when no collapse is left that is allowed */
    const double *spacing; /* #V: edges up to `longest` times the spacing at their ends may collapse */
    double longest;
    double tolerance; /* no collapse whose root-mean-square distance from the planes it stands for is over this share of
                         the spacing */
} brio_simplify_options;

/** Collapses edges of a manifold oriented triangle mesh in place, the ones that change the shape least first. The mesh
 *  stays manifold and oriented, with the same components, genus and boundary; triangles do not turn over. Vertices of
 *  the boundary stay. Vertices that no triangle uses are dropped; properties must not be there.
 *  Cost: O(n log n); 500 bytes a vertex.
 *  Returns BRIO_OK; BRIO_ERR_ARGUMENT when a face is not a triangle or the mesh is not manifold and oriented at an edge
 *  or a vertex, and leaves the mesh unchanged; BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED, and the mesh is only good to be
 *  freed. */
brio_status brio_mesh_simplify(brio_context *ctx, brio_mesh *mesh, const brio_simplify_options *options);

#endif
