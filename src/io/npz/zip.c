/* Reads the table of a zip archive, which is at its end, and opens entries: stored ones, and those that are compressed
 * by deflate. Archives over 4 GiB have their numbers in fields of 64 bits (zip64).
 *
 * Based on: PKWARE. .ZIP file format specification, version 6.3.10. 2022. */
#include "io/npz/zip.h"
#include "base/memory.h"
#include "base/sort.h"
#include "io/little_endian.h"
#include "io/unpack.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* Lengths of the records without their variable parts, and the longest comment at the end. */
enum { END = 22, END64_PLACE = 20, END64 = 56, ENTRY = 46, OWN_HEADER = 30, LONGEST_COMMENT = 65535 };
/* MOST_DENSE: deflate makes at most 1032 bytes of one. BUFFER: chosen. */
enum {
    STORED = 0,
    DEFLATED = 8,
    ENCRYPTED = 1,
    MOST_DENSE = 1032,
    BUFFER = 1 << 18,
    WIDE = 1 /* id of zip64 fields */
};

static brio_status damaged(const brio_stream *s, uint64_t at, const char *what) {
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": %s", s->name, at, what);
}

/* --- the table --- */

/* Finds the record at the end of the archive, behind which there may be a comment. */
static brio_status find_end(brio_stream *s, char end[END], uint64_t *at) {
    brio_status status = BRIO_OK;
    char *tail = NULL;
    size_t size = s->size < END + LONGEST_COMMENT ? (size_t)s->size : END + LONGEST_COMMENT;
    BRIO_TRY(BRIO_ALLOC(s->ctx, tail, size + 1));
    BRIO_TRY(brio_stream_peek(s, s->size - size, tail, size));
    for (size_t i = size + 1; i-- > END;) {
        const char *p = tail + i - END;
        if (memcmp(p, "PK\5\6", 4) != 0 || brio_le16(p + 20) != size - i) continue;
        memcpy(end, p, END);
        *at = s->size - size + (uint64_t)(p - tail);
        goto done;
    }
    status = brio_fail(s->ctx, BRIO_ERR_FORMAT,
                       "%s: the zip archive has no table at its end: %" PRIu64 " bytes, perhaps not all of them",
                       s->name, s->size);
done:
    brio_release(s->ctx, tail);
    return status;
}

/* Finds where the table is, its bytes and its entries, by the record at the end or by the one for large archives. */
static brio_status find_table(brio_zip *z, uint64_t *bytes, uint64_t *count) {
    brio_stream *s = z->stream;
    char end[END] = {0}, place[END64_PLACE], large[END64];
    uint64_t at = 0;
    BRIO_FORWARD(find_end(s, end, &at));
    *count = brio_le16(end + 10);
    *bytes = brio_le32(end + 12);
    z->table = brio_le32(end + 16);
    if (at >= END64_PLACE) {
        BRIO_FORWARD(brio_stream_peek(s, at - END64_PLACE, place, END64_PLACE));
        if (!memcmp(place, "PK\6\7", 4)) {
            uint64_t there = brio_le64(place + 8);
            if (there > at || at - there < END64)
                return damaged(s, at, "the record of the large archive is out of place");
            BRIO_FORWARD(brio_stream_peek(s, there, large, END64));
            if (memcmp(large, "PK\6\6", 4) != 0) return damaged(s, there, "expected the record of a large archive");
            *count = brio_le64(large + 32);
            *bytes = brio_le64(large + 40);
            z->table = brio_le64(large + 48);
        }
    }
    if (z->table > at || *bytes > at - z->table) return damaged(s, at, "the table of the archive is out of place");
    if (*count > *bytes / ENTRY) return damaged(s, at, "the table of the archive has no room for its entries");
    return BRIO_OK;
}

/* Takes the numbers of 64 bits from the extra field, for those that are all ones. Returns false if they are not
 * there. */
