/* What readers and writers of LAS files share: the header with its records, and the fields of the points. */
#ifndef BRIO_IO_LAS_H
#define BRIO_IO_LAS_H

#include "io/builder.h"
#include "io/las/laz_decoder.h"
#include "io/stream.h"
#include <stdatomic.h>

/* --- the header --- */

/* The header of a LAS file, and its records of variable length. */

enum { BRIO_LAS_FORMATS = 11 };

/** Bytes of the header of a record of variable length before the points (behind them they are BRIO_RECORD_HEADER), and
 *  of a description of extra bytes; and the places of a description's parts. */
enum { BRIO_LAS_RECORD_HEADER = 54, BRIO_LAS_EXTRA = 192, BRIO_LAS_NAME = 32 };
enum {
    BRIO_EXTRA_TYPE = 2,
    BRIO_EXTRA_OPTIONS = 3,
    BRIO_EXTRA_NAME = 4,
    BRIO_EXTRA_SCALE = 112,
    BRIO_EXTRA_OFFSET = 136,
    BRIO_EXTRA_TEXT = 160
};
/** Options of a description: what it says beside type and name. */
enum { BRIO_EXTRA_SCALED = 8, BRIO_EXTRA_SHIFTED = 16, BRIO_EXTRA_ALL_OPTIONS = 31 };

/** A number behind the fields of the format, described by the file. */
typedef struct brio_las_extra {
    char name[64]; /* of a description of several numbers with the place of this one behind it */
    unsigned type; /* as in the file, of one number: 1 uint8, 2 int8, ... 10 double */
    size_t at;     /* its first byte, counted from the first extra byte of a record */
    bool scaled;
    double scale, offset;
    char description[BRIO_LAS_EXTRA]; /* the file's, made one of one number */
} brio_las_extra;

/** Records that are kept as they are: each behind a header of BRIO_RECORD_HEADER bytes, see io/crs.h. */
typedef struct brio_las_records {
    char *bytes;
    size_t size, capacity;
} brio_las_records;

typedef struct brio_las_header {
    int minor; /* of the version 1.0 to 1.5 */
    unsigned format;
    size_t record; /* bytes of a record */
    uint64_t num_points;
    uint64_t data; /* the byte at which the points begin */
    double scale[3], offset[3];
    double time_shift; /* to be added to times, so that they are adjusted standard GPS times */
    uint64_t late;     /* the first byte of the records behind the points */
    uint32_t num_late; /* how many these are */
    bool late_pending; /* whether they are still to be read: in a pipe they come last */
    bool compressed;
    bool chunked;       /* compressed: in chunks */
    uint32_t chunk;     /* points of a chunk, or UINT32_MAX if their numbers differ */
    bool has_form;      /* whether LASzip's record was read */
    brio_laz_form form; /* compressed */
    brio_las_extra *extras;
    size_t num_extras, extra_capacity;
    size_t described; /* extra bytes of a record that the descriptions so far stand for */
    bool closed;      /* whether a description was not understood: what follows it has no known place */
    brio_las_records keys, others;
} brio_las_header;

/** Returns the bytes of a record of a format 0 to 10 without extra bytes. */
size_t brio_las_record_bytes(unsigned format);

/** Returns the bytes of a number of a type of extra bytes, or 0 if there is no such type of one number. */
size_t brio_las_extra_bytes(unsigned type);

/* The functions that read return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */

/** Reads the header and all bytes before the points, and from a file that is not a pipe the records behind the points.
 *  What they say goes to the header and to the metadata of b->mesh. Call brio_las_header_free even if this fails. */
brio_status brio_las_header_read(brio_stream *s, brio_builder *b, brio_las_header *h);
void brio_las_header_free(brio_context *ctx, brio_las_header *h);

/** Reads the records behind the points: from their place, or in a pipe when the points have been read. */
brio_status brio_las_late_records_read(brio_stream *s, brio_builder *b, brio_las_header *h);
/** Gives the mesh the metadata of the records that were read. */
brio_status brio_las_records_give(brio_builder *b, const brio_las_header *h);

/** Takes LASzip's record. */
brio_status brio_laz_form_read(brio_stream *s, brio_las_header *h, const char *bytes, size_t size);
/** Returns how records of a format that this program writes are compressed. */
brio_laz_form brio_laz_form_of(unsigned format, size_t record);
enum { BRIO_LAZ_FORM = 64 };
/** Makes LASzip's record.   chunk  points of a chunk.   Returns its bytes. */
size_t brio_laz_form_write(const brio_laz_form *form, uint32_t chunk, char record[BRIO_LAZ_FORM]);

/* --- fields --- */

/* The fields of LAS records, and how they become properties of a mesh. */

/** A field of a format. */
typedef struct brio_las_field {
    const char *name;
    brio_scalar type;    /* of its property */
    uint8_t at;          /* its first byte in a record */
    uint8_t shift, bits; /* bits > 0: these bits of one byte */
} brio_las_field;

enum { BRIO_LAS_FIELDS = 20 };

/** Lists the fields of a format besides the coordinates, and returns their number.
 *  fields  room for BRIO_LAS_FIELDS. */
size_t brio_las_fields_of(unsigned format, brio_las_field *fields);

/** What becomes of the bytes of a record. */
typedef struct brio_las_column {
    size_t property;
    size_t at;
    unsigned extra; /* an extra byte's type whose values become doubles, or 0 */
    brio_scalar type;
    uint8_t shift, bits;
    double scale, offset;
} brio_las_column;

typedef struct brio_las_plan {
    brio_context *ctx;
    size_t record;
    double scale[3], offset[3];
    brio_las_column *columns;
    size_t num_columns;
    atomic_bool *rounded; /* becomes true where an integer of 64 bits is no double */
} brio_las_plan;

/** Entries of the metadata "las.extras": the name of a property, and the description that its extra bytes had. */
enum { BRIO_LAS_EXTRA_ENTRY = 64 + BRIO_LAS_EXTRA };

/** Adds red, green and blue alone, of a format that has them. */
brio_status brio_las_plan_colours(brio_las_plan *plan, brio_builder *b, const brio_las_header *h);
void brio_las_plan_free(brio_las_plan *plan);

/** Stores the coordinates and properties of `count` records as those of the mesh's vertices from `first` on. Threads
 *  may call this together for different vertices. */
void brio_las_store(const brio_las_plan *plan, const brio_mesh *mesh, const char *records, size_t first, size_t count);

/* --- points --- */

/* The points of a LAS file. */

/* Both return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, and
 * what the builder's sink returns. */

/** Reads the points behind a header; the stream is where they begin. With b->salvage a file may end early. */
brio_status brio_las_read_points(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan);
/** Reads points that are compressed. */
brio_status brio_laz_read(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan);

/* How points are written, plain and compressed. */
extern const struct brio_row_format brio_las_rows, brio_laz_rows;

#endif
