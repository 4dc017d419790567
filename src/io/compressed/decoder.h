/* Decoders of compressed bytes: gzip and raw deflate (zlib), zstd (libzstd). Both libraries are optional; their memory
 * is the context's. */
#ifndef BRIO_IO_COMPRESSED_DECODER_H
#define BRIO_IO_COMPRESSED_DECODER_H

#include "base/context.h"

typedef enum {
    BRIO_PACKING_NONE,
    BRIO_PACKING_GZIP,   /* members one after the other, with zeros behind them perhaps */
    BRIO_PACKING_ZSTD,   /* frames one after the other */
    BRIO_PACKING_DEFLATE /* as in a zip archive: without a header, one after which nothing comes */
} brio_packing;

enum { BRIO_PACKING_LOOK_AT = 4 /* bytes that brio_packing_of looks at */ };

/** Returns the packing of a file by its first bytes. */
brio_packing brio_packing_of(const char *bytes, size_t size);

typedef struct brio_decoder brio_decoder;

/** Makes a decoder.   name  of the file, for messages; kept as a pointer.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (this build has no decoder of the kind), BRIO_ERR_NO_MEMORY. */
brio_status brio_decoder_new(brio_context *ctx, const char *name, brio_packing packing, brio_decoder **out);
void brio_decoder_free(brio_decoder *d);

/** What a call reads and writes. brio_decode moves the places and reduces the counts. */
typedef struct brio_decoder_io {
    const char *in;
    size_t in_left;
    char *out;
    size_t room;
} brio_decoder_io;

/** Decodes until the input is used up or the room is full. May be called again without input, for bytes that had no
 *  room before.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (damaged: with the file and the byte), BRIO_ERR_NO_MEMORY. */
brio_status brio_decode(brio_decoder *d, brio_decoder_io *io);

/** Fails unless what was decoded so far ends at a proper end. */
brio_status brio_decoder_check_end(const brio_decoder *d);

#endif
