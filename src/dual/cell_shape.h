/* The shape of Voronoi cells. Cells are long and thin where the surface is sampled densely enough, and not
 * elsewhere. */
#ifndef BRIO_DUAL_CELL_SHAPE_H
#define BRIO_DUAL_CELL_SHAPE_H

#include "base/context.h"

/** Voronoi cells, represented by the dual tetrahedra. The struct owns nothing. */
typedef struct {
    const brio_tetrahedron *tet; /* finite tetrahedra come first */
    size_t num_finite;
    const double *centre; /* #finite by 3: circumcentres; NaN in the first coordinate where a double cannot hold one */
    const double *points;
    size_t num_samples;      /* the first num_samples points are the samples */
    const uint32_t *pole_of; /* #samples by 2: the tetrahedra of the farther and the nearer pole, or UINT32_MAX */
} brio_shaped_cells;

/** Writes shape[s], #samples: the distance from sample s to its nearer pole, divided by the radius of the cell of s in
 *  the co-cone. The co-cone holds the directions within pi / 8 of the plane through s normal to the direction to the
 *  farther pole. The radius is the largest distance from s to a point on an edge of the cell in the co-cone.
 *  Long, thin cells have large shapes. Writes about `most` for larger shapes and for samples without a nearer pole. */
brio_status brio_cell_shapes(brio_context *ctx, const brio_shaped_cells *cells, double most, double *shape);

/** Returns whether a cell of this shape is bad for a surface sampled with density r: whether its radius in the co-cone
 *  exceeds 1.3 r / (1 - r) times the distance to the nearer pole. */
bool brio_cell_is_bad(double shape, double density);

#endif
