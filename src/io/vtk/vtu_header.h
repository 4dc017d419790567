/* The XML of a VTU file: its counts, and the arrays appended behind it. */
#ifndef BRIO_IO_VTU_HEADER_H
#define BRIO_IO_VTU_HEADER_H

#include "io/stream.h"

/* Types of arrays: the types of properties, then two types that only indices have. */
enum { BRIO_VTU_INT64 = BRIO_SCALAR_END, BRIO_VTU_UINT64, BRIO_VTU_TYPE_END };

typedef enum { BRIO_VTU_OTHER, BRIO_VTU_POINTS, BRIO_VTU_POINT_DATA, BRIO_VTU_CELLS } brio_vtu_section;

typedef struct brio_vtu_array {
    char name[64];
    brio_vtu_section section;
    int type;
    uint64_t components, offset; /* offset: from the start of the appended data */
} brio_vtu_array;

typedef struct brio_vtu_header {
    uint64_t num_points, num_cells;
    bool swap;     /* whether the arrays are in the other byte order than this machine's */
    size_t word;   /* bytes of the number in front of each array */
    uint64_t base; /* file offset of the appended data */
    brio_vtu_array *arrays;
    size_t num_arrays, array_capacity;
    bool piece; /* whether a piece was read */
    brio_vtu_section section;
} brio_vtu_header;

/** Reads the XML up to the appended data. Call brio_vtu_header_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_vtu_header_read(brio_stream *s, brio_vtu_header *header);
void brio_vtu_header_free(brio_context *ctx, brio_vtu_header *header);

/** Returns the bytes of a type of arrays. */
size_t brio_vtu_type_size(int type);

#endif
