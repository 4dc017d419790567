/* The points of a LAS file. */
#ifndef BRIO_IO_LAS_READ_H
#define BRIO_IO_LAS_READ_H

#include "io/las/las_fields.h"

/* Both return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, and what
 * the builder's sink returns. */

/** Reads the points behind a header; the stream is where they begin. With b->salvage a file may end early. */
brio_status brio_las_read_points(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan);
/** Reads points that are compressed. */
brio_status brio_laz_read(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan);

#endif
