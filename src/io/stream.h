/* A file or a pipe read once from front to end through one buffer. It knows where it is (byte offset, line) and what is
 * being read (row of an element), so that every message can say so; it reports progress and can be cancelled.
 *
 * Pointers into the buffer are valid until the next call with the stream. */
#ifndef BRIO_IO_STREAM_H
#define BRIO_IO_STREAM_H

#include "base/context.h"

#define BRIO_SIZE_UNKNOWN UINT64_MAX

typedef struct brio_stream {
    brio_context *ctx;
    const char *name; /* for messages */
    int file;
    uint64_t size;   /* of a regular file, else BRIO_SIZE_UNKNOWN */
    char *buffer;    /* one byte more than its capacity, so that a line at its end can be closed with a 0 */
    size_t capacity; /* the bytes begin .. end are read and not yet used */
    size_t begin, end;
    uint64_t base;       /* offset in the file of the buffer's first byte */
    uint64_t reported;   /* bytes read at the last report of progress */
    size_t line;         /* number of the line read last, from 1 */
    bool owned;          /* the file is to be closed */
    bool waits;          /* a read may block: no regular file */
    bool ended;          /* the file holds nothing behind the buffer */
    const char *element; /* what is being read, e.g. "vertex", and which of how many; for messages */
    uint64_t row, rows;
} brio_stream;

/** Opens a file, "-" being standard input. The stream is to be closed even when this fails. */
brio_status brio_stream_open(brio_stream *s, brio_context *ctx, const char *path);
void brio_stream_close(brio_stream *s);

/** Reads until `need` bytes are there or the file ends. */
brio_status brio_stream_fill(brio_stream *s, size_t need);

static inline size_t brio_stream_left(const brio_stream *s) {
    return s->end - s->begin;
}
static inline uint64_t brio_stream_offset(const brio_stream *s) {
    return s->base + s->begin;
}

/** The next `need` bytes, which are used up; an error when the file ends before. */
static inline brio_status brio_stream_take(brio_stream *s, size_t need, const char **bytes);

/** Uses up `count` bytes without looking at them. */
brio_status brio_stream_skip(brio_stream *s, uint64_t count);

/** The next line, closed with a 0 in place of its end (LF or CR LF); NULL at the end of the file. */
brio_status brio_stream_line(brio_stream *s, char **line);

/** Starts the messages' count of rows of an element. */
void brio_stream_element(brio_stream *s, const char *element, uint64_t rows);

/** The error of a file that ends too early. */
brio_status brio_stream_truncated(brio_stream *s);

/** Fails unless a regular file still has `rows` times `row` bytes to read, so that nothing is allocated on a false
 *  promise.   what  promises them, for the message. */
brio_status brio_stream_expect(brio_stream *s, uint64_t rows, uint64_t row, const char *what);

static inline brio_status brio_stream_take(brio_stream *s, size_t need, const char **bytes) {
    if (brio_stream_left(s) < need) {
        brio_status status = brio_stream_fill(s, need);
        if (status != BRIO_OK) return status;
        if (brio_stream_left(s) < need) return brio_stream_truncated(s);
    }
    *bytes = s->buffer + s->begin;
    s->begin += need;
    return BRIO_OK;
}

#endif
