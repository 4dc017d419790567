/* Decompresses the bytes of a stream: takes blocks of the file, and gives them to the decoder. */
#include "io/unpack.h"
#include "base/memory.h"
#include <string.h>
#include <strings.h>

/* Both chosen. BLOCK: compressed bytes that are read at a time. TAR: where a tar archive says what it is. */
enum { BLOCK = 1 << 18, TAR = 257, LOOK_AT = TAR + 5 };

size_t brio_unpacked_length(const char *path) {
    static const char *const extensions[] = {".gz", ".zst"};
    size_t length = strlen(path);
    for (int i = 0; i < 2; i++) {
        size_t suffix = strlen(extensions[i]);
        if (length > suffix && !strcasecmp(path + length - suffix, extensions[i])) return length - suffix;
    }
    return length;
}

/* Refuses what is in the compressed file if it has to be unpacked again. */
static brio_status refuse_archives(brio_stream *s) {
    BRIO_FORWARD(brio_stream_fill(s, LOOK_AT));
    const char *bytes = s->buffer + s->begin;
    size_t size = brio_stream_left(s);
    BRIO_EXPECT(s->ctx, brio_packing_of(bytes, size) == BRIO_PACKING_NONE, BRIO_ERR_FORMAT,
                "%s: it is compressed again; only one level is decompressed", s->name);
    BRIO_EXPECT(s->ctx, size < LOOK_AT || memcmp(bytes + TAR, "ustar", 5) != 0, BRIO_ERR_FORMAT,
                "%s: it is a tar archive; unpack the file that is wanted", s->name);
    return BRIO_OK;
}

brio_status brio_unpack_start(brio_stream *s) {
    static const char suffix[] = ", decompressed";
    brio_unpacker *u = NULL;
    BRIO_FORWARD(brio_stream_fill(s, BRIO_PACKING_LOOK_AT));
    brio_packing packing = brio_packing_of(s->buffer + s->begin, brio_stream_left(s));
    if (packing == BRIO_PACKING_NONE) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(s->ctx, u, 1));
    s->unpacker = u;
    BRIO_FORWARD(brio_decoder_new(s->ctx, s->name, packing, &u->decoder));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, u->name, strlen(s->name) + sizeof suffix));
    strcpy(u->name, s->name);
    strcat(u->name, suffix);
    u->size = s->size;
    u->taken = s->base + s->end;
    /* what the stream has read becomes the first block */
    u->packed = s->buffer;
    u->capacity = s->capacity;
    u->end = s->end;
    u->packed_ended = s->ended;
    s->buffer = NULL;
    s->capacity = s->begin = s->end = 0;
    s->size = BRIO_SIZE_UNKNOWN;
    s->reported = 0;
    s->ended = false;
    s->name = u->name;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->buffer, BLOCK + 1));
    s->capacity = BLOCK;
    return refuse_archives(s);
}

brio_status brio_unpack_deflate(brio_stream *s) {
    brio_unpacker *u = NULL;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(s->ctx, u, 1));
    s->unpacker = u;
    u->size = s->part_left;
    BRIO_FORWARD(brio_decoder_new(s->ctx, s->name, BRIO_PACKING_DEFLATE, &u->decoder));
    u->capacity = s->part_left < BLOCK ? (size_t)s->part_left + 1 : BLOCK;
    return BRIO_ALLOC(s->ctx, u->packed, u->capacity);
}

/* Reads the next block of the compressed file, if the last one is used up. */
static brio_status next_block(brio_stream *s) {
    brio_unpacker *u = s->unpacker;
    size_t got;
    if (u->begin < u->end || u->packed_ended) return BRIO_OK;
    BRIO_FORWARD(brio_stream_read_raw(s, u->packed, u->capacity, &got));
    u->begin = 0;
    u->end = got;
    u->taken += got;
    u->packed_ended = got == 0;
    return BRIO_OK;
}

brio_status brio_unpack_read(brio_stream *s, char *to, size_t room, size_t *got) {
    brio_unpacker *u = s->unpacker;
    *got = 0;
    for (;;) {
        BRIO_FORWARD(next_block(s));
        brio_decoder_io io = {u->packed + u->begin, u->end - u->begin, to, room};
        BRIO_FORWARD(brio_decode(u->decoder, &io));
        u->begin = u->end - io.in_left;
        *got = room - io.room;
        if (*got) return BRIO_OK;
        if (u->packed_ended && u->begin == u->end) return brio_decoder_check_end(u->decoder);
    }
    return BRIO_OK;
}

void brio_unpack_end(brio_stream *s) {
    brio_unpacker *u = s->unpacker;
    if (!u) return;
    brio_decoder_free(u->decoder);
    brio_release(s->ctx, u->packed);
    brio_release(s->ctx, u->name);
    brio_release(s->ctx, u);
    s->unpacker = NULL;
}

double brio_unpack_share(const brio_stream *s) {
    const brio_unpacker *u = s->unpacker;
    return u->size == BRIO_SIZE_UNKNOWN ? 0 : (double)u->taken / (double)u->size;
}
