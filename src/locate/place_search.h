/* Exact searches for vertices in the k-d tree of a locator. */
#ifndef BRIO_LOCATE_PLACE_SEARCH_H
#define BRIO_LOCATE_PLACE_SEARCH_H

#include "locate/locator.h"

/** A vertex that a search has found. Its value, the squared distance or the power distance, is rounded; the terms of
 *  the value sum to `magnitude` at most, so that the error is at most 5 u magnitude. */
typedef struct {
    double value, magnitude;
    uint32_t place;
} brio_found;

/** Finds the `wanted` vertices of least power distance from x or, with power false, the nearest ones; among equal ones,
 *  those that come first lexicographically. Exact. Writes them in ascending order to found[0 .. result); the result is
 *  less than `wanted` only if there are fewer vertices.
 *  x  finite.   hint  a place to start from, or BRIO_INFINITE. */
size_t brio_search_places(const brio_locator *l, const double *x, bool power, size_t wanted, uint32_t hint,
                          brio_found *found);

/** Returns a vertex near x: the middle of the leaf of the tree where x would be. There is a vertex. */
uint32_t brio_place_near(const brio_locator *l, const double *x);

#endif
