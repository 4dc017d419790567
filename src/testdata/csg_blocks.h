/* The values of a tree of solids on a grid, by blocks of cells: far from the surface a block has one value, near it
 * only the nodes count that the block needs. */
#ifndef BRIO_TESTDATA_CSG_BLOCKS_H
#define BRIO_TESTDATA_CSG_BLOCKS_H

#include "iso/iso_surface.h"
#include "testdata/csg.h"

typedef struct {
    const brio_csg *tree;
    double low[3], side; /* of the blocks */
    double inner[2][3];  /* corners of a box just within the grid: beyond it all is outside */
    uint32_t count[3];   /* blocks along each axis */
    uint32_t words;      /* of 64 bits, for the nodes of a block */
    uint32_t num_near;   /* blocks that are near the surface */
    double *centre;      /* value at each block's centre */
    uint32_t *slot;      /* of each block: its row of `need`, or BRIO_CSG_FAR */
    uint64_t *need;      /* rows of `words` words */
    size_t first;        /* block of the batch in work, while the blocks are made */
} brio_csg_blocks;

#define BRIO_CSG_FAR UINT32_MAX

/** Divides the grid into blocks and finds which are near the surface: all but `need`, so that there are no values. Free
 *  and returns as below. */
brio_status brio_csg_blocks_find(brio_context *ctx, const brio_csg *tree, const brio_implicit_grid *grid,
                                 brio_csg_blocks *out);

/** Divides the grid into blocks. Free with brio_csg_blocks_free, also after a failure.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */
brio_status brio_csg_blocks_make(brio_context *ctx, const brio_csg *tree, const brio_implicit_grid *grid,
                                 brio_csg_blocks *out);

/** Returns the value: a brio_implicit_fn whose user data is a brio_csg_blocks. Within a block's distance of the surface
 *  the value is that of the tree; elsewhere it has the right sign. */
double brio_csg_blocks_value(const double *p, const void *blocks);

void brio_csg_blocks_free(brio_context *ctx, brio_csg_blocks *blocks);

#endif
