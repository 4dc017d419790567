/* The faces of a convex hull: convex polygons between strictly extreme points. */
#ifndef BRIO_HULL_HULL_FACES_H
#define BRIO_HULL_HULL_FACES_H

#include "hull/polytope.h"

/** Polygons, one after the other: polygon f has the corners corner[first[f]] to corner[first[f + 1] - 1]. */
typedef struct {
    uint64_t *first; /* #polygons + 1 */
    uint32_t *corner;
    size_t count;
} brio_hull_polygons;

/** Joins the triangles of each plane to one polygon, counterclockwise as seen from outside. The corners are the
 *  strictly extreme points, of coincident ones the record of the lowest index; the lexicographically least corner is
 *  first.
 *  out  owned by the caller (brio_hull_polygons_free).   Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_hull_faces(brio_context *ctx, const brio_polytope *p, const brio_hull_records *records,
                            brio_hull_polygons *out);

/** Finds the convex hull of records of dimension 2 as one polygon, of dimension 1 as a polygon of two corners, of
 *  dimension 0 of one. The polygon is seen counterclockwise from the end of the first of the axes z, x, y that is not
 *  parallel to its plane.
 *  corner  what brio_general_position found.   Returns as brio_hull_faces. */
brio_status brio_flat_hull(brio_context *ctx, const brio_hull_records *records, int dimension, const uint32_t *corner,
                           brio_hull_polygons *out);

/** Rotates a polygon so that its lexicographically least corner is first. */
void brio_rotate_polygon(const double (*record)[4], uint32_t *corner, size_t size);

void brio_hull_polygons_free(brio_context *ctx, brio_hull_polygons *polygons);

#endif
