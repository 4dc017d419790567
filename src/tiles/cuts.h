/* Space divided into tiles of about as many points: a sample of points that go by, and a k-d tree over it.
 *
 * The sample is of the points whose index has a small hash; where it would grow beyond 2^17 points, half of it goes.
 * Cuts go through the longest side of the sample in each part, so that the tiles get about as many points. */
#ifndef BRIO_TILES_CUTS_H
#define BRIO_TILES_CUTS_H

#include "base/context.h"

/** A cut of the k-d tree. Points with x[axis] < at go to `below`. */
typedef struct {
    double at;
    int32_t axis;
    int32_t below, above; /* a cut, or -1 - tile */
} brio_tile_cut;

/** The part of space that is a tile's. Sides may be infinite. */
typedef struct {
    double low[3], high[3];
} brio_tile_home;

/** The sample, then the cuts. All bytes 0 is the state before the first point.
 *
 *      brio_tile_cuts_begin; brio_tile_cuts_sample for each point; brio_tile_cuts_make; brio_tile_cuts_find;
 *      brio_tile_cuts_free */
typedef struct {
    double (*sample)[3]; /* NULL: none yet, or not needed any more */
    uint64_t *hash;      /* of the index of each point of the sample */
    size_t num_sample;
    uint64_t most_hash; /* of points of the sample */
    brio_tile_cut *cut; /* the first one is the root */
    size_t num_cuts;
} brio_tile_cuts;

/** Makes room for the sample, if there is none.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_tile_cuts_begin(brio_context *ctx, brio_tile_cuts *c);
/** Takes a point into the sample if the hash of its index is small: which points are in it depends neither on the order
 *  nor on the blocks in which they came. */
void brio_tile_cuts_sample(brio_tile_cuts *c, const double point[3], uint64_t index);
/** Cuts space by the sample, along the longest side of each part. Points at one position are on one side of every cut.
 *  home  NULL, or receives the part of space of each tile. */
brio_status brio_tile_cuts_make(brio_context *ctx, brio_tile_cuts *c, uint32_t num_tiles, brio_tile_home *home);
/** Returns the tile of a position, also of one that was not in the sample. */
uint32_t brio_tile_cuts_find(const brio_tile_cuts *c, const double point[3]);
/** Returns the bytes of all this at most. */
double brio_tile_cuts_bytes(uint32_t num_tiles);
/** Frees the sample; the cuts stay. */
void brio_tile_cuts_drop_sample(brio_context *ctx, brio_tile_cuts *c);
void brio_tile_cuts_free(brio_context *ctx, brio_tile_cuts *c);

#endif
