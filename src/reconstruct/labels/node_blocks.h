/* Blocks of nodes near the edges that labels contradict, and rounds of blocks that can be improved side by side. */
#ifndef BRIO_RECONSTRUCT_NODE_BLOCKS_H
#define BRIO_RECONSTRUCT_NODE_BLOCKS_H

#include "reconstruct/labels/signed_graph.h"

/** Block b has the nodes node[begin[b]] to node[end[b] - 1], at most 2^bits.
 *  I1  No edge of the graph joins two blocks of a round, so threads can work on the blocks of a round side by side.
 *  I2  A block is in one round if an edge of one of its nodes is violated, otherwise in none.
 *  I3  A block comes after the blocks joined to it whose colours are less, and before the others, in every division
 *      into rounds: so what is found round after round depends on the colours alone.
 *  I4  Nothing here depends on the number of threads. The blocks and their colours depend on the positions of
 *      nodes, and not on their numbers, unless over 2^bits nodes have one position. Nodes far away do not change a
 *      block, unless over 2^bits nodes are within 2^(exponent - 60) of each other in each coordinate. */
typedef struct {
    brio_context *ctx;
    size_t count;    /* of all blocks together */
    uint32_t *node;  /* count: the nodes, block after block */
    uint32_t *place; /* #nodes of the graph: the index of the node in node[], or BRIO_NO_PLACE */
    uint32_t *of;    /* count: the block of node[i] */
    int bits;
    size_t num_blocks, num_rounds;
    size_t *begin, *end; /* #blocks */
    size_t *first_round; /* #rounds + 1: round r is block[first_round[r]] to block[first_round[r + 1] - 1] */
    uint32_t *block;
} brio_node_blocks;

enum { BRIO_NO_PLACE = UINT32_MAX };

/** How a graph is divided. */
typedef struct {
    int bits;        /* a block has at most 2^bits nodes */
    size_t together; /* about as many nodes have all their rounds before others do */
    uint64_t draw;   /* the seed that places the borders between blocks */
} brio_block_rule;

/** Divides the nodes that are at most 3 edges away from a violated edge into blocks of nodes that are near each other.
 *  Poles p with fixed[p] != 0 are left out.
 *  out  to be freed with brio_node_blocks_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_node_blocks_find(const brio_signed_graph *g, const uint8_t *label, const uint8_t *fixed,
                                  brio_block_rule rule, brio_node_blocks *out);
void brio_node_blocks_free(brio_node_blocks *b);

#endif
