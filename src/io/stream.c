/* Buffered input from a file, a pipe or memory.
 *
 * The buffer has BLOCK bytes, or the size of a smaller file, and moves forward over the file. When more bytes are
 * needed, the unused ones move to the front. The buffer grows only for a line or a request longer than itself, up to
 * MAX_LINE. */
#include "io/stream.h"
#include "base/memory.h"
#include "io/blocks.h"
#include "io/crc32.h"
#include "io/unpack.h"
#include "io/wait.h"
#include "platform/file.h"
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#define BYTE_ORDER_MARK "\xef\xbb\xbf" /* of UTF-8: some editors begin texts with it */

enum { BLOCK = BRIO_IO_BLOCK, MAX_LINE = 1 << 28 /* chosen */ };

/* Makes the buffer and looks at the first bytes. */
static brio_status start(brio_stream *s) {
    size_t capacity = s->size < BLOCK ? (size_t)s->size + 1 : BLOCK;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->buffer, capacity + 1));
    s->capacity = capacity;
    return brio_unpack_start(s);
}

brio_status brio_stream_open(brio_stream *s, brio_context *ctx, const char *path) {
    bool standard = !strcmp(path, "-");
    *s = (brio_stream){.ctx = ctx, .name = standard ? "standard input" : path, .file = -1, .size = BRIO_SIZE_UNKNOWN};
    s->file = standard ? BRIO_INPUT : brio_open_input(path);
    s->owned = !standard && s->file >= 0;
    BRIO_EXPECT(ctx, s->file >= 0, BRIO_ERR_OPEN, "%s: %s", s->name, strerror(errno));
    brio_place_facts facts;
    bool regular = brio_find_facts_open(s->file, &facts) && facts.kind == BRIO_IS_FILE;
    int64_t at = regular ? brio_place_in(s->file) : -1;
    s->waits = !regular;
    /* special file systems report a size of 0 for files with content */
    if (at >= 0 && facts.size > (uint64_t)at) s->size = facts.size - (uint64_t)at;
    return start(s);
}

brio_status brio_stream_open_memory(brio_stream *s, brio_context *ctx, const char *name, const void *bytes,
                                    size_t size) {
    *s = (brio_stream){.ctx = ctx, .name = name, .file = -1, .size = size, .part_left = size};
    s->memory = size ? bytes : "";
    return start(s);
}

brio_status brio_stream_open_again(brio_stream *s, brio_stream *other) {
    *s = (brio_stream){.ctx = other->ctx, .name = other->name, .file = -1, .outer = other, .size = other->size};
    s->part_left = other->size;
    return start(s);
}

void brio_stream_close(brio_stream *s) {
    brio_unpack_end(s);
    if (s->owned) brio_close(s->file);
    s->owned = false;
    brio_release(s->ctx, s->buffer);
    s->buffer = NULL;
}

static brio_status report(brio_stream *s) {
    uint64_t read_so_far = s->base + s->end;
    if (read_so_far - s->reported < BLOCK) return BRIO_OK;
    s->reported = read_so_far;
    double share = s->outer                       ? (double)s->part_at / (double)s->outer->size
                   : s->unpacker                  ? brio_unpack_share(s)
                   : s->size == BRIO_SIZE_UNKNOWN ? 0
                                                  : (double)read_so_far / (double)s->size;
    return brio_progress(s->ctx, "read", share < 1 ? share : 1);
}

static brio_status make_room(brio_stream *s, size_t need) {
    if (s->begin) {
        memmove(s->buffer, s->buffer + s->begin, brio_stream_left(s));
        s->base += s->begin;
        s->end -= s->begin;
        s->begin = 0;
    }
    if (need <= s->capacity) return BRIO_OK;
    size_t capacity = need > 2 * s->capacity ? need : 2 * s->capacity;
    brio_status status = BRIO_RESIZE(s->ctx, s->buffer, capacity + 1);
    if (status == BRIO_OK) s->capacity = capacity;
    return status;
}

/* Reads the next bytes of memory, or of the part that the stream is of another one's file. */
static brio_status read_part(brio_stream *s, char *to, size_t room, size_t *got) {
    brio_status status = BRIO_OK;
    *got = room < s->part_left ? room : (size_t)s->part_left;
    if (s->memory)
        memcpy(to, s->memory + s->part_at, *got);
    else
        status = brio_stream_peek(s->outer, s->part_at, to, *got);
    s->part_at += *got;
    s->part_left -= *got;
    return status;
}

brio_status brio_stream_read_raw(brio_stream *s, char *to, size_t room, size_t *got) {
    *got = 0;
    if (s->outer || s->memory) return read_part(s, to, room, got);
    for (;;) {
        if (s->waits) BRIO_FORWARD(brio_wait_for(s->ctx, s->file, BRIO_WAIT_READ, 0));
        int64_t count = brio_read_bytes(s->file, to, room);
        if (count < 0 && (errno == EINTR || errno == EAGAIN)) { /* a signal: the caller may want to cancel */
            BRIO_FORWARD(brio_wait_a_moment(s->ctx, BRIO_WAIT_READ, 0));
            continue;
        }
        BRIO_EXPECT(s->ctx, count >= 0, BRIO_ERR_OPEN, "%s: %s", s->name, strerror(errno));
        *got = (size_t)count;
        return BRIO_OK;
    }
    return BRIO_OK;
}

