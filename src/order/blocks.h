/* Blocks of points that are near each other in space: the leaves of an octree or a k-d tree, depth first. */
#ifndef BRIO_ORDER_BLOCKS_H
#define BRIO_ORDER_BLOCKS_H

#include "base/context.h"

/** Points at the places [begin, end) of the depth-first order. */
typedef struct {
    size_t begin, end;
    int passes; /* over its points, until they stood together */
} brio_block;

/** Takes note of a block that is finished, or reorders it: index[block->begin .. block->end). Called by several threads
 *  for different blocks, in any order. */
typedef void (*brio_block_fn)(uint32_t *index, const brio_block *block, const void *user);

/** What is to be divided into blocks, and where the result goes. */
typedef struct {
    const double *points; /* n by 3 */
    size_t n;
    size_t block_size; /* most points in a block */
    uint32_t *index;   /* receives the indices of the points, block after block, depth first */
    brio_block_fn visit;
    const void *user; /* of visit */
} brio_blocks;

/** Divides points into the cells of an octree. Points that no cube can tell apart are divided as they come.
 *  spare  room for n indices.   Needs 256 KiB a thread of workspace. */
brio_status brio_octree_blocks(brio_context *ctx, const brio_blocks *blocks, uint32_t *spare);

/** Divides points into the cells of a k-d tree: a cell of n points has children of n / 2 and n - n / 2 points.
 *  Needs 16 n bytes of workspace. */
brio_status brio_kdtree_blocks(brio_context *ctx, const brio_blocks *blocks);

#endif
