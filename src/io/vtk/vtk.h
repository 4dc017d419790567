/* What the readers of VTK's files share, from tags to cells. */
#ifndef BRIO_IO_VTK_H
#define BRIO_IO_VTK_H

#include "base/context.h"
#include "io/base64.h"
#include "io/builder.h"
#include "io/formats.h"
#include "io/stream.h"

/* --- tags --- */

/* Tags of an XML file, read one after the other. Text between tags is skipped, unless the caller reads it from the
 * stream.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY or
 * BRIO_ERR_CANCELLED. */

enum { BRIO_XML_VALUE = 64 }; /* bytes of the value of an attribute, with the 0 at its end; the rest is cut off */

/** Skips to the next `mark`. Fails if there is none.   expected  what the mark announces, for the message. */
brio_status brio_xml_skip_to(brio_stream *s, char mark, const char *expected);

/** Returns the next tag in *tag, without < and >, with a 0 at its end. It is valid until the next call with the stream.
 *  Fails if there is none.   expected  the tag that the caller waits for, for the message. */
brio_status brio_xml_next_tag(brio_stream *s, const char *expected, const char **tag);

/** Returns whether the tag has this name. That of an end tag begins with a slash. */
bool brio_xml_is(const char *tag, const char *name);

/** Copies the value of an attribute of a tag. Returns false if the tag has no such attribute. */
bool brio_xml_attribute(const char *tag, const char *name, char value[BRIO_XML_VALUE]);
/** Returns whether an attribute has this value. */
bool brio_xml_attribute_is(const char *tag, const char *name, const char *value);

/** Returns the error of a place, which it names, where something else was expected. */
brio_status brio_xml_bad(brio_stream *s, const char *expected);

/* --- what the tags say --- */

/* What the tags of a VTU or VTP file say: how arrays are encoded, the pieces with their counts, and the arrays. */

/* Types of arrays: the types of properties, then two types that become doubles. */
enum { BRIO_VTK_INT64 = BRIO_SCALAR_END, BRIO_VTK_UINT64, BRIO_VTK_TYPE_END };

/* Where an array is. VTU has CELLS; VTP has LINES, STRIPS and POLYS. */
typedef enum {
    BRIO_VTK_OTHER,      /* also cells that are points */
    BRIO_VTK_FIELD_DATA, /* passed over */
    BRIO_VTK_POINTS,
    BRIO_VTK_POINT_DATA,
    BRIO_VTK_CELL_DATA,
    BRIO_VTK_CELLS,
    BRIO_VTK_LINES,
    BRIO_VTK_STRIPS,
    BRIO_VTK_POLYS,
    BRIO_VTK_SECTION_END
} brio_vtk_section;

typedef enum { BRIO_VTK_RAW, BRIO_VTK_BASE64, BRIO_VTK_TEXT } brio_vtk_encoding;

typedef struct brio_vtk_array {
    char name[BRIO_XML_VALUE];
    brio_vtk_section section;
    int type;
    brio_vtk_encoding encoding; /* of an array that is not appended */
    bool appended;
    bool empty;                  /* the tag has no content */
    uint64_t components, offset; /* offset: from the start of the appended data */
    size_t piece;
} brio_vtk_array;

typedef struct brio_vtk_piece {
    uint64_t first_point, num_points; /* first_point: the points of the pieces before */
    uint64_t first_cell;              /* likewise of all cells */
    uint64_t
        num_cells[BRIO_VTK_SECTION_END]; /* of the sections from BRIO_VTK_CELLS on, and of points in BRIO_VTK_OTHER */
} brio_vtk_piece;

typedef struct brio_vtk_header {
    bool known;      /* whether the tag VTKFile was read */
    bool polygonal;  /* PolyData, otherwise UnstructuredGrid */
    bool swap;       /* whether the arrays are in the other byte order than this machine's */
    bool compressed; /* whether arrays that are no text are compressed, and by what */
    char compressor[BRIO_XML_VALUE];
    size_t word; /* bytes of the numbers in front of an array */
    brio_vtk_piece *pieces;
    size_t num_pieces, piece_capacity;
    brio_vtk_section section;
} brio_vtk_header;

/** Returns the number of cells of a piece. */
uint64_t brio_vtk_cells_of(const brio_vtk_piece *piece);
/** Returns the first row that a section of a piece has in cell data: points come first, then lines, polygons,
 *  strips. */
