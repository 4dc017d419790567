/* Blocks and columns of a page: see block.h. A block goes through two small buffers: whatever its size, it takes as
 * much memory as zlib does, a quarter of a megabyte. */
#include "page/block.h"
#include "base/memory.h"
#include <assert.h>
#ifdef BRIO_HAS_ZLIB
#include <zlib.h>
#endif

/* ROOM: bytes of each buffer, a multiple of 3. LEVEL: of zlib, its default. Both chosen. */
enum { ROOM = 3 << 12, LEVEL = 6 };

struct brio_page_block {
    brio_output *out;
    uint8_t plain[ROOM], packed[ROOM];
    char text[ROOM / 3 * 4];
    uint8_t spare[3]; /* bytes that do not yet make four characters */
    size_t used, num_spare;
#ifdef BRIO_HAS_ZLIB
    z_stream stream;
#endif
};

/* --- base 64 --- */

static void put_four(char *to, const uint8_t *from) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint32_t bits = (uint32_t)from[0] << 16 | (uint32_t)from[1] << 8 | from[2];
    for (int i = 0; i < 4; i++) to[i] = digits[bits >> (18 - 6 * i) & 63];
}

/* Writes bytes, at most ROOM, as text; keeps the last one or two. */
static brio_status write_text(brio_page_block *b, const uint8_t *bytes, size_t size) {
    size_t length = 0;
    for (size_t i = 0; i < size; i++) {
        b->spare[b->num_spare++] = bytes[i];
        if (b->num_spare < 3) continue;
        put_four(b->text + length, b->spare);
        length += 4;
        b->num_spare = 0;
    }
    return brio_output_bytes(b->out, b->text, length);
}

static brio_status end_text(brio_page_block *b) {
    char four[4];
    size_t left = b->num_spare;
    if (!left) return BRIO_OK;
    for (size_t i = left; i < 3; i++) b->spare[i] = 0;
    put_four(four, b->spare);
    for (size_t i = left + 1; i < 4; i++) four[i] = '=';
    return brio_output_bytes(b->out, four, sizeof four);
}

/* --- bytes --- */

#ifdef BRIO_HAS_ZLIB

static const bool PACKS = true;

static void *take_memory(void *user, unsigned count, unsigned size) {
    void *block = NULL;
    return brio_resize_to(user, &block, count, size) == BRIO_OK ? block : NULL;
}
static void give_memory(void *user, void *block) {
    brio_release(user, block);
}

static brio_status begin_packing(brio_page_block *b) {
    b->stream = (z_stream){.zalloc = take_memory, .zfree = give_memory, .opaque = b->out->ctx};
    if (deflateInit(&b->stream, LEVEL) == Z_OK) return BRIO_OK;
    b->stream.state = NULL;
    return brio_fail(b->out->ctx, BRIO_ERR_NO_MEMORY, "out of memory for compressing a page");
}

/* Packs what is in the buffer and writes what comes out. */
static brio_status pack(brio_page_block *b, bool last) {
    int result;
    b->stream.next_in = b->plain;
    b->stream.avail_in = (unsigned)b->used;
    do {
        b->stream.next_out = b->packed;
        b->stream.avail_out = ROOM;
        result = deflate(&b->stream, last ? Z_FINISH : Z_NO_FLUSH);
        BRIO_FORWARD(write_text(b, b->packed, ROOM - b->stream.avail_out));
    } while (b->stream.avail_out == 0);
    assert(b->stream.avail_in == 0 && (!last || result == Z_STREAM_END));
    (void)result;
    return BRIO_OK;
}

static void end_packing(brio_page_block *b) {
    deflateEnd(&b->stream);
}

#else

static const bool PACKS = false;

static brio_status begin_packing(brio_page_block *b) {
    (void)b;
    return BRIO_OK;
}

static brio_status pack(brio_page_block *b, bool last) {
    (void)last;
    return write_text(b, b->plain, b->used);
}

static void end_packing(brio_page_block *b) {
    (void)b;
}

#endif

brio_status brio_page_block_begin(brio_page_block **out_block, brio_output *out, size_t layer, const char *name) {
    brio_page_block *b;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(out->ctx, b, 1));
    *out_block = b;
    b->out = out;
    BRIO_FORWARD(begin_packing(b));
    return brio_output_format(
        out, "<script type=\"text/plain\" data-layer=\"%zu\" data-name=\"%s\" data-packed=\"%d\">", layer, name, PACKS);
}

static brio_status flush(brio_page_block *b, bool last) {
    BRIO_FORWARD(pack(b, last));
    b->used = 0;
    return BRIO_OK;
}

brio_status brio_page_byte(brio_page_block *b, uint8_t byte) {
    if (b->used == ROOM) BRIO_FORWARD(flush(b, false));
    b->plain[b->used++] = byte;
    return BRIO_OK;
}

brio_status brio_page_bytes(brio_page_block *b, const void *bytes, size_t size) {
    const uint8_t *from = bytes;
    for (size_t i = 0; i < size; i++) BRIO_FORWARD(brio_page_byte(b, from[i]));
    return BRIO_OK;
}

brio_status brio_page_varint(brio_page_block *b, uint32_t x) {
    for (; x > 127; x >>= 7) BRIO_FORWARD(brio_page_byte(b, (uint8_t)(x | 128)));
    return brio_page_byte(b, (uint8_t)x);
}

brio_status brio_page_block_end(brio_page_block *b) {
    BRIO_FORWARD(flush(b, true));
    BRIO_FORWARD(end_text(b));
    return brio_output_string(b->out, "</script>\n");
}

void brio_page_block_free(brio_page_block *b) {
    if (!b) return;
    end_packing(b);
    brio_release(b->out->ctx, b);
}

/* --- columns --- */

/* Returns what a column stores for a number, by the one before it. */
static uint64_t coded(uint64_t before, uint64_t x, int width, brio_page_mode mode) {
    if (mode == BRIO_PAGE_XOR) return before ^ x;
    const int above = 64 - 8 * width;
    int64_t difference = (int64_t)((x - before) << above) >> above; /* the number of least size, modulo 2^(8 width) */
    return brio_zigzag(difference);
}

brio_status brio_page_put_column(brio_output *out, size_t layer, const char *name, const brio_page_column *column) {
    const brio_page_column c = *column;
    brio_status status = BRIO_OK;
    brio_page_block *b = NULL;
    assert(1 <= c.width && (c.width <= 4 || (c.width == 8 && c.mode == BRIO_PAGE_XOR)));
    BRIO_TRY(brio_page_block_begin(&b, out, layer, name));
    for (int plane = 0; plane < c.width; plane++) {
        uint64_t before = 0;
        for (size_t i = 0; i < c.n; i++) {
            uint64_t x = c.value(c.user, i);
            BRIO_TRY(brio_page_byte(b, (uint8_t)(coded(before, x, c.width, c.mode) >> 8 * plane)));
            BRIO_TRY(brio_look(out->ctx, 1));
            before = x;
        }
    }
    BRIO_TRY(brio_page_block_end(b));
done:
    brio_page_block_free(b);
    return status;
}
