/* Reads the pages of an E57 file through a window that moves over the file.
 *
 * Each page ends with the CRC-32C of its content, most significant byte first. The checksum is computed eight bytes at
 * a time with eight tables.
 *
 * Based on: ASTM E2807-11. Standard specification for 3D imaging data exchange, version 1.0. Huber. The ASTM E57 file
 * format for 3D imaging data exchange. SPIE 7864, 2011. Kounavis Berry. Novel table lookup-based algorithms for
 * high-performance CRC generation. IEEE Transactions on Computers 57, 2008. */
#include "io/e57/e57.h"
#include "base/memory.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <string.h>

/* In pages, both chosen. WINDOW: four of the largest packets, so that a quarter of the window moves at most. BATCH:
 * pages that are read together. */
enum { WINDOW = 4 * (BRIO_E57_MOST_READ / BRIO_E57_CONTENT + 2), BATCH = 64 };

enum { HEADER = 48 /* bytes */, TABLES = 8 };

#define POLYNOMIAL UINT32_C(0x82f63b78) /* of CRC-32C, its bits reversed */

/* --- checksum --- */

brio_status brio_e57_checksum_table(brio_context *ctx, uint32_t (**out)[256]) {
    brio_status status = BRIO_ALLOC(ctx, *out, TABLES);
    if (status != BRIO_OK) return status;
    uint32_t(*table)[256] = *out;
    for (uint32_t i = 0; i < 256; i++) {
        uint32_t rest = i;
        for (int bit = 0; bit < 8; bit++) rest = rest >> 1 ^ (rest & 1 ? POLYNOMIAL : 0);
        table[0][i] = rest;
    }
    for (int k = 1; k < TABLES; k++)
        for (int i = 0; i < 256; i++) table[k][i] = table[k - 1][i] >> 8 ^ table[0][table[k - 1][i] & 255];
    return BRIO_OK;
}

/* Returns the checksum of a page, byte by byte: the content's size is no multiple of eight. */
uint32_t brio_e57_checksum(uint32_t (*const table)[256], const char *page) {
    const uint8_t *bytes = (const uint8_t *)page;
    uint32_t rest = UINT32_MAX;
    size_t i = 0;
    for (; i + 8 <= BRIO_E57_CONTENT; i += 8) {
        uint32_t low = brio_le32(bytes + i) ^ rest, high = brio_le32(bytes + i + 4);
        rest = table[7][low & 255] ^ table[6][low >> 8 & 255] ^ table[5][low >> 16 & 255] ^ table[4][low >> 24] ^
               table[3][high & 255] ^ table[2][high >> 8 & 255] ^ table[1][high >> 16 & 255] ^ table[0][high >> 24];
    }
    for (; i < BRIO_E57_CONTENT; i++) rest = rest >> 8 ^ table[0][(rest ^ bytes[i]) & 255];
    return ~rest;
}

/* --- pages --- */

uint64_t brio_e57_size(const brio_e57_pages *p) {
    return p->length / BRIO_E57_PAGE * BRIO_E57_CONTENT;
}

uint64_t brio_e57_physical(uint64_t logical) {
    return logical / BRIO_E57_CONTENT * BRIO_E57_PAGE + logical % BRIO_E57_CONTENT;
}

brio_status brio_e57_logical(const brio_e57_pages *p, const char *what, uint64_t physical, uint64_t *logical) {
    BRIO_EXPECT(p->stream->ctx, physical < p->length, BRIO_ERR_FORMAT,
                "%s: %s at byte %" PRIu64 ", the file has %" PRIu64 " bytes", p->stream->name, what, physical,
                p->length);
    BRIO_EXPECT(p->stream->ctx, physical % BRIO_E57_PAGE < BRIO_E57_CONTENT, BRIO_ERR_FORMAT,
                "%s: %s at byte %" PRIu64 ", where a checksum is", p->stream->name, what, physical);
    *logical = physical / BRIO_E57_PAGE * BRIO_E57_CONTENT + physical % BRIO_E57_PAGE;
    return BRIO_OK;
}

/* Checks a page and appends its content to the window. */
static brio_status add_page(brio_e57_pages *p, const char *page) {
    const uint8_t *stored = (const uint8_t *)page + BRIO_E57_CONTENT;
    uint32_t expected = (uint32_t)stored[0] << 24 | (uint32_t)stored[1] << 16 | (uint32_t)stored[2] << 8 | stored[3];
    uint32_t found = brio_e57_checksum(p->table, page);
    BRIO_EXPECT(p->stream->ctx, found == expected, BRIO_ERR_FORMAT,
                "%s: the page at byte %" PRIu64 " is damaged: its checksum is %08" PRIx32 ", expected %08" PRIx32,
                p->stream->name, brio_e57_physical(p->first + p->size), found, expected);
    memcpy(p->window + p->size, page, BRIO_E57_CONTENT);
    p->size += BRIO_E57_CONTENT;
    return BRIO_OK;
}

/* Reads pages until the window has `size` bytes. */
static brio_status fill_window(brio_e57_pages *p, size_t size) {
    while (p->size < size) {
        size_t count = (size - p->size) / BRIO_E57_CONTENT;
        if (count > BATCH) count = BATCH;
        BRIO_FORWARD(brio_stream_peek(p->stream, brio_e57_physical(p->first + p->size), p->raw, count * BRIO_E57_PAGE));
        for (size_t i = 0; i < count; i++) BRIO_FORWARD(add_page(p, p->raw + i * BRIO_E57_PAGE));
    }
    return BRIO_OK;
}

