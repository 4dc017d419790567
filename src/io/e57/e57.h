/* What readers and writers of E57 files share: pages with checksums, the XML section, and packets of numbers. */
#ifndef BRIO_IO_E57_H
#define BRIO_IO_E57_H

#include "base/context.h"
#include "io/builder.h"
#include "io/stream.h"

/* --- pages --- */

/* The pages of an E57 file: 1,020 bytes of content and a checksum each. Content has logical offsets, which do not count
 * the checksums; the file's numbers give physical offsets, which do.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY or
 * BRIO_ERR_CANCELLED. */

enum {
    BRIO_E57_PAGE = 1024,
    BRIO_E57_CONTENT = 1020,    /* bytes of a page before its checksum */
    BRIO_E57_MOST_READ = 65536, /* bytes that one call of brio_e57_take gives, at most: those of a packet */
    BRIO_E57_SLACK = 16         /* bytes behind what brio_e57_take gives that may be read, too; they mean nothing */
};

/** A window of checked pages. Its content is without the checksums: bytes first to first + size - 1. */
typedef struct brio_e57_pages {
    brio_stream *stream;
    uint64_t length;          /* physical bytes of the file, as its header says */
    uint64_t xml, xml_length; /* logical offset and bytes of the XML section */
    uint64_t first;           /* logical offset of the window */
    size_t size;              /* bytes of content in the window */
    char *window;             /* content */
    char *raw;                /* pages as they are in the file */
    uint32_t (*table)[256];   /* for the checksum */
    bool reports;             /* whether the place of the window is the share of the work that is done */
} brio_e57_pages;

/** Makes the tables of the checksum.   out  owned by the caller (brio_release). */
brio_status brio_e57_checksum_table(brio_context *ctx, uint32_t (**out)[256]);
/** Returns the CRC-32C of a page's content. */
uint32_t brio_e57_checksum(uint32_t (*const table)[256], const char *page);

/** Reads the header of a file. Refuses input that is no regular file: the header names places behind all others. Call
 *  brio_e57_pages_close even if this fails. */
brio_status brio_e57_pages_open(brio_e57_pages *p, brio_stream *s);
void brio_e57_pages_close(brio_e57_pages *p);

/** Returns the logical bytes of the file. */
uint64_t brio_e57_size(const brio_e57_pages *p);

/** Turns a physical offset into a logical one. Fails for an offset behind the file or in a checksum.
 *  what  what lies there, for the message. */
brio_status brio_e57_logical(const brio_e57_pages *p, const char *what, uint64_t physical, uint64_t *logical);

/** Returns the physical offset, for messages. */
uint64_t brio_e57_physical(uint64_t logical);

/** Returns `need` bytes of content in *bytes, valid until the next call; need is at most BRIO_E57_MOST_READ. Fails if
 *  the file ends before, or if a checksum is wrong. */
brio_status brio_e57_take(brio_e57_pages *p, uint64_t logical, size_t need, const char **bytes);

/* --- numbers in bits --- */

/* Byte streams of an E57 file, decoded: numbers of 0 to 64 bits, one behind the other, least significant bit first.
 * They arrive in parts of any number of bytes, so that a number may lie in two parts or more. */

/** How a number becomes a value. */
typedef enum brio_e57_kind {
    BRIO_E57_INTEGER, /* least + number */
    BRIO_E57_SCALED,  /* (least + number) * scale + offset */
    BRIO_E57_SINGLE,  /* the bits of a float */
    BRIO_E57_DOUBLE   /* the bits of a double */
} brio_e57_kind;

typedef struct brio_e57_code {
    brio_e57_kind kind;
    unsigned bits; /* of a number: 0 to 64; 32 for SINGLE, 64 for DOUBLE */
    int64_t least; /* INTEGER, SCALED */
    double scale, offset;
} brio_e57_code;

/** A byte stream and where its values go: value i to target + i * stride. */
typedef struct brio_e57_decoder {
    brio_e57_code code;
    brio_scalar type; /* of the target */
    bool tests;       /* stores 1 for each value that is not 0, in place of the value; the type is UINT8 */
    char *target;     /* NULL: values are passed over */
    size_t stride;    /* bytes */
    bool rounded;     /* whether an integer was one that no double has */
    uint64_t done, count;
    uint64_t carry; /* the first `carried` bits of a number whose rest is not there yet */
    unsigned carried;
} brio_e57_decoder;

/** Decodes the next part of a byte stream. Numbers beyond `count` are passed over.
 *  bytes  BRIO_E57_SLACK bytes behind the part may be read, too. */
void brio_e57_decode(brio_e57_decoder *d, const char *bytes, size_t size);

/* --- the XML section --- */

/* The XML section of an E57 file: where the points of each scan are, what they are made of, and the scans' poses. */

/* Chosen: what a false file can request. MOST_FIELDS is of a scan. */
enum { BRIO_E57_MOST_FIELDS = 256, BRIO_E57_NAME = 64, BRIO_E57_MOST_SCANS = 1 << 20 };

/** A number of each point. Its byte stream is the one of its place in the prototype. */
typedef struct brio_e57_field {
    char name[BRIO_E57_NAME]; /* as in the file; of an extension "prefix:name" */
    brio_e57_code code;
    bool text; /* strings, which are passed over */
} brio_e57_field;

typedef struct brio_e57_scan {
    uint64_t section; /* physical offset of its points */
    uint64_t records;
    size_t first_field, num_fields;
    double rotation[4], translation[3]; /* a quaternion w, x, y, z */
} brio_e57_scan;

typedef struct brio_e57_scans {
    brio_e57_scan *scans;
    brio_e57_field *fields; /* of all scans */
    size_t num_scans, scan_capacity, num_fields, field_capacity;
} brio_e57_scans;

/** Reads the XML section. What it has besides points is noted in the builder; a coordinate system becomes the metadata
 *  crs.wkt of its mesh. Call brio_e57_scans_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_e57_xml_read(brio_e57_pages *p, brio_builder *b, brio_e57_scans *out);
void brio_e57_scans_free(brio_context *ctx, brio_e57_scans *scans);

/* --- packets --- */

/* The binary section with the points of a scan: packets, each with a part of every field's byte stream. */

/** Where the packets of a scan are: logical offsets. */
typedef struct brio_e57_section {
    size_t scan; /* its number, for messages */
    uint64_t data, begin, end;
    bool endless; /* whether its header has no length: then the caller finds the end */
} brio_e57_section;

/** Reads the header of a scan's section. Some programs write a length of 0, or that of the header. */
brio_status brio_e57_section_open(brio_e57_pages *p, const brio_e57_scans *scans, size_t scan, brio_e57_section *out);

/** Fails if a section is too short for the records that the XML announces. */
brio_status brio_e57_section_check(const brio_e57_pages *p, const brio_e57_scans *scans,
                                   const brio_e57_section *section);

/** Decodes the packets of a section.
 *  fields    the scan's, for messages.
 *  decoders  one for each of `count` fields. */
brio_status brio_e57_section_read(brio_e57_pages *p, const brio_e57_section *section, const brio_e57_field *fields,
                                  brio_e57_decoder *decoders, size_t count);

/* How points are written. */
extern const struct brio_row_format brio_e57_rows;

#endif
