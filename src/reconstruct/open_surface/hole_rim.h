/* Whether the samples end where a hole begins. */
#ifndef BRIO_RECONSTRUCT_HOLE_RIM_H
#define BRIO_RECONSTRUCT_HOLE_RIM_H

#include "query/point_boxes.h"
#include "reconstruct/open_surface/triangle_net.h"

/** What looks at rims. */
typedef struct {
    const brio_triangle_net *net;
    const double *usual;    /* #F */
    brio_point_boxes boxes; /* of all samples, those that are on no triangle included */
    size_t *first;          /* as brio_net_leaving lists them */
    uint32_t *leaving;
} brio_rim_view;

/** Makes the samples ready.   out  freed with brio_rim_view_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_rim_view_new(const brio_triangle_net *n, const double *usual, brio_rim_view *out);
void brio_rim_view_free(brio_rim_view *v);

/** Counts the neighbours of the samples at the rim of a hole that are beyond the rim, along the surface, against those
 *  on the other side: 0 where the samples end, about 1 where they go on.
 *  hole     the triangles of the hole, `count` of them.
 *  in_hole  #F: whether a triangle belongs to a hole, this or another.
 *  beyond   receives the ratio.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_rim_beyond(const brio_rim_view *v, const uint32_t *hole, size_t count, const uint8_t *in_hole,
                            double *beyond);

#endif
