/* Samples divided into pieces by an octree. */
#ifndef BRIO_RECONSTRUCT_OCTREE_PIECES_H
#define BRIO_RECONSTRUCT_OCTREE_PIECES_H

#include "base/context.h"

/** A cell of the octree, or some neighbours under one parent: the samples order[begin .. end). */
typedef struct {
    size_t begin, end;
    double low[3], high[3]; /* the box of the samples */
    double margin;          /* how far beyond the box the surface round the samples is decided */
} brio_piece;

typedef struct {
    const double *points;
    size_t num_points;
    uint32_t *order;    /* #P, along a Hilbert curve, then by position; for coincident samples their lowest index */
    uint32_t *piece_of; /* #P, of the indices in the order */
    brio_piece *pieces;
    size_t num_pieces, capacity;
    size_t stride; /* every stride-th sample of the order stands for those far away */
} brio_pieces;

/** Divides the points into about `wanted` pieces of at most #P / wanted samples each. What it holds is to be freed on
 *  failure too.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_pieces_new(brio_context *ctx, const double *points, size_t num_points, size_t wanted,
                            brio_pieces *out);
void brio_pieces_free(brio_context *ctx, brio_pieces *pieces);

/** The samples that the surface in a piece is found from, by their places in the order: its own, those in its margin, and some from
 *  everywhere.   samples  *count of them, owned by the caller (brio_release).   Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_piece_samples(brio_context *ctx, const brio_pieces *pieces, size_t piece, uint32_t **samples,
                               size_t *count);

#endif
