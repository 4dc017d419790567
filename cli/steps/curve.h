/* Curves and other edges: brio surface of points in a plane, and what brio tree needs of it. */
#ifndef BRIO_CLI_CURVE_H
#define BRIO_CLI_CURVE_H

#include "cli/run/run.h"

/** Sets *flat to whether `brio surface` makes curves of these points without being asked: they may be in a plane, are
 *  on no line, and more than three. A few points decide, so that it costs nothing where they are not; brio_curve then
 *  looks at all. */
brio_status cli_may_be_flat(run *r, const brio_mesh *points, bool *flat);

/** Refuses an output whose format holds no edges. */
brio_status cli_require_edges(run *r);

/** Makes curves, reports them with their certificate, and gives them the properties of the points.
 *  open  of brio_curve_options.   closed  the same. */
brio_status cli_curve(run *r, const brio_mesh *points, double open, bool closed, brio_mesh **out);

#endif
