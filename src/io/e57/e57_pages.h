/* The pages of an E57 file: 1,020 bytes of content and a checksum each. Content has logical offsets, which do not count
 * the checksums; the file's numbers give physical offsets, which do.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY or
 * BRIO_ERR_CANCELLED. */
#ifndef BRIO_IO_E57_PAGES_H
#define BRIO_IO_E57_PAGES_H

#include "io/stream.h"

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

#endif
