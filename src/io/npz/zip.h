/* Zip archives: the table of entries at their end, and entries as streams.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY or
 * BRIO_ERR_CANCELLED. */
#ifndef BRIO_IO_NPZ_ZIP_H
#define BRIO_IO_NPZ_ZIP_H

#include "io/crc32.h"
#include "io/stream.h"

enum { BRIO_ZIP_NAME = 128 };

typedef struct brio_zip_entry {
    char name[BRIO_ZIP_NAME]; /* cut off if it is longer */
    uint64_t header;          /* where its own header begins */
    uint64_t packed, size;    /* bytes in the archive, and decompressed */
    uint32_t crc;
    unsigned method, flags;
} brio_zip_entry;

typedef struct brio_zip {
    brio_stream *stream; /* a regular file, or held in memory */
    brio_zip_entry *entries;
    size_t num_entries;
    uint64_t table; /* where the table begins: entries end before it */
} brio_zip;

/** Reads the table. Call brio_zip_close even if this fails. */
brio_status brio_zip_open(brio_zip *z, brio_stream *s);
void brio_zip_close(brio_zip *z);

/** An entry that is read. */
typedef struct brio_zip_part {
    brio_stream stream;
    const brio_zip_entry *entry;
    char *name; /* FILE: ENTRY, for messages */
    brio_crc32 crc;
} brio_zip_part;

/** Opens an entry. The stream's size is the entry's. Call brio_zip_part_close even if this fails. */
brio_status brio_zip_part_open(brio_zip_part *p, const brio_zip *z, const brio_zip_entry *e);

/** Reads the rest of the entry, and checks its length and its checksum. */
brio_status brio_zip_part_finish(brio_zip_part *p);

void brio_zip_part_close(brio_zip_part *p);

#endif
