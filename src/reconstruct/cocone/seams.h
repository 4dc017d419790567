/* Triangles at the seams between pieces of a surface. */
#ifndef BRIO_RECONSTRUCT_SEAMS_H
#define BRIO_RECONSTRUCT_SEAMS_H

#include "base/context.h"

/** Triangles as they grow. */
typedef struct {
    uint32_t (*corner)[3];
    size_t count, capacity;
} brio_triangles;

brio_status brio_triangles_add(brio_context *ctx, brio_triangles *list, const uint32_t corner[3]);

/** Moves to `faces` the seam triangles that every piece with a sample of theirs has found, with the same orientation;
 *  each piece has added to `seam`, once, those it found. Samples of the others are marked in `frayed`.
 *  piece_of  #P.   frayed  #P.   unmatched  receives how many triangles were left out.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_match_seams(brio_context *ctx, const uint32_t *piece_of, brio_triangles *seam, brio_triangles *faces,
                             uint8_t *frayed, size_t *unmatched);

/** Drops faces until those at each frayed sample are a single fan, the longest that there was. A face has no more than
 *  one neighbour across each edge, with the same orientation.   frayed  #P; cleared.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_trim_fans(brio_context *ctx, const double *points, size_t num_points, uint8_t *frayed,
                           brio_triangles *faces);

#endif
