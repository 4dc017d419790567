/* brio/estimate.h: how much memory a call will take.
 *
 * Each estimates the bytes that the function of its name holds at its peak, the result included and the caller's arrays
 * not. The estimates are within 15 % on the inputs of docs/measured/performance.md; other inputs can need more. To make
 * sure, set the limit of the context: work over it fails with BRIO_ERR_NO_MEMORY.
 */
#ifndef BRIO_ESTIMATE_H
#define BRIO_ESTIMATE_H

#include "triangulation.h"
#include "periodic.h"
#include "surface.h"
#include "medial.h"
#include "offset.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Estimates the memory of brio_delaunay for these points and the threads of the context. Triangulates the surroundings
 *  of twelve points to learn how many tetrahedra a point there are.   options  NULL for the defaults.
 *  Cost: about 20,000 insertions and fifty passes over the points.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (as brio_delaunay), BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_estimate_delaunay(brio_context *ctx, const double *points, const double *weights,
                                            size_t num_points, const brio_delaunay_options *options, uint64_t *bytes);

/** Estimates how many tetrahedra, infinite ones included, brio_delaunay will have for these points: 6.8 a point where
 *  they are spread evenly or scanned, and up to as many as there are points on curves. Cost and errors as
 *  brio_estimate_delaunay. */
BRIO_API brio_status brio_estimate_tetrahedra(brio_context *ctx, const double *points, const double *weights,
                                              size_t num_points, uint64_t *tetrahedra);

/** Estimates the memory of brio_delaunay_periodic. What is completed beside gaps is estimated from up to 4,096 of the
 *  points: of gaps that these do not show, which are narrow, there may be a tenth more. An estimate over the limit of
 *  the context leaves out what is completed.
 *  Cost: that of brio_estimate_delaunay, and brio_delaunay_periodic for 4,096 and for 1,024 of the points.
 *  Errors as brio_estimate_delaunay, and those of brio_delaunay_periodic for a cell that it refuses. */
BRIO_API brio_status brio_estimate_periodic(brio_context *ctx, const double *points, const double *weights,
                                            size_t num_points, const brio_periodic_options *options, uint64_t *bytes);

/** Returns the estimate for brio_delaunay2 and brio_delaunay2_flat of points without duplicates. */
BRIO_API uint64_t brio_estimate_delaunay2(size_t num_points, int weighted);

/** Estimates the memory of brio_surface for num_points samples. Samples of 6.8 tetrahedra each are assumed. Where
 *  brio_estimate_tetrahedra finds more, ask for the number of samples whose tetrahedra those are. Where poles
 *  coincide, as those of exact cylinders and tori do, power crusts need more.
 *  options  NULL for the defaults. Of them `method`, `polygons`, `simplify` and `pieces` count.
 *  Returns BRIO_OK or BRIO_ERR_ARGUMENT (no such method, or an impossible size). */
BRIO_API brio_status brio_estimate_surface(brio_context *ctx, size_t num_points, const brio_surface_options *options,
                                           uint64_t *bytes);

/** Estimates the memory of brio_power_shape for num_points samples, likewise. */
BRIO_API brio_status brio_estimate_power_shape(brio_context *ctx, size_t num_points,
                                               const brio_power_shape_options *options, uint64_t *bytes);

/** Estimates the memory of brio_mesh_offset, from the angles of the mesh's edges.   options  NULL for the defaults.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range, or as brio_mesh_offset), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_estimate_mesh_offset(brio_context *ctx, const brio_mesh *mesh, double distance,
                                               const brio_mesh_offset_options *options, uint64_t *bytes);

/** Returns the estimate for brio_mesh_subdivide of a mesh of num_faces triangles; levels below 1 count as 1, above 15
 *  as
 *  15. */
BRIO_API uint64_t brio_estimate_mesh_subdivide(size_t num_faces, int levels);
/** Returns the estimate for a brio_iso_surface of num_vertices vertices, the map or the atoms not included. */
BRIO_API uint64_t brio_estimate_iso_surface(size_t num_vertices);
#ifdef __cplusplus
}
#endif
#endif
