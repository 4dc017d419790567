/* Points that no caller can have: too many of them, and coordinates and weights that are no numbers. */
#ifndef BRIO_BASE_FINITE_H
#define BRIO_BASE_FINITE_H

#include "base/context.h"
#include <stdbool.h>
#include <stddef.h>

/** Refuses a number of points that no array has, before anything is read by it.
 *  Returns BRIO_OK, BRIO_ERR_TOO_LARGE. */
brio_status brio_refuse_many(brio_context *ctx, size_t num_points);

/** Points that are no numbers, counted over the parts of an array. */
typedef struct brio_not_finite {
    uint64_t count, first; /* their number, and the index of the first one */
    const char *axis, *what;
} brio_not_finite;

/** Counts such points among rows `first` to first + num_points - 1, whose coordinates are in `points`. */
void brio_count_not_finite(brio_not_finite *found, uint64_t first, const double *points, const double *weights,
                           size_t num_points);

/** Refuses what was counted, as brio_refuse_not_finite does. */
brio_status brio_refuse_counted(brio_context *ctx, const brio_not_finite *found, const char *file);

/** Returns whether all numbers are finite. */
static inline bool brio_all_finite(const double *numbers, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += 0 * numbers[i];
    return sum == 0; /* else NaN */
}

/** Refuses vertices with a coordinate that is not finite; the message names the first such vertex and the mesh.
 *  vertices  #V by 3.   mesh  what the mesh is called in the message, such as "the solid".
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE. */
brio_status brio_refuse_vertices(brio_context *ctx, const double *vertices, size_t num_vertices, const char *mesh);

/** Refuses records, one of which is not finite, with the same message; the first of them in the input's order is named.
 *  record  num_points by 4: x, y, z, weight.   order  the index of each in the input; NULL: as they are.
 *  Returns BRIO_ERR_NOT_FINITE. */
brio_status brio_refuse_records(brio_context *ctx, const double (*record)[4], const uint32_t *order, size_t num_points);

/** Refuses points with a coordinate or a weight that is not finite; the message names the first such point and how many
 *  there are.   points  #P by 3.   weights  #P, or NULL.   file  what the points were read from, or NULL.
 *  Returns BRIO_OK, BRIO_ERR_NOT_FINITE. */
brio_status brio_refuse_not_finite(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                   const char *file);

#endif
