/* What the filtrations of triangulations of space and of the plane share: values of single simplices and of
 * vertices. */
#ifndef BRIO_ALPHA_SIMPLEX_VALUES_H
#define BRIO_ALPHA_SIMPLEX_VALUES_H

#include "base/context.h"

/** The points of a triangulation. */
typedef struct {
    double (*of)[4]; /* #P: x, y, z (0 in the plane), and the weight or 0 */
    bool weighted;
} brio_records;

/** Makes the records of points of 2 or 3 coordinates; `of` is freed with brio_release.   weights  #P, or NULL. */
brio_status brio_records_take(brio_context *ctx, const double *points, int coordinates, const double *weights,
                              size_t num_points, brio_records *out);

/** Copies vertices in ascending order. */
void brio_put_simplex(const uint32_t *from, int count, uint32_t *to);

/** Returns the squared radius of a simplex. Its vertices are in ascending order, so that the result has the same bits
 *  wherever the simplex was found. */
double brio_own_value(const brio_records *records, const uint32_t *vertex, int count);

/** Returns whether a vertex is strictly inside the smallest orthosphere of an edge or a triangle; exact. */
bool brio_is_inside(const brio_records *records, const uint32_t *vertex, int count, uint32_t other);

/** Allocates the arrays of a complex whose counts are set. */
brio_status brio_alpha_room(brio_context *ctx, brio_alpha_complex *complex);

/** Finds the values of vertices from the edges, which are complete.   place  #P: the number of each vertex. */
brio_status brio_find_vertex_values(brio_context *ctx, brio_alpha_complex *complex, const brio_records *records,
                                    const uint32_t *place);

#endif