static bool take_wide(brio_zip_entry *e, const uint8_t *extra, size_t size) {
    uint64_t *const numbers[] = {&e->size, &e->packed, &e->header};
    bool needed = e->size == UINT32_MAX || e->packed == UINT32_MAX || e->header == UINT32_MAX;
    while (needed && size >= 4) {
        size_t id = brio_le16(extra), length = brio_le16(extra + 2), at = 0;
        extra += 4;
        size -= 4;
        if (length > size) return false;
        for (int i = 0; id == WIDE && i < 3; i++) {
            if (*numbers[i] != UINT32_MAX) continue;
            if (length - at < 8) return false;
            *numbers[i] = brio_le64(extra + at);
            at += 8;
        }
        if (id == WIDE) return true;
        extra += length;
        size -= length;
    }
    return !needed;
}

/* Reads an entry of the table. Returns its length, or 0 if it is damaged. */
static size_t read_entry(const uint8_t *p, size_t left, brio_zip_entry *e) {
    if (left < ENTRY || memcmp(p, "PK\1\2", 4) != 0) return 0;
    size_t name = brio_le16(p + 28), extra = brio_le16(p + 30), comment = brio_le16(p + 32);
    if (left - ENTRY < name + extra + comment) return 0;
    *e = (brio_zip_entry){.flags = brio_le16(p + 8),
                          .method = brio_le16(p + 10),
                          .crc = brio_le32(p + 16),
                          .packed = brio_le32(p + 20),
                          .size = brio_le32(p + 24),
                          .header = brio_le32(p + 42)};
    memcpy(e->name, p + ENTRY, name < sizeof e->name ? name : sizeof e->name - 1);
    if (!take_wide(e, p + ENTRY + name, extra)) return 0;
    return ENTRY + name + extra + comment;
}

static int compare_places(uint32_t a, uint32_t b, const void *user) {
    const brio_zip_entry *e = user;
    return e[a].header < e[b].header ? -1 : e[a].header > e[b].header;
}

/* Refuses entries that share bytes: a small archive would be as many arrays as its table has lines. */
static brio_status refuse_overlaps(const brio_zip *z) {
    brio_status status = BRIO_OK;
    const brio_stream *s = z->stream;
    const brio_zip_entry *e = z->entries;
    uint32_t *order = NULL;
    BRIO_REQUIRE(s->ctx, z->num_entries < UINT32_MAX, BRIO_ERR_FORMAT, "%s: %zu entries of the archive", s->name,
                 z->num_entries);
    BRIO_TRY(BRIO_ALLOC(s->ctx, order, z->num_entries));
    for (size_t i = 0; i < z->num_entries; i++) order[i] = (uint32_t)i;
    brio_sort_indices(order, z->num_entries, compare_places, e);
    for (size_t i = 1; i < z->num_entries; i++) {
        const brio_zip_entry *a = &e[order[i - 1]], *b = &e[order[i]];
        uint64_t room = b->header - a->header;
        BRIO_REQUIRE(s->ctx, room >= OWN_HEADER && a->packed <= room - OWN_HEADER, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": the entries %s and %s of the archive overlap", s->name, b->header, a->name,
                     b->name);
    }
done:
    brio_release(s->ctx, order);
    return status;
}

brio_status brio_zip_open(brio_zip *z, brio_stream *s) {
    brio_status status = BRIO_OK;
    uint64_t bytes = 0, count = 0;
    uint8_t *table = NULL;
    *z = (brio_zip){.stream = s};
    BRIO_TRY(brio_stream_hold(s));
    BRIO_TRY(find_table(z, &bytes, &count));
    BRIO_TRY(BRIO_ALLOC(s->ctx, table, bytes + 1));
    BRIO_TRY(brio_stream_peek(s, z->table, table, bytes));
    BRIO_TRY(BRIO_ALLOC(s->ctx, z->entries, count));
    for (uint64_t i = 0, at = 0; i < count; i++) {
        size_t length = read_entry(table + at, (size_t)(bytes - at), &z->entries[i]);
        if (!length) BRIO_TRY(damaged(s, z->table + at, "a damaged entry of the archive's table"));
        at += length;
    }
    z->num_entries = (size_t)count;
    BRIO_TRY(refuse_overlaps(z));
done:
    brio_release(s->ctx, table);
    return status;
}

