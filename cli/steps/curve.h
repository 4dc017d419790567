/* Curves and other edges: brio surface of points in a plane, and what brio tree needs of it. */
#ifndef BRIO_CLI_CURVE_H
#define BRIO_CLI_CURVE_H

#include "cli/steps/power_crust.h"

/** Sets *flat to whether `brio surface` makes curves of these points without being asked: they are in a plane, as
 *  brio_curve sees it, on no line, and more than three. All are looked at only where a few are in a plane. */
brio_status cli_is_flat(run *r, const brio_mesh *points, bool *flat);

/** Refuses an output whose format holds no edges. */
brio_status cli_require_edges(run *r);

/** Makes curves, reports them with their certificate, and gives them the properties of the points.
 *  open  of brio_curve_options.   closed  the same. */
brio_status cli_curve(run *r, const brio_mesh *points, double open, bool closed, brio_mesh **out);

/** Makes the power crust of points in a plane, as cli_curve. Refuses options of the one in space, once the points are
 *  known to be in a plane.   any_labeling  none was asked for. */
brio_status cli_planar_crust(run *r, const brio_mesh *points, const power_crust_options *options, bool any_labeling,
                             brio_mesh **out);

/** Makes the power shape of points in a plane, and their power crust, and reports them as `brio medial` does. */
brio_status cli_planar_shape(run *r, const brio_mesh *points, brio_mesh **crust, brio_mesh **shape);

/** Reports the certificate of the edges of a mesh.   corners  NULL where they were not looked for.
 *  delaunay  the edges are of one Delaunay triangulation, so that none cross.   found  NULL, or receives it. */
brio_status cli_certify_edges(run *r, const brio_mesh *mesh, const size_t *corners, bool delaunay,
                              brio_curve_certificate *found);

/** Reports the certificate of the edges of a file; BRIO_ERR_CHECK where they branch, or end and are not to. */
brio_status cli_check_edges(run *r, const brio_mesh *mesh, bool open);

/** Refuses gaps of curves that are shorter than what they are held against.   open  in links; NaN: not given. */
brio_status cli_check_curve_gaps(run *r, double open);

#endif
