/* What the uses of an alpha complex share.
 *
 * Simplices of a triangulation in space come in the order of its tetrahedra: facets by the lower one of their two
 * handles, edges by the first tetrahedron that has them and then by their slots. src/balls relies on it. */
#ifndef BRIO_ALPHA_ALPHA_COMPLEX_H
#define BRIO_ALPHA_ALPHA_COMPLEX_H

#include "base/context.h"
#include <assert.h>

/** Returns the dimension of the simplex of that number, and sets *row to its place among those of its dimension. */
static inline int brio_simplex_of(const brio_alpha_complex *c, uint32_t number, size_t *row) {
    int k = 0;
    size_t at = number;
    for (; k < 3 && at >= c->counts[k]; k++) at -= c->counts[k];
    *row = at;
    assert(at < c->counts[k]); /* numbers are those of simplices */
    return k;
}

/** Counts the singular simplices of a dimension: those of the complex at alpha of which no tetrahedron is in it. */
static inline size_t brio_count_singular(const brio_alpha_complex *c, int dimension, double alpha) {
    size_t count = 0;
    for (size_t i = 0; i < c->counts[dimension]; i++)
        count += c->values[dimension][i] <= alpha && c->solid[dimension][i] > alpha;
    return count;
}

/** Tetrahedra of which one of each class of translates counts, or those of a part of space. Points are numbered in an
 *  order that all classes, or all parts, share, so that a simplex begins with its least vertex. It counts if that
 *  vertex is own. All tetrahedra at own points are there, and mates across facets that have an own point; other mates
 *  are the facet itself. */
typedef struct brio_alpha_input {
    brio_tetrahedron *tet; /* finite ones first; not changed */
    size_t num_finite, count;
    const double *points, *weights; /* weights: NULL without */
    size_t num_points;
    const uint8_t *own; /* #points */
} brio_alpha_input;

/** Finds the values of all tetrahedra of the input, of facets and edges that have an own point, and of own vertices. Of
 *  these, tetrahedra, facets and edges that count have the values of the whole complex; of the others, values may be
 *  greater.   out  without a triangulation; freed with brio_alpha_complex_free.   Returns as brio_alpha_values. */
brio_status brio_alpha_of_stars(brio_context *ctx, const brio_alpha_input *input, brio_alpha_complex *out);

/** Finds the values of the simplices that count. Simplices that are translates have values of the same bits, if all
 *  differences of coordinates are exact.   out  without a triangulation; freed with brio_alpha_complex_free.
 *  Returns as brio_alpha_values. */
brio_status brio_alpha_of_classes(brio_context *ctx, const brio_alpha_input *input, brio_alpha_complex *out);

/** Tetrahedra or triangles, as numbers: `corners` vertices and as many mates, handles 4 * cell + slot. */
typedef struct brio_alpha_cells {
    const uint32_t *numbers;
    size_t corners, num_points;
} brio_alpha_cells;

/** Finds what brio_alpha_auto does.   cells  of the complex, finite ones first.   Returns as brio_alpha_auto. */
brio_status brio_alpha_auto_of(brio_context *ctx, const brio_alpha_complex *complex, const brio_alpha_cells *cells,
                               double *alpha);

/** Refuses an alpha closer to 0 than the least normal double: squared radii have few bits or none there, and those that
 *  differ become equal. Accepts any alpha where a vertex has a value that is not so small: weights do that.
 *  greatest  of the absolute values of vertices.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER. */
brio_status brio_refuse_small_alpha(brio_context *ctx, double greatest, double alpha);

#endif