uint64_t brio_vtk_first_row(const brio_vtk_piece *piece, brio_vtk_section section);

/** Takes what a tag says, except DataArray. */
brio_status brio_vtk_header_tag(brio_stream *s, brio_vtk_header *header, const char *tag);
/** Reads the tag DataArray. The type of an array that is passed over may be BRIO_VTK_TYPE_END. */
brio_status brio_vtk_header_array(brio_stream *s, const brio_vtk_header *header, const char *tag,
                                  brio_vtk_array *array);
/** Frees what a header owns. */
void brio_vtk_header_free(brio_context *ctx, brio_vtk_header *header);

/** Returns the bytes of a type of arrays. */
size_t brio_vtk_type_size(int type);
/** Returns the name of a type of arrays. */
const char *brio_vtk_type_name(int type);

/* --- zlib --- */

/* Blocks of bytes compressed by zlib. A build without zlib has these functions, and they fail with a sentence. */

typedef struct brio_vtk_zlib brio_vtk_zlib;

/* No byte of a block stands for more than this many: a match of 258 bytes takes two bits at least. */
enum { BRIO_VTK_MOST_INFLATED = 1032 };

/* Where to read and write. */
typedef struct brio_vtk_span {
    const char *in;
    size_t in_left;
    char *out;
    size_t out_left;
} brio_vtk_span;

/** Inflates until the input or the room is used up, or the block ends.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (without a message) if the bytes are damaged, BRIO_ERR_NO_MEMORY. */
brio_status brio_vtk_inflate(brio_vtk_zlib *z, brio_vtk_span *span, bool *ended);
void brio_vtk_zlib_free(brio_context *ctx, brio_vtk_zlib *z);

/** Returns the most bytes that a block of `size` bytes is compressed to. */
size_t brio_vtk_deflate_bound(size_t size);
/** Compresses a block. Threads may call this together.   packed  room for `packed_size` bytes, which must be
 *  brio_vtk_deflate_bound(size) at least; receives the size.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_vtk_deflate(brio_context *ctx, const void *bytes, size_t size, void *packed, size_t *packed_size);

/* --- arrays --- */

/* The bytes of one array after the other, however they are encoded: raw or as base 64, compressed or not, or numbers as
 * text. */

/* The blocks of a compressed array: all have block_size bytes when inflated, except the last one. */
typedef struct brio_vtk_blocks {
    uint64_t *packed; /* bytes of each block in the file */
    size_t capacity;
    uint64_t count, next; /* next: the block to begin after the present one */
    uint64_t block_size, last_size;
    uint64_t in_left, out_left; /* of the present block */
    bool open;                  /* whether there is a present block */
} brio_vtk_blocks;

typedef struct brio_vtk_decoder {
    brio_stream *stream;
    const brio_vtk_header *header;
    /* of the array that is open */
    const brio_vtk_array *array;
    brio_vtk_encoding encoding;
    bool swap;     /* whether the numbers are in the other byte order than this machine's */
    uint64_t left; /* bytes; UINT64_MAX for text, whose end is its end */
    brio_base64 base64;
    brio_vtk_blocks blocks;
    brio_vtk_zlib *zlib;
    char *input; /* compressed bytes that were base 64 */
    size_t input_begin, input_end;
} brio_vtk_decoder;

/** Opens the array whose first byte is the next one of the stream.
 *  encoding  how it is encoded.
 *  bytes     receives the size of the array, held against the size of the file; UINT64_MAX for text.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, as the next function. */
brio_status brio_vtk_decoder_open(brio_vtk_decoder *d, const brio_vtk_array *array, brio_vtk_encoding encoding,
                                  uint64_t *bytes);

/** Decodes the next bytes of the array, whole numbers, in the file's byte order if `swap` is set.
 *  got  receives their number, less than `size` only at the end of the array. */
brio_status brio_vtk_decoder_take(brio_vtk_decoder *d, void *to, size_t size, size_t *got);

/** Reads a number of a type of arrays from a word. Returns false if it is none, or the type cannot hold it. */
bool brio_vtk_parse(const char *word, int type, void *to);

void brio_vtk_decoder_free(brio_vtk_decoder *d);

/* --- values --- */

