/* The region that cells are clipped to: a convex polytope, the intersection of half-spaces. */
#ifndef BRIO_CELLS_REGION_H
#define BRIO_CELLS_REGION_H

#include "cells/polyhedron.h"

typedef struct brio_region {
    size_t num_planes;     /* 0: no region, nothing is clipped */
    double (*plane)[4];    /* unit outward normal n and offset d: inside is n . x <= d. Wall i is neighbour -1 - i. */
    double (*given)[4];    /* normals and offsets as the caller gave them, before origin and scale */
    double *terms;         /* the sum of the absolute terms of each plane[3], which bounds its rounding */
    brio_polyhedron shape; /* the polytope, relative to 0; its vertices know three of their walls */
    bool box;              /* whether the region is a box: then low and high are its corners */
    double low[3], high[3];
    double middle[3]; /* of the polytope's bounding box */
    double reach;     /* the longest side of that box */
    double volume;
} brio_region;

/** Makes the region.
 *  planes         num_planes by 4, finite: normal and offset; normals are not 0 and need not be unit vectors.
 *  origin, scale  positions are taken relative to the origin, then multiplied by the scale.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the half-spaces bound no polytope, or an empty one),
 *  BRIO_ERR_NO_MEMORY. The region is freed with brio_region_free in any case. */
brio_status brio_region_new(brio_context *ctx, const double *planes, size_t num_planes, const double origin[3],
                            double scale, brio_region *region);
void brio_region_free(brio_region *region);

/** Returns whether a point is over plane i. */
bool brio_region_is_over(const brio_region *region, size_t i, const double *x);

#endif
