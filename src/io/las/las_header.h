/* The header of a LAS file, and of its records of variable length those that say how to read the points. */
#ifndef BRIO_IO_LAS_HEADER_H
#define BRIO_IO_LAS_HEADER_H

#include "io/las/laz_decoder.h"
#include "io/stream.h"

enum { BRIO_LAS_FORMATS = 11 };

/** A number behind the fields of the format, described by the file. */
typedef struct brio_las_extra {
    char name[40];
    unsigned type; /* as in the file, of one number: 1 uint8, 2 int8, ... 10 double */
    size_t at;     /* its first byte, counted from the first extra byte of a record */
    bool scaled;
    double scale, offset;
} brio_las_extra;

typedef struct brio_las_header {
    int minor; /* of the version 1.0 to 1.4 */
    unsigned format;
    size_t record; /* bytes of a record */
    uint64_t num_points;
    uint64_t data; /* the byte at which the points begin */
    double scale[3], offset[3];
    bool compressed;
    bool chunked;       /* compressed: in chunks */
    uint32_t chunk;     /* points of a chunk, or UINT32_MAX if their numbers differ */
    brio_laz_form form; /* compressed */
    brio_las_extra *extras;
    size_t num_extras, extra_capacity;
} brio_las_header;

/** Returns the bytes of a record of a format 0 to 10 without extra bytes. */
size_t brio_las_record_bytes(unsigned format);

/** Returns the bytes of a number of a type of extra bytes, or 0 if there is no such type of one number. */
size_t brio_las_extra_bytes(unsigned type);

/** Reads the header and all bytes before the points. Call brio_las_header_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_las_header_read(brio_stream *s, brio_las_header *h);
void brio_las_header_free(brio_context *ctx, brio_las_header *h);

#endif