/* Moves the window so that it begins with the page of an offset. Where the window goes on it is filled; behind a jump
 * it has only what is needed. */
static brio_status move_window(brio_e57_pages *p, uint64_t logical, size_t need) {
    brio_status status = BRIO_OK;
    uint64_t start = logical - logical % BRIO_E57_CONTENT, end = brio_e57_size(p);
    bool goes_on = p->size && start >= p->first && start <= p->first + p->size;
    if (goes_on) {
        size_t drop = (size_t)(start - p->first);
        memmove(p->window, p->window + drop, p->size - drop);
        p->size -= drop;
    } else {
        p->size = 0;
    }
    p->first = start;
    size_t room = WINDOW * BRIO_E57_CONTENT;
    if (end - start < room) room = (size_t)(end - start);
    BRIO_REQUIRE(p->stream->ctx, logical - start + need <= room, BRIO_ERR_FORMAT,
                 "%s: ends at byte %" PRIu64 ", expected %zu bytes from byte %" PRIu64 " on", p->stream->name,
                 p->length, need, brio_e57_physical(logical));
    BRIO_TRY(brio_progress(p->stream->ctx, "read", p->reports ? (double)start / (double)end : 0));
    size_t least = (size_t)(logical - start) + need;
    BRIO_TRY(fill_window(p, goes_on ? room : (least + BRIO_E57_CONTENT - 1) / BRIO_E57_CONTENT * BRIO_E57_CONTENT));
done:
    if (status != BRIO_OK) p->size = 0;
    return status;
}

brio_status brio_e57_take(brio_e57_pages *p, uint64_t logical, size_t need, const char **bytes) {
    if (logical < p->first || logical - p->first > p->size || p->size - (logical - p->first) < need)
        BRIO_FORWARD(move_window(p, logical, need));
    *bytes = p->window + (logical - p->first);
    return BRIO_OK;
}

/* --- the header --- */

static brio_status read_header(brio_e57_pages *p) {
    brio_stream *s = p->stream;
    char h[HEADER];
    BRIO_FORWARD(brio_stream_peek(s, 0, h, HEADER));
    BRIO_EXPECT(s->ctx, !memcmp(h, "ASTM-E57", 8), BRIO_ERR_FORMAT, "%s: byte 0: expected ASTM-E57: not an E57 file",
                s->name);
    BRIO_EXPECT(s->ctx, brio_le32(h + 8) == 1, BRIO_ERR_FORMAT, "%s: byte 8: version %" PRIu32 ", expected 1", s->name,
                brio_le32(h + 8));
    BRIO_EXPECT(s->ctx, brio_le64(h + 40) == BRIO_E57_PAGE, BRIO_ERR_FORMAT,
                "%s: byte 40: pages of %" PRIu64 " bytes, expected %d", s->name, brio_le64(h + 40), BRIO_E57_PAGE);
    p->length = brio_le64(h + 16);
    BRIO_EXPECT(s->ctx, p->length <= s->size, BRIO_ERR_FORMAT,
                "%s: ends at byte %" PRIu64 ", its header announces %" PRIu64 " bytes", s->name, s->size, p->length);
    BRIO_EXPECT(s->ctx, p->length >= BRIO_E57_PAGE && p->length % BRIO_E57_PAGE == 0, BRIO_ERR_FORMAT,
                "%s: byte 16: a file of %" PRIu64 " bytes, expected whole pages of %d", s->name, p->length,
                BRIO_E57_PAGE);
    BRIO_FORWARD(brio_e57_logical(p, "the XML section", brio_le64(h + 24), &p->xml));
    p->xml_length = brio_le64(h + 32);
    BRIO_EXPECT(s->ctx, p->xml_length <= brio_e57_size(p) - p->xml, BRIO_ERR_FORMAT,
                "%s: byte 32: an XML section of %" PRIu64 " bytes, behind its beginning the file has %" PRIu64, s->name,
                p->xml_length, brio_e57_size(p) - p->xml);
    return BRIO_OK;
}

brio_status brio_e57_pages_open(brio_e57_pages *p, brio_stream *s) {
    *p = (brio_e57_pages){.stream = s};
    BRIO_FORWARD(brio_stream_fill(s, 1));
    BRIO_EXPECT(s->ctx, brio_stream_left(s), BRIO_ERR_FORMAT, "%s: is empty", s->name);
    BRIO_EXPECT(s->ctx, s->size != BRIO_SIZE_UNKNOWN, BRIO_ERR_FORMAT,
                "%s: an E57 file is read from its end first, which a pipe does not allow; expected a regular file",
                s->name);
    BRIO_EXPECT(s->ctx, s->size >= HEADER, BRIO_ERR_FORMAT,
                "%s: ends at byte %" PRIu64 ", the header of an E57 file has %d bytes", s->name, s->size, HEADER);
    BRIO_FORWARD(read_header(p));
    BRIO_FORWARD(brio_e57_checksum_table(s->ctx, &p->table));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, p->raw, BATCH * BRIO_E57_PAGE));
    return BRIO_ALLOC_ZERO(s->ctx, p->window, WINDOW * BRIO_E57_CONTENT + BRIO_E57_SLACK);
}

void brio_e57_pages_close(brio_e57_pages *p) {
    brio_release(p->stream->ctx, p->window);
    brio_release(p->stream->ctx, p->raw);
    brio_release(p->stream->ctx, p->table);
    p->window = p->raw = NULL;
    p->table = NULL;
}
