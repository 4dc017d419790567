/* The depth of the colours of a LAS file: 16 bits, or 8 that were not scaled. */
#ifndef BRIO_IO_LAS_DEPTH_H
#define BRIO_IO_LAS_DEPTH_H

#include "io/las/las_read.h"

typedef struct brio_las_depth {
    bool coloured; /* whether a colour is not black */
    bool deep;     /* whether a number needs more than 8 bits */
} brio_las_depth;

/** Looks at the colours of a block. */
void brio_las_depth_see(brio_las_depth *depth, const brio_mesh *block);
/** Gives the mesh the metadata "colour.depth", 8, if its file has such colours. */
brio_status brio_las_depth_give(const brio_las_depth *depth, brio_mesh *mesh);

/** Looks at the colours of all points of a file that is no pipe, without moving the stream.
 *  s  where the points begin.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_las_depth_find(brio_stream *s, const brio_builder *b, const brio_las_header *h, brio_las_depth *depth);

#endif
