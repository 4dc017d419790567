/* The header of an NPY file. */
#ifndef BRIO_IO_NPY_HEADER_H
#define BRIO_IO_NPY_HEADER_H

#include "io/stream.h"

typedef struct brio_npy_field {
    char name[64];
    brio_scalar type;
    bool wide; /* an integer of 64 bits; type is then INT32 or UINT32 */
    bool big;  /* big endian */
    size_t at; /* byte in a record */
    int axis;  /* set by the reader, with the property */
    size_t property;
} brio_npy_field;

typedef struct brio_npy_header {
    brio_npy_field *fields; /* of an array of rows: x, y, z, column4, ... */
    size_t num_fields, capacity;
    size_t record;
    uint64_t rows;
    bool fortran;
} brio_npy_header;

/** Reads the header. Call brio_npy_header_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_npy_header_read(brio_stream *s, brio_npy_header *h);
void brio_npy_header_free(brio_context *ctx, brio_npy_header *h);

#endif
