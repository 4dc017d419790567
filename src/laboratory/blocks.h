/* Blocks of points that are near each other in space: the leaves of an octree or a k-d tree, in depth-first order. */
#ifndef BRIO_LABORATORY_BLOCKS_H
#define BRIO_LABORATORY_BLOCKS_H

#include "brio/laboratory.h"
#include "order/order.h"

/** The points at the positions [begin, end) of the depth-first order. */
typedef struct {
    size_t begin, end;
    int passes; /* number of passes over the points that brought the block together */
} brio_block;

/** Receives a finished block, and may reorder its points index[block->begin .. block->end). Several threads call this
 *  function for different blocks, in any order. */
typedef void (*brio_block_fn)(uint32_t *index, const brio_block *block, const void *user);

/** The points to be divided into blocks, and the arrays for the result. */
typedef struct {
    const double *points; /* n by 3 */
    size_t n;
    size_t block_size; /* the largest number of points in a block */
    uint32_t *index;   /* n: receives the indices of the points, block after block, depth first */
    brio_block_fn visit;
    const void *user; /* passed to visit */
} brio_blocks;

/** Divides points into the cells of an octree. Points that no cube can separate are cut into blocks in their present
 *  order.   spare  room for n indices.   Needs up to 256 KiB of workspace for each thread, and 2 n + n / 170
 *  bytes. */
brio_status brio_octree_blocks(brio_context *ctx, const brio_blocks *blocks, uint32_t *spare);

/** Divides points into the cells of a k-d tree: a cell of n points has children of n / 2 and n - n / 2 points.
 *  Needs 16 n bytes of workspace. */
brio_status brio_kdtree_blocks(brio_context *ctx, const brio_blocks *blocks);

/** Writes an insertion order by blocks, shuffled inside a block, as brio_order_part has it.
 *  user  a brio_laboratory_options, with an order that is not BRIO_BLOCKS_NONE.
 *  Workspace in bytes a point: BRIO_OCTREE 6, BRIO_KDTREE 20, OCTREE 6. */
brio_status brio_block_order(const void *user, brio_context *ctx, const brio_input *input,
                             const brio_delaunay_options *options, const brio_ordering *out);

#endif
