/* Holes of the samples, left open. */
#ifndef BRIO_RECONSTRUCT_OPEN_HOLES_H
#define BRIO_RECONSTRUCT_OPEN_HOLES_H

#include "base/context.h"

/** The samples, and which holes of theirs stay open. */
typedef struct {
    const double *points, *spacing; /* #P by 3; #P: of the samples */
    size_t num_points;
    double most; /* K: the radius in spacings above which a hole stays open */
} brio_hole_rule;

/** Removes the triangles that span holes of the samples from a closed manifold. What is left is a manifold with boundary,
 *  maybe empty.
 *  faces  *num_faces by 3, read and written: Delaunay triangles of the points.
 *  The result does not depend on the order of the faces. Among fans of one length at a vertex, the numbers of the points
 *  decide.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_leave_holes_open(brio_context *ctx, const brio_hole_rule *rule, uint32_t *faces, size_t *num_faces);

#endif
