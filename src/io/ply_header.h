/* The header of a PLY file: elements with properties. A property is a scalar or a list. */
#ifndef BRIO_IO_PLY_HEADER_H
#define BRIO_IO_PLY_HEADER_H

#include "io/stream.h"

typedef enum { BRIO_PLY_ASCII, BRIO_PLY_LITTLE, BRIO_PLY_BIG } brio_ply_encoding;

/* What the reader does with the values of a property. */
typedef enum {
    BRIO_PLY_SKIP,
    BRIO_PLY_COORDINATE,
    BRIO_PLY_PROPERTY,
    BRIO_PLY_FACE,
    BRIO_PLY_OF_FACE,
    BRIO_PLY_STRIP,
    BRIO_PLY_TETRAHEDRON,
    BRIO_PLY_EDGE
} brio_ply_role;

typedef struct brio_ply_property {
    char name[64];
    brio_scalar type, count_type; /* count_type: of the count of a list */
    bool list;
    brio_ply_role role;
    size_t target; /* axis of a coordinate, end of an edge, or index of a property of the mesh (BRIO_PLY_PROPERTY,
                              BRIO_PLY_OF_FACE) */
    size_t offset; /* byte offset in a binary row without lists */
} brio_ply_property;

typedef struct brio_ply_element {
    char name[64];
    uint64_t count;
    brio_ply_property *properties;
    size_t num_properties, property_capacity;
    bool has_list;
    size_t row_size; /* bytes of a binary row with empty lists, the least that a row can have */
} brio_ply_element;

typedef struct brio_ply_header {
    brio_ply_encoding encoding;
    brio_ply_element *elements;
    size_t num_elements, element_capacity;
    bool textures; /* whether a comment names a file with a texture */
    char *crs;     /* NULL, or the text of all comments that begin with crs */
    size_t crs_length, crs_capacity;
} brio_ply_header;

/** Returns PLY's name of a scalar type. */
const char *brio_ply_type_name(brio_scalar type);

/** Reads the header and, unless the file may end early, checks that it is large enough for what the header announces.
 *  Call brio_ply_header_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_ply_header_read(brio_stream *s, bool may_end_early, brio_ply_header *header);
void brio_ply_header_free(brio_context *ctx, brio_ply_header *header);

/* How points are written. */
extern const struct brio_row_format brio_ply_rows;

#endif