void brio_zip_close(brio_zip *z) {
    if (z->stream) brio_release(z->stream->ctx, z->entries);
}

/* --- entries --- */

/* Checks what the table says of an entry against the archive, and returns where its bytes begin. */
static brio_status find_bytes(const brio_zip *z, const brio_zip_entry *e, const char *name, uint64_t *at) {
    brio_stream *s = z->stream;
    char own[OWN_HEADER];
    BRIO_EXPECT(s->ctx, !(e->flags & ENCRYPTED), BRIO_ERR_FORMAT, "%s: is encrypted", name);
    BRIO_EXPECT(s->ctx, e->method == STORED || e->method == DEFLATED, BRIO_ERR_FORMAT,
                "%s: compressed by method %u of zip, expected 0 (stored) or 8 (deflate)", name, e->method);
    bool possible = e->method == STORED ? e->packed == e->size : e->size / MOST_DENSE <= e->packed;
    BRIO_EXPECT(s->ctx, possible, BRIO_ERR_FORMAT, "%s: %" PRIu64 " bytes cannot stand for %" PRIu64, name, e->packed,
                e->size);
    if (z->table < OWN_HEADER || e->header > z->table - OWN_HEADER)
        return damaged(s, z->table, "an entry of the archive is out of place");
    BRIO_FORWARD(brio_stream_peek(s, e->header, own, OWN_HEADER));
    if (memcmp(own, "PK\3\4", 4) != 0) return damaged(s, e->header, "expected the header of an entry of the archive");
    *at = e->header + OWN_HEADER + brio_le16(own + 26) + brio_le16(own + 28);
    if (*at > z->table || e->packed > z->table - *at)
        return damaged(s, e->header, "an entry of the archive runs over its end");
    return BRIO_OK;
}

brio_status brio_zip_part_open(brio_zip_part *p, const brio_zip *z, const brio_zip_entry *e) {
    brio_context *ctx = z->stream->ctx;
    brio_stream *s = &p->stream;
    size_t length = strlen(z->stream->name) + strlen(e->name) + 3;
    p->entry = e;
    p->name = NULL;
    *s = (brio_stream){.ctx = ctx, .file = -1, .outer = z->stream, .size = e->size, .part_left = e->packed};
    BRIO_FORWARD(BRIO_ALLOC(ctx, p->name, length));
    snprintf(p->name, length, "%s: %s", z->stream->name, e->name);
    s->name = p->name;
    BRIO_FORWARD(find_bytes(z, e, p->name, &s->part_at));
    brio_crc32_begin(&p->crc);
    s->crc = &p->crc;
    size_t capacity = e->size < BUFFER ? (size_t)e->size + 1 : BUFFER;
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->buffer, capacity + 1));
    s->capacity = capacity;
    if (e->method == DEFLATED) BRIO_FORWARD(brio_unpack_deflate(s));
    return BRIO_OK;
}

brio_status brio_zip_part_finish(brio_zip_part *p) {
    brio_stream *s = &p->stream;
    do {
        s->begin = s->end;
        BRIO_FORWARD(brio_stream_fill(s, 1));
    } while (brio_stream_left(s));
    uint64_t size = s->base + s->end;
    BRIO_EXPECT(s->ctx, size == s->size && brio_crc32_end(&p->crc) == p->entry->crc, BRIO_ERR_FORMAT,
                "%s: is damaged: %" PRIu64 " bytes of %" PRIu64 ", checksum %08" PRIx32 ", expected %08" PRIx32,
                s->name, size, s->size, brio_crc32_end(&p->crc), p->entry->crc);
    return BRIO_OK;
}

void brio_zip_part_close(brio_zip_part *p) {
    brio_context *ctx = p->stream.ctx;
    brio_stream_close(&p->stream);
    if (ctx) brio_release(ctx, p->name);
}
