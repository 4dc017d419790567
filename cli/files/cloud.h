/* Facts of a set of points that need no triangulation, and thresholds that distances equal up to rounding. */
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

/** Returns by how much the rounding of coordinates may change distances between points of a mesh. */
double cli_rounding(const brio_mesh *mesh);

/** Returns the greatest distance that counts as equal to a threshold, by a rounding that is at most 2^-14 of it. So a
 *  grid whose spacing no double holds is treated alike all over. */
double cli_up_to(double threshold, double rounding);

#endif
