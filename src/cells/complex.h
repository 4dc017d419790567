/* Cells of the vertices of a complex that is no triangulation of all its points: of a space that repeats. */
#ifndef BRIO_CELLS_COMPLEX_H
#define BRIO_CELLS_COMPLEX_H

#include "triangulation/tetrahedra.h"

/** All tetrahedra that have a site for a vertex, finite ones first. Mates across facets that have one are right; the
 *  others are the facet itself. */
typedef struct brio_cell_complex {
    brio_tetrahedron *tet; /* NULL: points of dimension 2 or less, triangulated here; the sites' neighbours are all there */
    size_t num_finite, count;
    const double *points, *weights; /* #P by 3; #P, or NULL */
    size_t num_points, num_sites;   /* the first points are the sites */
} brio_cell_complex;

/** Computes the cells of the sites, as brio_voronoi_cells does. Neighbours are indices of points.
 *  options  all fields are known.   out  as brio_voronoi_cells; NULL before. */
brio_status brio_cells_of_complex(brio_context *ctx, const brio_cell_complex *complex,
                                  const brio_cells_options *options, brio_cells **out);

#endif
