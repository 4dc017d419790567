/* How much memory a command takes: the library's estimate for the work, and beside it the program and its input. */
#ifndef BRIO_CLI_ESTIMATE_H
#define BRIO_CLI_ESTIMATE_H

#include "run.h"

/** Bytes of the program itself, its libraries and small blocks. */
#define CLI_PROGRAM_BYTES 4.5e6

/** Returns the bytes of a mesh as it was read: its points, faces, tetrahedra and properties. */
double cli_mesh_bytes(const brio_mesh *mesh);

/** Estimates `brio delaunay` of a mesh; weights may be NULL. */
brio_status cli_delaunay_bytes(run *r, const brio_mesh *mesh, const double *weights, const brio_delaunay_options *o,
                               double *bytes);

/** Estimate the commands that go beyond one triangulation; weights may be NULL.
 *  vertices  whether the cells get vertices.   places  the points that are located, or NULL. */
double cli_hull_bytes(const brio_mesh *mesh);
double cli_alpha_bytes(const brio_mesh *mesh);
brio_status cli_voronoi_bytes(run *r, const brio_mesh *mesh, const double *weights, bool vertices, double *bytes);
brio_status cli_locate_bytes(run *r, const brio_mesh *mesh, const double *weights, const brio_mesh *places,
                             double *bytes);

/** Returns the estimate for `brio info`. */
double cli_info_bytes(const brio_mesh *mesh);

/** Refuses work over --max-memory.   status, work  from the library's estimate.   input  may be NULL. */
brio_status cli_require_work(run *r, brio_status status, const brio_mesh *input, uint64_t work);

#endif
