/* How much memory a command takes: the library's estimate for the work, and beside it the program and its input. */
#ifndef BRIO_CLI_ESTIMATE_H
#define BRIO_CLI_ESTIMATE_H

#include "cli/run/run.h"

/** Bytes of the program itself, its libraries and small blocks. */
#define CLI_PROGRAM_BYTES 4.5e6

/** Returns the bytes of a mesh as it was read: its points, faces, tetrahedra and properties. */
double cli_mesh_bytes(const brio_mesh *mesh);

/** Estimates `brio delaunay` of a mesh; weights may be NULL. */
brio_status cli_delaunay_bytes(run *r, const brio_mesh *mesh, const double *weights, const brio_delaunay_options *o,
                               double *bytes);

/** Writes how many points have as many tetrahedra as the mesh's, if each has the usual number; never fewer than there
 *  are. What goes by the tetrahedra is estimated for that number of points. Without --max-memory, unless `asked`, it is
 *  the number of points. */
brio_status cli_usual_points(run *r, const brio_mesh *mesh, const double *weights, bool asked, size_t *points);

/** Estimate the commands that go beyond one triangulation.
 *  delaunay  of cli_delaunay_bytes.   usual  of cli_usual_points.
 *  vertices  whether the cells get vertices.   places  the points that are located, or NULL. */
double cli_hull_bytes(const brio_mesh *mesh);
double cli_alpha_bytes(const brio_mesh *mesh, size_t usual);
double cli_voronoi_bytes(double delaunay, size_t usual, bool vertices);
double cli_locate_bytes(const brio_mesh *mesh, double delaunay, const brio_mesh *places);

/** Returns the estimate for `brio info`. */
double cli_info_bytes(const brio_mesh *mesh);

/** Refuses work over --max-memory.   status, work  from the library's estimate.   input  may be NULL. */
brio_status cli_require_work(run *r, brio_status status, const brio_mesh *input, uint64_t work);

#endif
