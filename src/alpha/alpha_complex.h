/* The order of the simplices of an alpha complex. */
#ifndef BRIO_ALPHA_ALPHA_COMPLEX_H
#define BRIO_ALPHA_ALPHA_COMPLEX_H

#include "base/context.h"

/** Returns the dimension of the simplex of that number, and sets *row to its place among those of its dimension. */
static inline int brio_simplex_of(const brio_alpha_complex *c, uint32_t number, size_t *row) {
    int k = 0;
    size_t at = number;
    for (; k < 3 && at >= c->counts[k]; k++) at -= c->counts[k];
    *row = at;
    return k;
}

#endif
