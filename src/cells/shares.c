/* Shares of tetrahedra, in as much precision as each centre needs: share_lanes.h works in doubles, and centres that
 * need more come from brio_centres. */
#include "cells/shares.h"
#include "base/instruction_set.h"
#include <math.h>
#include <string.h>

static const brio_share_engine *engine(void) {
    static const brio_share_engine *const OF_SET[] = {
        &brio_shares_plain,
#if defined(__x86_64__)
        &brio_shares_avx2,
        &brio_shares_avx512,
#endif
    };
    return OF_SET[brio_instructions()];
}

void brio_shares(const brio_share_batch *b) {
    uint64_t every = b->count < 64 ? (UINT64_C(1) << b->count) - 1 : UINT64_MAX, left = engine()->find(b, every);
    if (!left) return;
    uint32_t vertex[BRIO_CENTRE_BATCH][4];
    double centre[BRIO_CENTRE_BATCH][3], error[BRIO_CENTRE_BATCH];
    size_t n = 0;
    for (uint64_t bits = left; bits; bits &= bits - 1)
        memcpy(vertex[n++], b->vertex[__builtin_ctzll(bits)], 4 * sizeof **vertex);
    brio_centres(&(brio_centre_batch){b->points, b->weights, (const uint32_t(*)[4])vertex, n}, centre[0], error);
    n = 0;
    for (uint64_t bits = left; bits; bits &= bits - 1, n++) {
        size_t at = (size_t)__builtin_ctzll(bits);
        bool known = !isnan(centre[n][0]);
        for (int k = 0; k < 3; k++) b->centre[at][k] = known ? centre[n][k] : NAN;
        b->error[at] = known ? error[n] : NAN;
    }
    engine()->find_of_centres(b, left);
}
