/* Samples divided into pieces by an octree. */
#ifndef BRIO_RECONSTRUCT_OCTREE_PIECES_H
#define BRIO_RECONSTRUCT_OCTREE_PIECES_H

#include "base/context.h"

/** A cell of the octree, or neighbouring cells with one parent: the samples order[begin] to order[end - 1]. */
typedef struct {
    size_t begin, end;
    double low[3], high[3]; /* the box of the samples */
    double margin;          /* samples within this distance of the box decide the surface in the piece */
} brio_piece;

typedef struct {
    const double *points;
    size_t num_points;
    uint32_t *order;    /* #P: samples along a Hilbert curve, then by position; coincident ones have their lowest
                           index */
    uint32_t *piece_of; /* #P: the piece of each index that is in `order` */
    brio_piece *pieces;
    size_t num_pieces, capacity;
    size_t stride; /* every stride-th sample of `order` represents the samples far away */
} brio_pieces;

/** Divides the points into about `wanted` pieces of at most #P / wanted samples, rounded up.
 *  out  freed with brio_pieces_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_pieces_new(brio_context *ctx, const double *points, size_t num_points, size_t wanted,
                            brio_pieces *out);
void brio_pieces_free(brio_context *ctx, brio_pieces *pieces);

/** Lists the samples from which the surface in a piece is found, in the order of pieces->order: the samples of the
 *  piece, those within its margin, and a thin selection of all samples.
 *  samples  *count indices, owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_piece_samples(brio_context *ctx, const brio_pieces *pieces, size_t piece, uint32_t **samples,
                               size_t *count);

#endif
