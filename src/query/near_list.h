/* The nearest points that a search has met so far. */
#ifndef BRIO_QUERY_NEAR_LIST_H
#define BRIO_QUERY_NEAR_LIST_H

#include "base/vector.h"
#include "query/nearest_points.h"
#include <assert.h>
#include <math.h>

/** A search lists each point it meets that is not farther than the bound. When the list is full, it keeps the `wanted`
 *  nearest points and lowers the bound to the distance of the last of them. */
typedef struct {
    const double (*point)[3];
    double p[3];           /* the points nearest to this position are wanted */
    brio_near_point *near; /* BRIO_NEAR_ROOM entries, in the order in which the search met them */
    size_t size, wanted;
    double bound;    /* square of a distance; no farther point is among the nearest */
    size_t met;      /* points that the search looked at */
    size_t compared; /* pairs of points at the bound that were compared: what ties cost */
} brio_near_list;

static inline brio_near_list brio_near_list_for(const double (*point)[3], const double *p, size_t wanted,
                                                brio_near_point *near) {
    return (brio_near_list){.point = point, .p = {p[0], p[1], p[2]}, .near = near, .wanted = wanted, .bound = INFINITY};
}

static inline bool brio_is_before_in_others(const double *a, const double *b, int axis) {
    int k = (axis + 1) % 3, l = (axis + 2) % 3;
    return a[k] != b[k] ? a[k] < b[k] : a[l] < b[l];
}

/** Returns whether a comes before b along an axis; the other two coordinates break ties. */
static inline bool brio_is_before(const double *a, const double *b, int axis) {
    return a[axis] != b[axis] ? a[axis] < b[axis] : brio_is_before_in_others(a, b, axis);
}

/** Keeps the nearest `wanted` points of a list that has as many, in the list's order. Sets the bound to the distance of
 *  the last of them. Among points at the bound the lexicographically first ones are kept, among duplicates those of the
 *  lowest places. Takes time in proportion to the list's length, also where all distances are equal. */
void brio_keep_nearest(brio_near_list *l);

/** Lists the points begin to end - 1, at most BRIO_TREE_LEAF, that are within the bound. A point beyond the bound is
 *  written too, and overwritten next. */
static inline void brio_offer_points(brio_near_list *l, size_t begin, size_t end) {
    assert(begin <= end && end - begin <= BRIO_TREE_LEAF && 0 < l->wanted && l->wanted <= BRIO_MOST_NEAR);
    if (l->size >= 2 * l->wanted) brio_keep_nearest(l);
    l->met += end - begin;
    for (size_t i = begin; i < end; i++) {
        double square = brio_square_distance(l->p, l->point[i]);
        assert(l->size < BRIO_NEAR_ROOM);
        l->near[l->size] = (brio_near_point){square, (uint32_t)i};
        l->size += square <= l->bound;
    }
}

/** Returns whether no other point changes the list: `wanted` points are where the search is. Others there would only
 *  replace duplicates, and a search that met all of n duplicates would take n steps. */
static inline bool brio_is_settled(const brio_near_list *l) {
    return l->bound == 0 && l->size >= l->wanted;
}

/** Lists the points of a tree that are within the bound, and any number of others. */
void brio_offer_tree(brio_near_list *l, const brio_point_tree *tree);

/** Sorts points by distance, then lexicographically. */
void brio_sort_near_list(const double (*point)[3], brio_near_point *near, size_t count);

#endif
