/* The poles of samples: the farthest Voronoi vertices of a sample's cell on either side of the surface. */
#ifndef BRIO_DUAL_POLES_H
#define BRIO_DUAL_POLES_H

#include "base/context.h"

enum { BRIO_NO_POLE = UINT32_MAX };

/** Polar balls, numbered canonically: by their centres along a Hilbert curve, then lexicographically. So the numbers do
 *  not depend on the order of the samples, and neighbours in space are neighbours in memory. A pole is a Delaunay
 *  tetrahedron: two poles may have equal centres. */
typedef struct {
    size_t count;
    double *centre; /* #poles by 3 */
    double *square; /* #poles: squared radii */
    uint32_t
        *touched; /* #poles by 4: the points on the ball, the corners of its tetrahedron; those from #samples on are
                            bounding points */
    uint8_t *bounding;   /* #poles: 1 when a vertex of the tetrahedron is a bounding point, not a sample */
    size_t bad_cells;    /* number of samples with a bad cell, whose poles were discarded */
    double *shape;       /* #samples: the results of brio_cell_shapes; NULL unless the filter needs shapes */
    uint32_t *of_sample; /* #samples by 2: the farther pole and the pole on the other side, or BRIO_NO_POLE */
} brio_poles;

/** Which poles of badly shaped cells are discarded, and whether the caller wants the shapes of cells. */
typedef struct {
    double sampling_density; /* the density r of brio_cell_is_bad, in (0, 1); 0: no cell is bad */
    bool both;               /* true: discard both poles of a bad cell; false: only the nearer pole */
    double shapes;           /* > 0: compute the shapes of cells up to this value; 0: only if the density needs them */
} brio_pole_filter;

/** Finds the poles of the first num_samples points of t. The later points only bound the cells: they have no poles.
 *  Duplicates have no poles either.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_poles_find(brio_context *ctx, const brio_triangulation *t, const double *points, size_t num_samples,
                            const brio_pole_filter *filter, brio_poles *out);

void brio_poles_free(brio_context *ctx, brio_poles *poles);

#endif
