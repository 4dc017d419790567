/* Triangles at the seams between pieces of a surface. */
#ifndef BRIO_RECONSTRUCT_SEAMS_H
#define BRIO_RECONSTRUCT_SEAMS_H

#include "base/context.h"

/** A growing list of triangles. */
typedef struct {
    uint32_t (*corner)[3];
    size_t count, capacity;
} brio_triangles;

/** Appends a triangle. Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_triangles_add(brio_context *ctx, brio_triangles *list, const uint32_t corner[3]);

/** Appends to `faces` each seam triangle that all pieces with one of its samples have found, in one orientation. Sets
 *  frayed[p] to 1 for the samples of the other seam triangles.
 *  piece_of   #P.   frayed  #P.
 *  seam       each piece has added each of its triangles once. The function rotates the corners of triangles.
 *  unmatched  receives the number of seam triangles that are left out.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_match_seams(brio_context *ctx, const uint32_t *piece_of, brio_triangles *seam, brio_triangles *faces,
                             uint8_t *frayed, size_t *unmatched);

/** Removes faces until the faces at each frayed sample are one fan: the longest of the fans that were there. Each edge
 *  must have at most two faces, and these must run along it in opposite directions.
 *  frayed  #P: all 0 afterwards.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_trim_fans(brio_context *ctx, const double *points, size_t num_points, uint8_t *frayed,
                           brio_triangles *faces);

#endif
