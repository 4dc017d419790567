/* Points with all their properties in a scratch file, for points that are in no memory as a whole: one row after the
 * other, in the order in which they came, and then in the order of tiles.
 *
 * The file has no name, so that nothing is left behind, however the process ends. */
#ifndef BRIO_IO_CONVERT_ROWS_H
#define BRIO_IO_CONVERT_ROWS_H

#include "io/builder.h"

/** A row is x, y, z, then the properties in their order, packed, as this machine has them. `file` -1 is the state
 *  before the first block. */
typedef struct brio_rows {
    brio_context *ctx;
    const char *folder; /* of the file */
    brio_mesh *kind; /* properties, metadata and grid of the first block; its arrays are those of a block on its way */
    int file;
    size_t size;    /* bytes of a row */
    uint64_t count; /* rows */
    uint64_t most;  /* bytes on the disk, at most */
    char *bytes;    /* rows of a block */
} brio_rows;

/** The rows of a tile, which follow each other, and the box of their points, which is 0 if there are none. */
typedef struct brio_row_tile {
    uint64_t first, count;
    double low[3], high[3];
} brio_row_tile;

/** Begins, with the properties, the metadata and the grid of the first block.
 *  Returns BRIO_OK, BRIO_ERR_OPEN (the folder takes no files), BRIO_ERR_NO_MEMORY. */
brio_status brio_rows_begin(brio_rows *r, const brio_mesh *first);
/** Returns the first property that is not in both the first block and another one, or of another type there; NULL if
 *  they have the same, in any order. */
const brio_property *brio_rows_differ(const brio_rows *r, const brio_mesh *block);
/** Appends the points of a block, which has the properties of the first one.
 *  Returns BRIO_OK, BRIO_ERR_WRITE (full), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_rows_append(brio_rows *r, const brio_mesh *block);
/** Refuses rows for which the disk has no room.   name  of the input.   points  that are still to be written. */
brio_status brio_rows_require_room(const brio_rows *r, const char *name, uint64_t points);
/** Hands rows to a sink in blocks, as the reader of a file does: none are one empty block. The sink may change what is
 *  in a block. */
brio_status brio_rows_pass(const brio_rows *r, uint64_t first, uint64_t count, const brio_sink *sink);
/** Makes one mesh of rows.   out  owned by the caller, NULL on error. */
brio_status brio_rows_mesh(const brio_rows *r, uint64_t first, uint64_t count, brio_mesh **out);
/** Returns the bytes of memory, beside a block of rows, while the rows are divided. */
double brio_rows_divide_bytes(const brio_rows *r, uint32_t num_tiles);
/** Brings the rows into the order of tiles; those of a tile keep theirs.
 *  chosen  NULL, or of each row whether it stays.   tile  num_tiles; receives what is where.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_rows_divide(brio_rows *r, const uint8_t *chosen, uint32_t num_tiles, brio_row_tile *tile);
/** Frees everything, and gives the disk its room back. */
void brio_rows_free(brio_rows *r);

#endif
