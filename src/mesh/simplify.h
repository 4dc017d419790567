/* Simplification of a triangle mesh by edge collapses that keep its topology. */
#ifndef BRIO_MESH_SIMPLIFY_H
#define BRIO_MESH_SIMPLIFY_H

#include "base/context.h"

typedef struct {
    size_t target_faces; /* stops at this number of faces, or when no allowed collapse is left */
    const double
        *spacing; /* #V: an edge may collapse if it is at most `longest` times the spacing at each end; NULL: 1 */
    double longest;
    bool embedded;    /* no triangles cross that did not cross before */
    double tolerance; /* most RMS distance of the new point from the planes it stands for, as a share of spacing */
} brio_collapse_options;

/** Collapses edges of a manifold oriented triangle mesh in place, edges of least error first. The mesh stays manifold
 *  and oriented, and keeps its components, genus and boundary; triangles do not turn over. Vertices of the boundary
 *  stay. Vertices that no triangle uses are dropped. A vertex has the properties that it had before its edges
 *  collapsed. The result does not depend on the number of threads.
 *  With `embedded` edges collapse as without; if triangles then cross, the work begins anew in one thread, with an
 *  exact test of each collapse. A mesh whose triangles cross already is always treated like that.
 *  Cost: O(n log n); 175 bytes a vertex, with `embedded` 48 more, and 112 more if the work begins anew.
 *  Returns BRIO_OK; BRIO_ERR_ARGUMENT when a face is not a triangle or the mesh is not manifold and oriented at an
 *  edge or a vertex, and leaves the mesh unchanged; BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED, after which the mesh can
 *  only be freed. */
brio_status brio_collapse_edges(brio_context *ctx, brio_mesh *mesh, const brio_collapse_options *options);

#endif