brio_status brio_stream_fill(brio_stream *s, size_t need) {
    if (brio_stream_left(s) >= need || s->ended) return BRIO_OK;
    BRIO_FORWARD(make_room(s, need));
    while (brio_stream_left(s) < need && !s->ended) {
        char *to = s->buffer + s->end;
        size_t room = s->capacity - s->end, got = 0;
        BRIO_FORWARD(s->unpacker ? brio_unpack_read(s, to, room, &got) : brio_stream_read_raw(s, to, room, &got));
        if (s->crc) brio_crc32_add(s->crc, to, got);
        s->ended = got == 0;
        s->end += got;
        BRIO_FORWARD(report(s));
    }
    return BRIO_OK;
}

brio_status brio_stream_hold(brio_stream *s) {
    if (s->size != BRIO_SIZE_UNKNOWN) return BRIO_OK;
    while (!s->ended) BRIO_FORWARD(brio_stream_fill(s, brio_stream_left(s) + 1));
    s->size = s->base + s->end;
    return BRIO_OK;
}

brio_status brio_stream_skip(brio_stream *s, uint64_t count) {
    while (count) {
        BRIO_FORWARD(brio_stream_fill(s, 1));
        size_t left = brio_stream_left(s);
        if (!left) return brio_stream_truncated(s);
        if (left > count) left = (size_t)count;
        s->begin += left;
        count -= left;
    }
    return BRIO_OK;
}

brio_status brio_stream_peek(brio_stream *s, uint64_t offset, void *bytes, size_t size) {
    if (offset >= s->base && offset - s->base <= s->end && size <= s->end - (offset - s->base)) {
        memcpy(bytes, s->buffer + (offset - s->base), size);
        return BRIO_OK;
    }
    BRIO_EXPECT(s->ctx, offset <= s->size && size <= s->size - offset, BRIO_ERR_FORMAT, "%s: ends at byte %" PRIu64,
                s->name, s->size);
    if (s->memory) {
        memcpy(bytes, s->memory + offset, size);
        return BRIO_OK;
    }
    if (s->outer) return brio_stream_peek(s->outer, s->part_at - s->base - s->end + offset, bytes, size);
    int64_t here = brio_place_in(s->file);
    BRIO_EXPECT(s->ctx, here >= 0, BRIO_ERR_OPEN, "%s: %s", s->name, strerror(errno));
    uint64_t start = (uint64_t)here - s->base - s->end;
    char *to = bytes;
    while (size) {
        int64_t got = brio_read_bytes_at(s->file, to, size, start + offset);
        if (got < 0 && errno == EINTR) continue;
        BRIO_EXPECT(s->ctx, got >= 0, BRIO_ERR_OPEN, "%s: %s", s->name, strerror(errno));
        BRIO_EXPECT(s->ctx, got > 0, BRIO_ERR_FORMAT, "%s: ends at byte %" PRIu64, s->name, offset);
        to += got;
        size -= (size_t)got;
        offset += (uint64_t)got;
    }
    return BRIO_OK;
}

/* Finds the length of the next line without its end, or brio_stream_left if the file ends without one. */
static brio_status line_length(brio_stream *s, size_t *length) {
    size_t searched = 0;
    for (;;) {
        const char *start = s->buffer + s->begin;
        size_t left = brio_stream_left(s);
        const char *end = left > searched ? memchr(start + searched, '\n', left - searched) : NULL;
        *length = end ? (size_t)(end - start) : left;
        if (end || s->ended) return BRIO_OK;
        searched = left;
        BRIO_EXPECT(s->ctx, searched < MAX_LINE, BRIO_ERR_FORMAT, "%s: line %zu: longer than %d bytes: not a text",
                    s->name, s->line + 1, MAX_LINE);
        BRIO_FORWARD(brio_stream_fill(s, searched + 1));
    }
    return BRIO_OK;
}

brio_status brio_stream_line(brio_stream *s, char **line) {
    size_t length;
    *line = NULL;
    BRIO_FORWARD(line_length(s, &length));
    if (!length && !brio_stream_left(s)) return BRIO_OK;
    char *text = s->buffer + s->begin;
    s->unended = length == brio_stream_left(s);
    s->begin += length + !s->unended;
    s->line++;
    BRIO_EXPECT(s->ctx, !length || !memchr(text, 0, length), BRIO_ERR_FORMAT,
                "%s: line %zu: holds a byte 0: not a text", s->name, s->line);
    while (length && text[length - 1] == '\r') length--;
    BRIO_EXPECT(s->ctx, !length || !memchr(text, '\r', length), BRIO_ERR_FORMAT,
                "%s: line %zu: a carriage return within it; lines end with a line feed", s->name, s->line);
    text[length] = 0;
    *line = s->line == 1 && !strncmp(text, BYTE_ORDER_MARK, 3) ? text + 3 : text;
    return BRIO_OK;
}

void brio_stream_element(brio_stream *s, const char *element, uint64_t rows) {
    s->element = element;
    s->row = 0;
    s->rows = rows;
}

brio_status brio_stream_truncated(brio_stream *s) {
    s->truncated = true;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT,
                     "%s: ends at byte %" PRIu64 " in %s %" PRIu64 " (counted from 0) of %" PRIu64, s->name,
                     s->base + s->end, s->element ? s->element : "row", s->row, s->rows);
}

brio_status brio_stream_expect(brio_stream *s, uint64_t rows, uint64_t row, const char *what) {
    uint64_t promised;
    if (__builtin_mul_overflow(rows, row, &promised)) promised = UINT64_MAX;
    if (s->size == BRIO_SIZE_UNKNOWN) return BRIO_OK;
    uint64_t offset = brio_stream_offset(s), left = s->size > offset ? s->size - offset : 0;
    if (promised <= left) return BRIO_OK;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT,
                     "%s: %s promises at least %" PRIu64 " bytes after byte %" PRIu64 ", the file has %" PRIu64,
                     s->name, what, promised, offset, left);
}
