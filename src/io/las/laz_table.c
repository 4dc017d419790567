/* Reads the table of chunks: compressed integers, each predicted by the last one. */
#include "io/las/laz_table.h"
#include "base/memory.h"
#include "io/las/laz_model.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <string.h>

enum { HEAD = 8, POINTS = 0, BYTES = 1 /* contexts */, MOST_ENTRY = 16 /* bytes of an entry, at most; chosen */ };

/* Finds the table of a file whose writer could not go back to say where it is: the last 8 bytes say it. */
static brio_status find_table(brio_stream *s, uint64_t *at) {
    brio_status status = BRIO_OK;
    char bytes[8];
    uint64_t here = brio_stream_offset(s);
    if (*at <= here && s->size >= here + sizeof bytes) {
        BRIO_TRY(brio_stream_peek(s, s->size - sizeof bytes, bytes, sizeof bytes));
        *at = brio_le64(bytes);
    }
    if (*at <= here || *at + HEAD > s->size || *at > s->size) *at = 0;
done:
    return status;
}

/* Decodes the table.   has_points  whether each entry has its number of points, too. */
static brio_status decode(brio_context *ctx, brio_laz_coder *c, bool has_points, brio_laz_chunk *chunks, size_t count) {
    brio_status status = BRIO_OK;
    brio_laz_arena arena = {.size = brio_laz_integer_bytes(32)};
    brio_laz_integer *integer = NULL;
    brio_laz_chunk last = {0, 0};
    BRIO_TRY(BRIO_ALLOC(ctx, arena.memory, arena.size));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, integer, 1));
    for (size_t i = 0; i < count; i++) {
        if (has_points) last.points = (uint32_t)brio_laz_int32(c, &arena, integer, (int32_t)last.points, POINTS);
        last.bytes = (uint32_t)brio_laz_int32(c, &arena, integer, (int32_t)last.bytes, BYTES);
        chunks[i] = last;
    }
done:
    brio_release(ctx, integer);
    brio_release(ctx, arena.memory);
    return status;
}

/* Checks the table against the file, and sets the numbers of points of chunks of fixed size. */
static brio_status check(brio_stream *s, const brio_las_header *h, uint64_t at, brio_laz_chunk *chunks, size_t count) {
    brio_status status = BRIO_OK;
    uint64_t bytes = 0, points = 0, room = at - brio_stream_offset(s);
    for (size_t i = 0; i < count; i++) {
        if (h->chunk != UINT32_MAX)
            chunks[i].points = h->num_points - points < h->chunk ? (uint32_t)(h->num_points - points) : h->chunk;
        BRIO_REQUIRE(s->ctx, chunks[i].points / BRIO_LAZ_MOST_DENSE <= chunks[i].bytes, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": chunk %zu (counted from 0) cannot have %" PRIu32 " points in %" PRIu32
                     " bytes",
                     s->name, at, i, chunks[i].points, chunks[i].bytes);
        points += chunks[i].points;
        bytes += chunks[i].bytes;
    }
    BRIO_REQUIRE(s->ctx, bytes <= room, BRIO_ERR_FORMAT,
                 "%s: byte %" PRIu64 ": the table of chunks lists %" PRIu64 " bytes, there are %" PRIu64, s->name, at,
                 bytes, room);
    BRIO_REQUIRE(s->ctx, points == h->num_points, BRIO_ERR_FORMAT,
                 "%s: byte %" PRIu64 ": the table of chunks lists %" PRIu64 " points, the header %" PRIu64, s->name, at,
                 points, h->num_points);
done:
    return status;
}

brio_status brio_laz_table_read(brio_stream *s, const brio_las_header *h, uint64_t at, brio_laz_chunk **chunks,
                                size_t *count) {
    brio_status status = BRIO_OK;
    char head[HEAD];
    uint8_t *bytes = NULL;
    brio_laz_chunk *table = NULL;
    brio_laz_coder c = {.past = false};
    *chunks = NULL;
    *count = 0;
    if (s->size == BRIO_SIZE_UNKNOWN) return BRIO_OK;
    BRIO_TRY(find_table(s, &at));
    if (!at) return BRIO_OK;
    BRIO_TRY(brio_stream_peek(s, at, head, HEAD));
    size_t n = brio_le32(head + 4);
    BRIO_REQUIRE(s->ctx, n <= (at - brio_stream_offset(s)) / h->record, BRIO_ERR_FORMAT,
                 "%s: byte %" PRIu64 ": a table of %zu chunks, more than the file has room for", s->name, at, n);
    uint64_t left = s->size - at - HEAD;
    size_t size = left < MOST_ENTRY * (n + 1) ? (size_t)left : MOST_ENTRY * (n + 1);
    BRIO_TRY(BRIO_ALLOC(s->ctx, bytes, size + 1));
    BRIO_TRY(BRIO_ALLOC(s->ctx, table, n + 1));
    BRIO_TRY(brio_stream_peek(s, at + HEAD, bytes, size));
    if (n) {
        brio_laz_coder_begin(&c, bytes, bytes + size);
        BRIO_TRY(decode(s->ctx, &c, h->chunk == UINT32_MAX, table, n));
    }
    BRIO_REQUIRE(s->ctx, !c.past, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": the table of chunks is damaged", s->name, at);
    BRIO_TRY(check(s, h, at, table, n));
    *chunks = table;
    *count = n;
    table = NULL;
done:
    brio_release(s->ctx, bytes);
    brio_release(s->ctx, table);
    return status;
}
