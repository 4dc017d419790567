/* Compressed input: bytes that are decompressed while a stream takes them. */
#ifndef BRIO_IO_UNPACK_H
#define BRIO_IO_UNPACK_H

#include "io/compressed/decoder.h"
#include "io/stream.h"

typedef struct brio_unpacker {
    brio_decoder *decoder;
    char *packed; /* capacity bytes; begin to end - 1 were read and are not yet decoded */
    size_t begin, end, capacity;
    bool packed_ended; /* whether there are no bytes behind `packed` */
    uint64_t size;     /* of the compressed file, or BRIO_SIZE_UNKNOWN */
    uint64_t taken;    /* bytes of it that were read */
    char *name;        /* for messages about what was decompressed */
} brio_unpacker;

/** Returns the length of a path without .gz or .zst at its end. */
size_t brio_unpacked_length(const char *path);

/** Looks at the first bytes of a stream that was just opened. If they are those of gzip or zstd, the stream gives
 *  decompressed bytes from now on; its size is then unknown, and its name says that places are those of decompressed
 *  data.
 *  Returns as brio_stream_fill, or BRIO_ERR_FORMAT if this build cannot decompress it or it holds an archive. */
brio_status brio_unpack_start(brio_stream *s);

/** Makes a stream, whose raw bytes are deflate without a header, give decompressed bytes.
 *  Returns as brio_decoder_new. */
brio_status brio_unpack_deflate(brio_stream *s);

/** Reads decompressed bytes: at most `room`, 0 at the end. Returns as brio_stream_fill. */
brio_status brio_unpack_read(brio_stream *s, char *to, size_t room, size_t *got);

void brio_unpack_end(brio_stream *s);

/** Returns the share of the compressed file that was read. */
double brio_unpack_share(const brio_stream *s);

#endif
