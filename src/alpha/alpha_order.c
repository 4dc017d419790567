/* The order in which simplices enter the alpha complex: by value, then dimension, then vertices. */
#include "alpha/alpha_complex.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"

static int compare_simplices(uint32_t a, uint32_t b, const void *user) {
    const brio_alpha_complex *c = user;
    size_t i, j;
    int k = brio_simplex_of(c, a, &i), l = brio_simplex_of(c, b, &j);
    if (k != l) return k < l ? -1 : 1;
    const uint32_t *v = c->simplices[k] + i * (size_t)(k + 1), *w = c->simplices[k] + j * (size_t)(k + 1);
    for (int n = 0; n <= k; n++)
        if (v[n] != w[n]) return v[n] < w[n] ? -1 : 1;
    return 0;
}

brio_status brio_alpha_order(brio_context *ctx, const brio_alpha_complex *complex, uint32_t *order) {
    BRIO_DOOR;
    size_t total = complex->counts[0] + complex->counts[1] + complex->counts[2] + complex->counts[3];
    for (size_t i = 0; i < total; i++) order[i] = (uint32_t)i;
    const brio_row_order by = {complex->values[0], 1, compare_simplices, complex}; /* the four arrays are one */
    return brio_sort_rows(ctx, &by, order, total);
}
