/* An array that is kept as the file has it, in this machine's byte order; and point data and
 * cell data, which become properties. */
#ifndef BRIO_IO_VTK_VALUES_H
#define BRIO_IO_VTK_VALUES_H

#include "io/builder.h"
#include "io/vtk/vtk_decoder.h"

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
/** Names an array that becomes nothing. */
brio_status brio_vtk_leave_out(const brio_vtk_data *data, brio_builder *b, const char *array);
/** Makes the name of the property that a column becomes, which no other one has. */
void brio_vtk_choose_name(const brio_vtk_data *data, brio_builder *b, const brio_vtk_column *c, char name[64]);
/** Makes properties of the columns that all points have. */
brio_status brio_vtk_finish_point_data(brio_vtk_data *data, brio_builder *b);
void brio_vtk_data_free(brio_context *ctx, brio_vtk_data *data);

/** Returns whether an array of point data or cell data is kept: it has a name and a handful of components. */
bool brio_vtk_is_kept(const brio_vtk_array *array);

#endif
