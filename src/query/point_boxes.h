/* Boxes about runs of points, for some queries of nearest points. */
#ifndef BRIO_QUERY_POINT_BOXES_H
#define BRIO_QUERY_POINT_BOXES_H

#include "query/nearest_points.h"

typedef struct {
    double low[3], high[3];
} brio_box;

enum { BRIO_BOX_LEVELS = 12 };

/** Boxes about RUN consecutive points, then about FAN consecutive boxes of the level below, up to a single box. Built
 *  in one pass over the points: a thirtieth of the time of a tree (nearest_points.h). Queries are fast where points
 *  that are neighbours in memory are neighbours in space. */
typedef struct {
    size_t count;
    const double (*point)[3];
    brio_box *box; /* level after level */
    int levels;
    size_t first[BRIO_BOX_LEVELS + 1]; /* the boxes of a level are box[first[level]] to box[first[level + 1] - 1] */
} brio_point_boxes;

/** Builds boxes of at most 2^32 - 2 points, which must outlive them.   points  #P by 3, finite.   out  freed with
 *  brio_point_boxes_free, on failure too.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_point_boxes_new(brio_context *ctx, const double *points, size_t count, brio_point_boxes *out);
void brio_point_boxes_free(brio_context *ctx, brio_point_boxes *boxes);

/** Finds the `wanted` points nearest to a point, which is among them; returns their number. Writes them to near[0 ..
 *  result), sorted by distance, then lexicographically, whatever the order of the points. A `place` is the index of a
 *  point.   wanted  1 to BRIO_MOST_NEAR.   near  BRIO_NEAR_ROOM entries. */
size_t brio_nearest_in_boxes(const brio_point_boxes *boxes, size_t point, size_t wanted, brio_near_point *near);

#endif
