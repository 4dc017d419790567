/* The header of an NPY file, or of an array in an NPZ file. */
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
    bool rounded; /* set by the reader: whether an integer is beyond 2^53, where doubles have gaps */
} brio_npy_field;

typedef struct brio_npy_header {
    brio_npy_field *fields; /* of an array of rows: x, y, z, column4, ... */
    size_t num_fields, capacity;
    size_t record;
    uint64_t rows;
    bool fortran;
    char (
        *passed)[64]; /* names of fields that are no numbers, such as words: they are in the records, not in `fields` */
    size_t num_passed, passed_capacity;
} brio_npy_header;

/** Any array: of points or not. */
typedef struct brio_npy_array {
    bool records;           /* fields with names; nothing else below is set then, except shape and dimensions */
    bool known;             /* whether `element` is a number that can be read */
    brio_npy_field element; /* its type */
    uint64_t shape[2];      /* the first two lengths; 1 where there are fewer dimensions */
    size_t dimensions;
    bool fortran;
} brio_npy_array;

/** Reads the header of any array. Returns as brio_npy_header_read. */
brio_status brio_npy_array_read(brio_stream *s, brio_npy_array *array);

/** Returns the bytes of an element, and the element at an address as a double. */
size_t brio_npy_size(const brio_npy_field *f);
double brio_npy_load(const brio_npy_field *f, const char *bytes);
/** Returns whether the element is an integer that no double has. */
bool brio_npy_is_rounded(const brio_npy_field *f, const char *bytes);

/** Reads the header of points. Call brio_npy_header_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_npy_header_read(brio_stream *s, brio_npy_header *h);
void brio_npy_header_free(brio_context *ctx, brio_npy_header *h);

#endif
