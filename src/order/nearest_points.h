/* The nearest points of a point. */
#ifndef BRIO_ORDER_NEAREST_POINTS_H
#define BRIO_ORDER_NEAREST_POINTS_H

#include "base/context.h"

/** A balanced k-d tree: of every range the middle point cuts at its own coordinate. */
typedef struct {
    size_t count;
    double (*point)[3]; /* in the order of the tree */
    uint8_t *axis;      /* across which a point cuts the range that it is the middle of */
} brio_point_tree;

/** A tree of points, which it copies; to be freed on failure too.   threads  that build it.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_point_tree_new(brio_context *ctx, const double *points, size_t count, brio_point_tree *out);
void brio_point_tree_free(brio_context *ctx, brio_point_tree *tree);

typedef struct {
    double square; /* of the distance */
    const double *point;
} brio_near_point;

/** near[0 .. result) = the `wanted` points nearest to p, fewer where there are fewer; p itself and its duplicates are
 *  among them. By distance, then lexicographic; which points at the distance of the last one are left out is not said. */
size_t brio_nearest_points(const brio_point_tree *tree, const double *p, size_t wanted, brio_near_point *near);

#endif
