/* What reader and writer of PCD files share: the header, and compressed columns. */
#ifndef BRIO_IO_PCD_HEADER_H
#define BRIO_IO_PCD_HEADER_H

#include "io/limits.h"
#include "io/stream.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* --- compressed columns --- */

/* LZF, the compression of PCD files. */

enum { BRIO_LZF_MOST_RATIO = 88 /* bytes that one byte stands for, at most: 264 for 3 */ };

/** Decompresses bytes. Returns whether they are sound and give exactly `size` bytes. */
bool brio_lzf_decompress(const uint8_t *bytes, size_t count, uint8_t *out, size_t size);

/** Returns room for any `count` bytes when compressed. */
static inline size_t brio_lzf_room(size_t count) {
    return count + count / 32 + 1;
}

enum { BRIO_LZF_TABLE = 1 << 14 };

/** Compresses bytes.   count  below 2^32.   out  brio_lzf_room(count) bytes.   table  BRIO_LZF_TABLE numbers,
 *  workspace. Returns the size of what was written. */
size_t brio_lzf_compress(const uint8_t *bytes, size_t count, uint8_t *out, uint32_t *table);

/* --- the header --- */

/* The header of a PCD file. */

enum { BRIO_PCD_MOST_NUMBERS = BRIO_MOST_NUMBERS /* of a point */ };

typedef enum { BRIO_PCD_ASCII, BRIO_PCD_BINARY, BRIO_PCD_COMPRESSED } brio_pcd_data;

typedef struct brio_pcd_field {
    char name[64];
    char type;      /* I, U or F */
    unsigned size;  /* bytes of a number */
    unsigned count; /* numbers */
    size_t at;      /* byte of the first number in a record */
} brio_pcd_field;

typedef struct brio_pcd_header {
    brio_pcd_field *fields;
    size_t num_fields, capacity;
    uint64_t points, height; /* height: rows of the image that the points are */
    bool placed;             /* whether the viewpoint is another than the origin, unturned */
    size_t record, numbers;  /* bytes and numbers of a point */
    brio_pcd_data data;
    double viewpoint[7]; /* the scanner's place and its rotation, a quaternion w, x, y, z */
    bool has_place; /* whether that tells the place: many programs write 0 0 0 1 0 0 0 where they do not know it, which
                            is then a place only of clouds with rows and columns, as one sensor sees them */
} brio_pcd_header;

/** Reads the header up to the line DATA. Call brio_pcd_header_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_pcd_header_read(brio_stream *s, brio_pcd_header *h);
void brio_pcd_header_free(brio_context *ctx, brio_pcd_header *h);

/* How points are written. */
extern const struct brio_row_format brio_pcd_rows;

#endif
