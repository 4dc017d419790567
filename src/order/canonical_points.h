/* A canonical order of points, which does not depend on the order of the input. */
#ifndef BRIO_ORDER_CANONICAL_POINTS_H
#define BRIO_ORDER_CANONICAL_POINTS_H

#include "base/context.h"
#include "predicates/predicates.h"

/** Fails for coordinates that are not finite, and for more points than indices can name.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE. */
brio_status brio_refuse_points(brio_context *ctx, const double *points, size_t num_points);

/** Allocates *order and fills it: order[r] = the index of the point of rank r. Ranks go along a Hilbert curve, then
 *  lexicographically, then, for coincident points, by index. So the position of rank r depends only on the multiset of
 *  positions, and not on the order of the points or the number of threads.
 *  points  #P by 3, finite.   order  #P, owned by the caller (brio_release), on failure NULL.
 *  Needs 16 bytes of workspace for each point.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_canonical_points(brio_context *ctx, const double *points, size_t num_points, uint32_t **order);

/** Copies point order[i] to row i of `rows`. */
void brio_copy_points(const double *points, const uint32_t *order, size_t num_points, double *rows);

/** Replaces each index in a canonical order by the lowest index at its position, so that coincident points share one
 *  index. */
void brio_name_coincident(const double *points, size_t num_points, uint32_t *order);

/** Compares points by position, then by index; `points` is the array. */
static inline int brio_compare_points(uint32_t a, uint32_t b, const void *points) {
    int sign = brio_lexicographic((const double *)points + 3 * (size_t)a, (const double *)points + 3 * (size_t)b);
    return sign ? sign : (a > b) - (a < b);
}

#endif
