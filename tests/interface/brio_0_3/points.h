/* brio/points.h: choosing points: thinning, outliers, and samples of a mesh. */
#ifndef BRIO_POINTS_H
#define BRIO_POINTS_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Thins points to a spacing: chooses points that are at least `spacing` from each other, such that every other point
 *  is less than `spacing` from a chosen one. Distances that are the spacing up to rounding, 2^-50 of the greatest
 *  coordinate, count as the spacing: a grid of the spacing 0.1 stays whole. No other point can be added, so the set has
 *  no holes that the points do not have. The chosen positions depend on the set of positions and the spacing only, and
 *  not on the order of the points or the number of threads; of coincident points the first one is chosen.
 *  points   #P by 3, finite.   spacing  finite, greater than 0.
 *  chosen   #P: receives 1 for chosen points, 0 for others.   num_chosen  NULL, or receives their number.
 *  Cost: linear in the number of points, if cells as wide as the spacing can be numbered in 63 bits; otherwise cells
 *  are wider, and cost the square of the points chosen in them. Memory: 24 bytes a point.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Cook 1986] for the property; docs/algorithms.md. */
BRIO_API brio_status brio_thin(brio_context *ctx, const double *points, size_t num_points, double spacing,
                               uint8_t *chosen, size_t *num_chosen);

/** Samples the faces of a mesh: no place of a face is farther than `spacing` from a sample. The samples are the
 *  vertices, and points of the faces that are half a spacing from all vertices and from each other.
 *  mesh  with at least one face of three corners.   spacing  finite, greater than 0, in the unit of the mesh.
 *  out   receives the samples, the vertices first, in their order; owned by the caller.
 *  Cost: linear in the area of the faces over the square of the spacing, about six points looked at for each sample, 80
 *  bytes each.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Cook 1986]; docs/algorithms.md. */
BRIO_API brio_status brio_mesh_samples(brio_context *ctx, const brio_mesh *mesh, double spacing, brio_mesh **out);

typedef struct brio_outliers_options {
    size_t size;
    double factor; /* finite, 1 or more; 0: 3 */
} brio_outliers_options;

/** Finds outliers. The spacing of a point is its mean distance to its nearest points, `neighbours` of them. A point is
 *  an outlier if its spacing is more than `factor` times the lower quartile of the spacings of these points, or if it
 *  is far beyond the spacings of all points: in logarithms 8 robust standard deviations above their median, and more
 *  than factor^2 times the median. Spacings that rounding alone tells apart count as equal, and so do those that only
 *  the rounding of the coordinates to doubles tells apart. So where points become sparse by and by none is an outlier.
 *  More than `neighbours` stray points that are close together are not found. Which positions are outliers does not
 *  depend on the order of the points or the number of threads.
 *  points   #P by 3, finite.   neighbours  1 to 63; 8 to 16 are usual.
 *  outlier  #P: receives 1 for outliers, 0 for others.
 *  Cost: O(n log n). Memory: 45 bytes a point.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Breunig 2000]; docs/algorithms.md. */
BRIO_API brio_status brio_outliers(brio_context *ctx, const double *points, size_t num_points, int neighbours,
                                   const brio_outliers_options *options, uint8_t *outlier);

#ifdef __cplusplus
}
#endif
#endif
