/* Nearest points of a query point. */
#ifndef BRIO_QUERY_NEAREST_POINTS_H
#define BRIO_QUERY_NEAREST_POINTS_H

#include "base/context.h"

/** Ranges of at most this many points are leaves of the tree: sorted, and not cut. */
enum { BRIO_TREE_LEAF = 24 };

/** A balanced k-d tree: the middle point of every range cuts the range at its coordinate along `axis`. The tree
 *  depends on the set of points only, not on their order, except for the indices of duplicates. */
typedef struct {
    size_t count;
    double (*point)[3]; /* in the order of the tree */
    uint32_t *index;    /* index of each point in the caller's array */
    uint8_t *axis;      /* axis along which a point cuts the range whose middle it is */
} brio_point_tree;

/** Builds a tree of points, which it copies. The caller frees the tree, also after a failure.
 *  Returns BRIO_OK, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_point_tree_new(brio_context *ctx, const double *points, size_t count, brio_point_tree *out);

/** Builds a tree as brio_point_tree_new does, of the points times 2^exponent. Squares of distances must be neither
 *  infinite nor 0, so points far from 1 are scaled. */
brio_status brio_point_tree_scaled(brio_context *ctx, const double *points, size_t count, int exponent,
                                   brio_point_tree *out);
void brio_point_tree_free(brio_context *ctx, brio_point_tree *tree);

typedef struct {
    double square;  /* of the distance */
    uint32_t place; /* in the order of the tree */
} brio_near_point;

/** Most points that a query may ask for, and the entries of room that a query needs (derived: at least two full
 *  lists and a leaf). */
enum { BRIO_MOST_NEAR = 64, BRIO_NEAR_ROOM = 2 * BRIO_MOST_NEAR + 32 };

/** Finds the `wanted` points nearest to p, or all points within the bound when there are fewer; returns their number.
 *  Writes them to near[0 .. result), in an order that depends on p and the set of points only. If p or duplicates of p
 *  are in the tree, they count. Among points at the distance of the last one, the lexicographically first ones are
 *  taken.
 *  wanted  1 to BRIO_MOST_NEAR.   bound  square of the largest distance allowed, or INFINITY; a smaller bound is
 *  faster.   near  BRIO_NEAR_ROOM entries. */
size_t brio_nearest_points(const brio_point_tree *tree, const double *p, size_t wanted, double bound,
                           brio_near_point *near);

/** Returns the least of `best` and the squared distances from p to the points. */
double brio_nearest_square(const brio_point_tree *tree, const double *p, double best);

/** Sorts points by distance, then lexicographically. */
void brio_sort_near_points(const brio_point_tree *tree, brio_near_point *near, size_t count);

#endif
