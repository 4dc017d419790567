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

/** index = the n points by blocks of at most block_size points, depth first: the cells of an octree. Points that no cube
 *  can tell apart are divided as they come.   spare  room for n indices.   Needs 256 KiB a thread of workspace. */
brio_status brio_octree_blocks(brio_context *ctx, const double *points, size_t n, size_t block_size, uint32_t *index,
                               uint32_t *spare, brio_block_fn visit, const void *user);

/** The same with the cells of a k-d tree: a cell of n points has children of n / 2 and n - n / 2.
 *  Needs 16 n bytes of workspace. */
brio_status brio_kdtree_blocks(brio_context *ctx, const double *points, size_t n, size_t block_size, uint32_t *index,
                               brio_block_fn visit, const void *user);

#endif
