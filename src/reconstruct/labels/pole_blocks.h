/* Poles about the violated edges of a labeling, in blocks of poles that are near each other, and the blocks in rounds. */
#ifndef BRIO_RECONSTRUCT_POLE_BLOCKS_H
#define BRIO_RECONSTRUCT_POLE_BLOCKS_H

#include "reconstruct/labels/pole_graph.h"

/** Block b has the poles pole[b << bits] .. pole[(b + 1) << bits], the last one fewer. No edge joins two blocks of the
 *  same round, so that they can be worked on side by side; blocks without a violated edge are in no round. Nothing here
 *  depends on the number of threads. */
typedef struct {
    brio_context *ctx;
    size_t count;    /* poles */
    uint32_t *pole;  /* of each place */
    uint32_t *place; /* of each pole of the graph, or BRIO_NO_PLACE */
    int bits;
    size_t num_blocks, num_rounds;
    size_t *first_round; /* #rounds + 1: where the round begins in block[] */
    uint32_t *block;
} brio_pole_blocks;

enum { BRIO_NO_PLACE = UINT32_MAX };

/** Blocks of 2^bits poles: those at most some edges away from a violated one, and not fixed. What is found is to be freed
 *  on failure too.   draw  the borders between blocks depend on it.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_pole_blocks_find(const brio_pole_graph *g, const uint8_t *label, const uint8_t *fixed, int bits,
                                  uint64_t draw, brio_pole_blocks *out);
void brio_pole_blocks_free(brio_pole_blocks *b);

/** Where a block begins; it ends where the next one begins. */
static inline size_t brio_pole_block_begin(const brio_pole_blocks *b, size_t block) {
    return block < b->num_blocks ? block << b->bits : b->count;
}

#endif
