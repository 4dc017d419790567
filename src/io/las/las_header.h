/* The header of a LAS file, and its records of variable length. */
#ifndef BRIO_IO_LAS_HEADER_H
#define BRIO_IO_LAS_HEADER_H

#include "io/builder.h"
#include "io/las/laz_decoder.h"
#include "io/stream.h"

enum { BRIO_LAS_FORMATS = 11 };

/** Bytes of the header of a record of variable length before the points (behind them they are BRIO_RECORD_HEADER), and of a
 *  description of extra bytes; and the places of a description's parts. */
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
/** Returns whether the records of a format have waveforms. */
bool brio_las_has_waves(unsigned format);

/** Returns the bytes of a number of a type of extra bytes, or 0 if there is no such type of one number. */
size_t brio_las_extra_bytes(unsigned type);

/* The functions that read return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */

/** Reads the header and all bytes before the points, and from a file that is not a pipe the records behind the points. What
 *  they say goes to the header and to the metadata of b->mesh. Call brio_las_header_free even if this fails. */
brio_status brio_las_header_read(brio_stream *s, brio_builder *b, brio_las_header *h);
void brio_las_header_free(brio_context *ctx, brio_las_header *h);

/** Takes descriptions of extra bytes: a record's payload. Several records are one list. */
brio_status brio_las_take_extras(brio_builder *b, brio_las_header *h, const char *bytes, size_t size);
/** Names the extra bytes of which nothing was said. */
brio_status brio_las_end_extras(brio_builder *b, const brio_las_header *h);

/** Reads the records before the points. */
brio_status brio_las_records_read(brio_stream *s, brio_builder *b, brio_las_header *h, uint32_t count, uint64_t start);
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

#endif
