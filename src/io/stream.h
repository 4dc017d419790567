/* A file, a pipe, bytes in memory or a part of another stream's file, read once from front to end through one buffer.
 * What is compressed by gzip or zstd is decompressed on the way (unpack.h): then all places are those of decompressed
 * data. The stream knows the byte offset, the line, and the row of the element that is being read, so that every
 * message can name them. It reports progress and can be cancelled.
 *
 * Pointers into the buffer are valid until the next call with the stream. All functions that return a status return
 * BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */
#ifndef BRIO_IO_STREAM_H
#define BRIO_IO_STREAM_H

#include "base/context.h"

#define BRIO_SIZE_UNKNOWN UINT64_MAX

typedef struct brio_stream {
    brio_context *ctx;
    const char *name; /* for messages */
    int file;
    uint64_t size;   /* bytes of a regular file or in memory, otherwise BRIO_SIZE_UNKNOWN */
    char *buffer;    /* capacity + 1 bytes: brio_stream_line can put a 0 behind a line at the end */
    size_t capacity; /* bytes begin to end - 1 were read and are not yet used */
    size_t begin, end;
    uint64_t base;       /* file offset of the first byte of the buffer */
    uint64_t reported;   /* bytes read when progress was last reported */
    size_t line;         /* number of the last line, counted from 1 */
    bool owned;          /* whether to close the file */
    bool waits;          /* whether a read may block: the input is no regular file */
    bool ended;          /* whether the file has no bytes behind the buffer */
    bool truncated;      /* whether more was wanted than the file has */
    bool unended;        /* whether the last line that was read has no line feed: it is the file's last one */
    bool salvaged;       /* whether rows that a file lacks were given up (builder.h) */
    const char *element; /* what is being read, e.g. "vertex", with its row and the number of rows; for messages */
    uint64_t row, rows;
    struct brio_unpacker *unpacker; /* NULL: the bytes are not compressed */
    const char *memory;             /* NULL, or what is read in place of a file */
    struct brio_stream *outer;      /* NULL, or the stream in whose file this one is the bytes from part_at on */
    uint64_t part_at, part_left;    /* raw bytes of the memory or the part that are still to be read */
    struct brio_crc32 *crc;         /* NULL, or the checksum of all bytes that were read into the buffer */
} brio_stream;

/** Opens a file; "-" is standard input. Call brio_stream_close even if this fails. */
brio_status brio_stream_open(brio_stream *s, brio_context *ctx, const char *path);
/** Opens bytes in memory; they are only read, and stay as they are until the stream is closed. Call brio_stream_close
 *  even
 *  if this fails.   name  for messages. */
brio_status brio_stream_open_memory(brio_stream *s, brio_context *ctx, const char *name, const void *bytes,
                                    size_t size);
/** Opens the bytes of another stream once more, from their front. The other stream's size is known and its bytes are
 *  not compressed; it must stay open and not move meanwhile. Call brio_stream_close even if this fails. */
brio_status brio_stream_open_again(brio_stream *s, brio_stream *other);
void brio_stream_close(brio_stream *s);

/** Reads bytes of the file itself, which may be compressed: at most `room`, 0 at the end. For unpack.c. */
brio_status brio_stream_read_raw(brio_stream *s, char *to, size_t room, size_t *got);

/** Reads until the buffer has `need` unused bytes or the file ends. */
brio_status brio_stream_fill(brio_stream *s, size_t need);

static inline size_t brio_stream_left(const brio_stream *s) {
    return s->end - s->begin;
}
static inline uint64_t brio_stream_offset(const brio_stream *s) {
    return s->base + s->begin;
}

/** Returns the next `need` bytes in *bytes and marks them as used. Fails if the file ends before. */
static inline brio_status brio_stream_take(brio_stream *s, size_t need, const char **bytes);

/** Skips `count` bytes. Fails if the file ends before. */
brio_status brio_stream_skip(brio_stream *s, uint64_t count);

/** Returns the next line in *line, with a 0 in place of its end (LF or CR LF), or NULL at the end of the file. */
brio_status brio_stream_line(brio_stream *s, char **line);

/** Reads a pipe or a compressed file to its end into the buffer, so that its size is known and brio_stream_peek works;
 *  the buffer then has all of it and nothing may be taken before. Does nothing for a regular file and for memory. */
brio_status brio_stream_hold(brio_stream *s);

/** Copies bytes from any place of a regular file, of memory, of a stream that brio_stream_hold read, or of a part that
 *  is not compressed, without moving it.
 *  Fails if the file ends before. */
brio_status brio_stream_peek(brio_stream *s, uint64_t offset, void *bytes, size_t size);

/** Names the element that is read from now on, and its number of rows, for messages; row becomes 0. */
void brio_stream_element(brio_stream *s, const char *element, uint64_t rows);

/** Returns the error of a file that ends too early. */
brio_status brio_stream_truncated(brio_stream *s);

/** Fails unless a regular file still has rows * row bytes to read, so that no memory is allocated for rows that are not
 *  there. Accepts every input that is no regular file.
 *  what  the part of the file that announces the rows, for the message. */
brio_status brio_stream_expect(brio_stream *s, uint64_t rows, uint64_t row, const char *what);

static inline brio_status brio_stream_take(brio_stream *s, size_t need, const char **bytes) {
    if (brio_stream_left(s) < need) {
        brio_status status = brio_stream_fill(s, need);
        if (status != BRIO_OK) return status;
        if (brio_stream_left(s) < need) {
            brio_stream_truncated(s);
            return BRIO_ERR_FORMAT;
        }
    }
    *bytes = s->buffer + s->begin;
    s->begin += need;
    return BRIO_OK;
}

#endif
