/* The nearest points of a point. */
#ifndef BRIO_QUERY_NEAREST_POINTS_H
#define BRIO_QUERY_NEAREST_POINTS_H

#include "base/context.h"

/** A balanced k-d tree: of every range the middle point cuts at its own coordinate. It is a function of the set of
 *  points, whatever their order, but for the index of duplicates. */
typedef struct {
    size_t count;
    double (*point)[3]; /* in the order of the tree */
    uint32_t *index;    /* the caller's, of each point */
    uint8_t *axis;      /* across which a point cuts the range that it is the middle of */
} brio_point_tree;

/** A tree of fewer than 2^32 points, which it copies; to be freed on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_point_tree_new(brio_context *ctx, const double *points, size_t count, brio_point_tree *out);
void brio_point_tree_free(brio_context *ctx, brio_point_tree *tree);

typedef struct {
    double square;  /* of the distance */
    uint32_t place; /* in the order of the tree */
} brio_near_point;

/** What is asked for at most, and the room that it takes. */
enum { BRIO_MOST_NEAR = 64, BRIO_NEAR_ROOM = 2 * BRIO_MOST_NEAR + 32 };

/** near[0 .. result) = the `wanted` points nearest to p, fewer where there are fewer, in an order that depends on p and
 *  the set of points alone; p itself and its duplicates are among them. Of points at the distance of the last one those
 *  count that come first lexicographically.
 *  wanted  1 to BRIO_MOST_NEAR.   bound  none of them is farther than that, squared, or INFINITY; the less the sooner.
 *  near  BRIO_NEAR_ROOM. */
size_t brio_nearest_points(const brio_point_tree *tree, const double *p, size_t wanted, double bound,
                           brio_near_point *near);

/** The least of `best` and the squared distances from p to the points. */
double brio_nearest_square(const brio_point_tree *tree, const double *p, double best);

/** Puts points in order: by distance, then lexicographic. */
void brio_sort_near_points(const brio_point_tree *tree, brio_near_point *near, size_t count);

#endif
