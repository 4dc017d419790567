/* What of a surface its points do not show, and what of the points it leaves, as facts. */
#ifndef BRIO_CLI_COVERAGE_H
#define BRIO_CLI_COVERAGE_H

#include "cli/run/run.h"

/** Reports the bridges of any surface and its area far from all points, and warns of them; and the points that it
 *  leaves out. */
brio_status cli_report_coverage(run *r, const brio_mesh *surface, const brio_mesh *points);

/** Counts the points that a surface leaves out, reports and warns of them, and writes them to a file, with their
 *  properties.
 *  path  NULL: they are not written. */
brio_status cli_report_left_out(run *r, const brio_mesh *surface, const brio_mesh *points, const char *path);

#endif