/* An array that is kept as the file has it, in this machine's byte order; and point data and
 * cell data, which become properties. */

/* Numbers of one type. */
typedef struct brio_vtk_values {
    char *bytes;
    uint64_t count;
    int type;
} brio_vtk_values;

/** Returns number i as a double. */
double brio_vtk_number(const brio_vtk_values *values, uint64_t i);

/** Reads an open array.
 *  bytes  its size, from brio_vtk_decoder_open.   count  the numbers that it must have; UINT64_MAX for any number.
 *  out    owned by the caller (brio_release of its bytes), on failure too. */
brio_status brio_vtk_read_values(brio_vtk_decoder *d, uint64_t bytes, uint64_t count, brio_vtk_values *out);

/** Fails unless an array of `bytes` bytes, UINT64_MAX for a text, can be `rows` rows.   row  bytes of a row. */
brio_status brio_vtk_expect_rows(const brio_vtk_decoder *d, uint64_t bytes, uint64_t rows, size_t row);
/** Returns the error of an array that has fewer or more rows than it must have. */
brio_status brio_vtk_bad_rows(const brio_vtk_decoder *d, uint64_t found, uint64_t rows);

/* One component of an array of point data or cell data, of all pieces that were read. */
typedef struct brio_vtk_column {
    char source[BRIO_XML_VALUE]; /* name of the array */
    uint64_t component, components;
    int file_type;    /* of the array */
    brio_scalar type; /* of the property */
    char *data;
    uint64_t rows;
    size_t capacity; /* bytes */
    bool rounded;    /* whether an integer is one that no double has */
} brio_vtk_column;

typedef struct brio_vtk_data {
    brio_vtk_column *columns;
    size_t num_columns, capacity;
    char *chunk; /* rows of an array */
    bool of_cells;
} brio_vtk_data;

/** Reads an array, which is open, of a piece. An array that not all pieces before had is left out.
 *  bytes  its size, from brio_vtk_decoder_open.   first, rows  of the piece. */
brio_status brio_vtk_read_data(brio_vtk_data *data, brio_builder *b, brio_vtk_decoder *d, uint64_t bytes,
                               uint64_t first, uint64_t rows);
/** Keeps an array of all rows that was read already.   values  `components` numbers for each row. */
brio_status brio_vtk_keep_array(brio_vtk_data *data, brio_stream *s, const brio_vtk_array *array,
                                const brio_vtk_values *values);
/** Makes properties of the columns that all points have. */
brio_status brio_vtk_finish_point_data(brio_vtk_data *data, brio_builder *b);
void brio_vtk_data_free(brio_context *ctx, brio_vtk_data *data);

/** Returns whether an array of point data or cell data is kept: it has a name and a handful of components. */
bool brio_vtk_is_kept(const brio_vtk_array *array);

/* --- cells --- */

/* The cells of a VTU or VTP file as polygons, tetrahedra and edges. */

/* The row of each face of the mesh in cell data. */
typedef struct brio_vtk_face_rows {
    uint64_t *row;
    size_t count, capacity;
} brio_vtk_face_rows;

/* The arrays of the cells of one section of one piece. */
typedef struct brio_vtk_cells {
    brio_vtk_section section;
    const brio_vtk_piece *piece;
    brio_vtk_values connectivity, offsets, types; /* VTP has no types */
    brio_vtk_values faces, face_offsets;          /* of polyhedra; may be left out */
} brio_vtk_cells;

/** Adds the cells to a mesh whose vertices have all been read.   rows  NULL, or receives the rows of its faces.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (the message names the cell), BRIO_ERR_NO_MEMORY. */
brio_status brio_vtk_add_cells(brio_builder *b, const brio_vtk_cells *cells, brio_vtk_face_rows *rows);

/** Makes properties of faces of the columns that all cells have.   num_cells  of all pieces. */
brio_status brio_vtk_finish_cell_data(brio_vtk_data *data, brio_builder *b, const brio_vtk_face_rows *rows,
                                      uint64_t num_cells);

/* Writers, each in its own file. */
brio_status brio_vtu_write(brio_output *out, const brio_write_job *job);
brio_status brio_vtp_write(brio_output *out, const brio_write_job *job);
brio_status brio_vtk_legacy_write(brio_output *out, const brio_write_job *job);

#endif
