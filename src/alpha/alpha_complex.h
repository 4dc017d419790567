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

/** Refuses an alpha closer to 0 than the least normal double: squared radii have few bits or none there, and those that
 *  differ become equal. Accepts any alpha where a vertex has a value that is not so small: weights do that.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER. */
brio_status brio_refuse_small_alpha(brio_context *ctx, const brio_alpha_complex *complex, double alpha);

#endif
