/* The shape of Voronoi cells: long and thin across a well sampled surface, and not where samples are too few. */
#ifndef BRIO_DUAL_CELL_SHAPE_H
#define BRIO_DUAL_CELL_SHAPE_H

#include "base/context.h"

/** Voronoi cells, as their dual. */
typedef struct {
    const brio_tetrahedron *tet; /* the finite ones first */
    size_t num_finite;
    const double *centre; /* of each finite tetrahedron by 3; NaN where there is none */
    const double *points;
    size_t num_samples;      /* the first of the points */
    const uint32_t *pole_of; /* of each sample by 2: the tetrahedra of the farther and the nearer pole, or UINT32_MAX */
} brio_cells;

/** shape[s], #samples: the distance from sample s to its nearer pole over the radius of its cell in the co-cone, the
 *  largest distance to a point of an edge of the cell within pi / 8 of the plane through s across the direction to the
 *  farther pole. Large for long, thin cells; about `most` where it is more, and without a nearer pole. */
void brio_cell_shapes(brio_context *ctx, const brio_cells *cells, double most, double *shape);

/** Whether a cell is badly shaped for a surface sampled with density r: its radius in the co-cone is over
 *  1.3 r / (1 - r) times the distance to the nearer pole. */
bool brio_cell_is_bad(double shape, double density);

#endif
