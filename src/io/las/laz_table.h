/* The table of chunks of a LAZ file: where each chunk is, and how many points it has. The table is at the end of the
 * file. */
#ifndef BRIO_IO_LAZ_TABLE_H
#define BRIO_IO_LAZ_TABLE_H

#include "io/las/las_header.h"

typedef struct brio_laz_chunk {
    uint32_t points, bytes;
} brio_laz_chunk;

/** Reads the table of a regular file. The chunks lie one after the other from the stream's position on.
 *  at      the table's first byte, as the file says.
 *  chunks  receives a block of *count chunks, owned by the caller (brio_release), or NULL if the file has no table or
 *          cannot be read from its end: the caller then reads chunk after chunk.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT (the table does not fit the file), BRIO_ERR_NO_MEMORY. */
brio_status brio_laz_table_read(brio_stream *s, const brio_las_header *h, uint64_t at, brio_laz_chunk **chunks,
                                size_t *count);

#endif
