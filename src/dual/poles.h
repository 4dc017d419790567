/* The poles of samples: the farthest Voronoi vertices of their cells on either side. */
#ifndef BRIO_DUAL_POLES_H
#define BRIO_DUAL_POLES_H

#include "base/context.h"

enum { BRIO_NO_POLE = UINT32_MAX };

/** Polar balls, numbered canonically: by their centres along a Hilbert curve, then lexicographic, so that the numbers
 *  do not depend on the order of the samples and neighbours in space are neighbours in memory. A pole is a Delaunay
 *  tetrahedron: two of them may have the same centre. */
typedef struct {
    size_t count;
    double *centre;      /* #poles by 3 */
    double *square;      /* squared radii */
    uint8_t *bounding;   /* 1: the tetrahedron has a bounding point */
    size_t bad_cells;    /* samples that had poles discarded */
    double *shape;       /* of the samples' cells, as brio_cell_shapes; NULL when not asked for */
    uint32_t *of_sample; /* #samples by 2: the farther pole and the one on its other side, or BRIO_NO_POLE */
} brio_poles;

/** Which poles of badly shaped cells are discarded, and whether shapes are wanted all the same. */
typedef struct {
    double sampling_density; /* r of brio_cell_is_bad, in (0, 1); 0: no cell is bad */
    bool both;               /* both poles, not the nearer one only */
    double shapes;           /* > 0: the shapes of cells are wanted, up to this */
} brio_pole_filter;

/** Finds the poles of the first num_samples of the points that t triangulates; the points after them only bound the
 *  cells and have no poles, nor do duplicates.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_poles_find(brio_context *ctx, const brio_triangulation *t, const double *points, size_t num_samples,
                            const brio_pole_filter *filter, brio_poles *out);

void brio_poles_free(brio_context *ctx, brio_poles *poles);

#endif
