/* Insertion orders by blocks: the points block after block, depth first, shuffled inside a block; in random rounds or
 * in one.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, sections 5.3 and 5.8. */
#include "laboratory/blocks.h"
#include "base/memory.h"
#include "base/rng.h"
#include <assert.h>

enum { BLOCK_SIZE = 2000 };

static const double RATIO = 0.5; /* of the rounds, as in the papers */

static void shuffle_block(uint32_t *index, const brio_block *block, const void *user) {
    const brio_delaunay_options *options = user;
    brio_rng rng = brio_rng_new(brio_hash(options->seed, block->begin));
    uint32_t *a = index + block->begin;
    for (uint32_t i = (uint32_t)(block->end - block->begin); i > 1; i--) {
        uint32_t j = brio_rng_below(&rng, i), swap = a[i - 1];
        assert(j < i);
        a[i - 1] = a[j], a[j] = swap;
    }
}

brio_status brio_block_order(const void *user, brio_context *ctx, const brio_input *input,
                             const brio_delaunay_options *options, const brio_ordering *out) {
    brio_status status = BRIO_OK;
    const brio_laboratory_options *lab = user;
    size_t n = input->count;
    bool in_rounds = lab->order != BRIO_BLOCKS_OCTREE;
    uint32_t *index = in_rounds ? NULL : out->order, *spare = in_rounds ? out->order : NULL;
    brio_round_ends ends = {1, {n}};
    double ratio = options->round_ratio > 0 ? options->round_ratio : RATIO;
    size_t block_size = lab->block_size ? lab->block_size : BLOCK_SIZE;
    if (in_rounds) BRIO_TRY(BRIO_ALLOC(ctx, index, n));
    brio_blocks blocks = {input->points, n, block_size, index, shuffle_block, options};
    if (lab->order == BRIO_BLOCKS_BRIO_KDTREE) {
        BRIO_TRY(brio_kdtree_blocks(ctx, &blocks));
    } else {
        if (!spare) BRIO_TRY(BRIO_ALLOC(ctx, spare, n));
        BRIO_TRY(brio_octree_blocks(ctx, &blocks, spare));
    }
    if (in_rounds)
        BRIO_TRY(brio_divide_into_rounds(
            ctx, &(brio_division){index, input->weights, n, ratio, options->seed, out->order, out->rank, NULL}, &ends));
    else
        for (size_t i = 0; out->rank && i < n; i++) out->rank[i] = (uint32_t)i;
    if (out->rounds) *out->rounds = ends;
done:
    if (index != out->order) brio_release(ctx, index);
    if (spare != out->order) brio_release(ctx, spare);
    return status;
}
