/* Facts of a set of points that need no triangulation. */
#ifndef BRIO_CLI_CLOUD_H
#define BRIO_CLI_CLOUD_H

#include "cli/run/run.h"

/** Finds the smallest and largest coordinates; not for 0 points. */
void cli_cloud_box(const double *points, size_t count, double low[3], double high[3]);

/** Counts points minus distinct positions. Expected O(n), 6 bytes a point. */
brio_status cli_cloud_duplicates(run *r, const double *points, size_t count, size_t *duplicates);

/** Counts distinct positions minus distinct positions in single precision: the points that rounding merges with others.
 *  The coordinates fit single precision. Cost: as cli_cloud_duplicates, twice. */
brio_status cli_cloud_merged(run *r, const double *points, size_t count, size_t *merged);

/** Finds the typical distance of a point to its nearest neighbour at another position: the median over a random choice
 *  of points, each searched exactly. 0 when no two positions differ. */
brio_status cli_cloud_spacing(run *r, const double *points, size_t count, double *spacing);

#endif
