/* Reads the chunks of a LAZ file.
 *
 * With a table of chunks, as many chunks as there are threads are read, and each thread decodes chunks: the points of a
 * chunk go to their places in the mesh, so the order of the threads does not matter. Without a table (a pipe, or a file
 * whose writer was interrupted) one chunk is read after the other: layers say their sizes, and a chunk without layers
 * ends where its decoder stops. Then the decoder begins with a window of the bytes that follow, and again with a
 * larger one if these did not suffice.
 *
 * Based on: Isenburg. LASzip: lossless compression of LiDAR data. Photogrammetric Engineering and Remote Sensing 79,
 * 2013. */
#include "base/memory.h"
#include "base/team.h"
#include "io/las/las.h"
#include "io/las/laz_model.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <string.h>

/* --- the table of chunks --- */

/* Reads the table of chunks: compressed integers, each predicted by the last one. */

typedef struct brio_laz_chunk {
    uint32_t points, bytes;
} brio_laz_chunk;

enum { HEAD = 8, POINTS = 0, BYTES = 1 /* contexts */, MOST_ENTRY = 16 /* bytes of an entry, at most; chosen */ };

/* Finds the table of a file whose writer could not go back to say where it is: the last 8 bytes say it. */
static brio_status find_table(brio_stream *s, uint64_t *at) {
    char bytes[8];
    uint64_t here = brio_stream_offset(s);
    if (*at <= here && s->size >= here + sizeof bytes) {
        BRIO_FORWARD(brio_stream_peek(s, s->size - sizeof bytes, bytes, sizeof bytes));
        *at = brio_le64(bytes);
    }
    if (*at <= here || *at + HEAD > s->size || *at > s->size) *at = 0;
    return BRIO_OK;
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
    uint64_t bytes = 0, points = 0, room = at - brio_stream_offset(s);
    for (size_t i = 0; i < count; i++) {
        if (h->chunk != UINT32_MAX)
            chunks[i].points = h->num_points - points < h->chunk ? (uint32_t)(h->num_points - points) : h->chunk;
        BRIO_EXPECT(s->ctx, chunks[i].points / BRIO_LAZ_MOST_DENSE <= chunks[i].bytes, BRIO_ERR_FORMAT,
                    "%s: byte %" PRIu64 ": chunk %zu (counted from 0) cannot have %" PRIu32 " points in %" PRIu32
                    " bytes",
                    s->name, at, i, chunks[i].points, chunks[i].bytes);
        points += chunks[i].points;
        bytes += chunks[i].bytes;
    }
    BRIO_EXPECT(s->ctx, bytes <= room, BRIO_ERR_FORMAT,
                "%s: byte %" PRIu64 ": the table of chunks lists %" PRIu64 " bytes, there are %" PRIu64, s->name, at,
                bytes, room);
    BRIO_EXPECT(s->ctx, points == h->num_points, BRIO_ERR_FORMAT,
                "%s: byte %" PRIu64 ": the table of chunks lists %" PRIu64 " points, the header %" PRIu64, s->name, at,
                points, h->num_points);
    return BRIO_OK;
}

/* Reads the table of a regular file. The chunks lie one after the other from the stream's position on.
 *  at      the table's first byte, as the file says.
 *  chunks  receives a block of *count chunks, owned by the caller (brio_release), or NULL if the file has no table or
 *          cannot be read from its end: the caller then reads chunk after chunk.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT (the table does not fit the file), BRIO_ERR_NO_MEMORY. */
static brio_status laz_table_read(brio_stream *s, const brio_las_header *h, uint64_t at, brio_laz_chunk **chunks,
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

/* --- chunks --- */

/* All chosen. BLOCK: bytes of the records that are decoded before they are stored. BATCH: bytes of chunks that are read
 * together, at most, if these are more than one. DENSE: a point that takes less than 1/DENSE byte makes no promise that
 * memory is made for. MOST_IN_PIPE: points of a chunk whose end is not known. */
enum { BLOCK = 1 << 15, BATCH = 1 << 26, CHUNKS_A_THREAD = 2, WINDOW = 1 << 20, DENSE = 64, MOST_IN_PIPE = 1 << 24 };

/* A thread's decoder. */
typedef struct {
    brio_laz_decoder *decoder;
    uint8_t *rows;
} worker;

/* A chunk that is in memory. */
typedef struct {
    const uint8_t *bytes;
    size_t size;
    size_t first, points;  /* its points in the block of the mesh */
    bool damaged, missing; /* missing: the file ends within the chunk, of which nothing can be decoded */
    size_t at;             /* damaged: the first of the points decoded together that is */
    uint64_t row;          /* its first point in the file */
} loaded_chunk;

typedef struct {
    brio_stream *stream;
    brio_builder *builder;
    const brio_las_header *header;
    const brio_las_plan *plan;
    int threads;
    worker *workers;
    loaded_chunk *batch;
    size_t num_batch;
} laz_reader;

/* --- workers --- */

static size_t block_rows(const brio_las_header *h) {
    return BLOCK / h->record + 1;
}

static brio_status make_workers(laz_reader *r, size_t chunks) {
    brio_context *ctx = r->stream->ctx;
    const brio_las_header *h = r->header;
    r->threads = brio_threads(ctx, chunks, 1);
    size_t count = (size_t)r->threads, bytes = brio_laz_decoder_bytes(&h->form);
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, r->workers, count));
    BRIO_FORWARD(BRIO_ALLOC(ctx, r->batch, CHUNKS_A_THREAD * count));
    for (size_t i = 0; i < count; i++) {
        char *memory;
        BRIO_FORWARD(BRIO_ALLOC(ctx, memory, bytes));
        r->workers[i].decoder = brio_laz_decoder_make(memory, &h->form);
        BRIO_FORWARD(BRIO_ALLOC(ctx, r->workers[i].rows, block_rows(h) * h->record));
    }
    return BRIO_OK;
}

static void free_workers(laz_reader *r) {
    for (int i = 0; i < r->threads && r->workers; i++) {
        brio_release(r->stream->ctx, r->workers[i].decoder);
        brio_release(r->stream->ctx, r->workers[i].rows);
    }
    brio_release(r->stream->ctx, r->workers);
    brio_release(r->stream->ctx, r->batch);
}

/* Decodes a chunk and stores its points. */
static void decode_chunk(const laz_reader *r, const worker *w, loaded_chunk *c) {
    size_t most = block_rows(r->header);
    c->at = 0;
    /* some encoders end with a chunk of no points */
    c->damaged = c->points && !brio_laz_begin(w->decoder, c->bytes, c->size);
    while (!c->damaged && c->at < c->points) {
        size_t rows = c->points - c->at < most ? c->points - c->at : most;
        c->damaged = !brio_laz_next(w->decoder, w->rows, rows);
        if (c->damaged) return;
        brio_las_store(r->plan, r->builder->mesh, (char *)w->rows, c->first + c->at, rows);
        c->at += rows;
    }
}

/* Decodes the points of a chunk that is cut off, one by one, and keeps those that are whole. */
static void salvage_chunk(laz_reader *r, loaded_chunk *c) {
    const worker *w = r->workers;
    bool whole = brio_laz_begin(w->decoder, c->bytes, c->size);
    for (c->at = 0; whole && c->at < c->points; c->at += whole) {
        whole = brio_laz_next(w->decoder, w->rows, 1);
        if (whole) brio_las_store(r->plan, r->builder->mesh, (char *)w->rows, c->first + c->at, 1);
    }
    r->builder->mesh->num_vertices = c->first + c->at;
    r->stream->row += c->at;
}

static brio_status damaged(const laz_reader *r, const loaded_chunk *c, uint64_t offset) {
    return brio_fail(r->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: the compressed chunk at byte %" PRIu64
                     " is damaged or cut off: at point %zu (counted from 0) "
                     "of the file or soon behind it",
                     r->stream->name, offset, (size_t)c->row + c->at);
}

/* --- with a table --- */

static void decode_part(void *user, size_t begin, size_t end, int thread) {
    const laz_reader *r = user;
    for (size_t i = begin; i < end; i++) decode_chunk(r, &r->workers[thread], &r->batch[i]);
}

/* Reads and decodes as many of the chunks as fit in a batch, and returns their number in *used. */
static brio_status read_batch(laz_reader *r, const brio_laz_chunk *chunks, size_t count, size_t *used) {
    brio_stream *s = r->stream;
    size_t bytes = 0, points = 0, n = 0, most = r->threads > 1 ? CHUNKS_A_THREAD * (size_t)r->threads : 1;
    uint64_t offset = brio_stream_offset(s);
    const char *data = NULL;
    for (; n < count && n < most && (n == 0 || bytes + chunks[n].bytes <= BATCH); n++) {
        if (n && r->builder->streams && points + chunks[n].points > BRIO_BLOCK_ROWS * (size_t)r->threads) break;
        r->batch[n] = (loaded_chunk){
            .size = chunks[n].bytes, .first = points, .points = chunks[n].points, .row = s->row + points};
        bytes += chunks[n].bytes;
        points += chunks[n].points;
    }
    BRIO_FORWARD(brio_stream_take(s, bytes, &data));
    BRIO_FORWARD(brio_builder_add_vertices(r->builder, points));
    size_t base = r->builder->mesh->num_vertices - points;
    for (size_t i = 0; i < n; data += r->batch[i++].size) {
        r->batch[i].bytes = (const uint8_t *)data;
        r->batch[i].first += base;
    }
    BRIO_FORWARD(brio_for_chunks(s->ctx, r->threads, n, 1, decode_part, r));
    for (size_t i = 0; i < n; offset += r->batch[i++].size)
        if (r->batch[i].damaged) return damaged(r, &r->batch[i], offset);
    s->row += points;
    *used = n;
    return BRIO_OK;
}

static brio_status read_with_table(laz_reader *r, const brio_laz_chunk *chunks, size_t count) {
    brio_stream *s = r->stream;
    BRIO_FORWARD(make_workers(r, count));
    if (r->header->num_points / DENSE <= s->size)
        BRIO_FORWARD(brio_builder_expect_vertices(r->builder, r->header->num_points));
    for (size_t i = 0, used = 0; i < count; i += used) BRIO_FORWARD(read_batch(r, chunks + i, count - i, &used));
    return BRIO_OK;
}

/* --- one chunk after the other --- */

/* Reads until the buffer has `need` bytes or the file ends. The buffer never grows to more than twice what it has. */
static brio_status gather(brio_stream *s, uint64_t need) {
    while (brio_stream_left(s) < need && !s->ended) {
        uint64_t step = 2 * (uint64_t)brio_stream_left(s);
        if (step < WINDOW) step = WINDOW;
        BRIO_FORWARD(brio_stream_fill(s, (size_t)(step < need ? step : need)));
    }
    return BRIO_OK;
}

/* Refuses a chunk of more points than its bytes can stand for, before memory is made for them.
 *  bytes  at most as many as the chunk has; BRIO_SIZE_UNKNOWN in a pipe. */
static brio_status check_points(const laz_reader *r, size_t points, uint64_t bytes) {
    brio_stream *s = r->stream;
    if (bytes == BRIO_SIZE_UNKNOWN ? points <= MOST_IN_PIPE : points / BRIO_LAZ_MOST_DENSE <= bytes) return BRIO_OK;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": a compressed chunk cannot have %zu points in its bytes, or in a pipe more "
                     "than %d",
                     s->name, brio_stream_offset(s), points, (int)MOST_IN_PIPE);
}

/* Decodes the chunk of layers that follows. It says how many bytes it has. */
static brio_status next_layers(laz_reader *r, loaded_chunk *c) {
    brio_stream *s = r->stream;
    const brio_laz_form *form = &r->header->form;
    uint32_t points = 0;
    BRIO_FORWARD(gather(s, brio_laz_layers_head(form)));
    uint64_t size = brio_laz_layers_bytes(form, (uint8_t *)s->buffer + s->begin, brio_stream_left(s), &points);
    c->missing = !size;
    if (c->missing) return r->builder->salvage ? BRIO_OK : brio_stream_truncated(s);
    bool fits = r->header->chunk == UINT32_MAX ? points && points <= c->points : points == c->points;
    BRIO_EXPECT(s->ctx, fits, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": a chunk of %" PRIu32 " points, expected %s%zu",
                s->name, brio_stream_offset(s), points, r->header->chunk == UINT32_MAX ? "1 to " : "", c->points);
    c->points = points;
    BRIO_FORWARD(gather(s, size));
    c->missing = brio_stream_left(s) < size;
    if (c->missing) return r->builder->salvage ? BRIO_OK : brio_stream_truncated(s);
    BRIO_FORWARD(check_points(r, points, size));
    BRIO_FORWARD(brio_builder_add_vertices(r->builder, c->points));
    c->first = r->builder->mesh->num_vertices - c->points;
    c->bytes = (uint8_t *)s->buffer + s->begin;
    c->size = (size_t)size;
    decode_chunk(r, r->workers, c);
    return BRIO_OK;
}

/* Decodes the chunk that follows, whose end only its decoder finds. */
static brio_status next_stream(laz_reader *r, loaded_chunk *c) {
    brio_stream *s = r->stream;
    BRIO_FORWARD(check_points(r, c->points, s->size == BRIO_SIZE_UNKNOWN ? s->size : s->size - brio_stream_offset(s)));
    BRIO_FORWARD(brio_builder_add_vertices(r->builder, c->points));
    c->first = r->builder->mesh->num_vertices - c->points;
    for (uint64_t window = WINDOW;; window *= 2) {
        BRIO_FORWARD(gather(s, window));
        c->bytes = (uint8_t *)s->buffer + s->begin;
        c->size = brio_stream_left(s);
        decode_chunk(r, r->workers, c);
        if (!c->damaged || s->ended) break;
    }
    if (!c->damaged) c->size = brio_laz_used(r->workers->decoder);
    return BRIO_OK;
}

static brio_status read_without_table(laz_reader *r) {
    brio_stream *s = r->stream;
    const brio_las_header *h = r->header;
    bool fixed = h->chunked && h->chunk != UINT32_MAX;
    BRIO_EXPECT(s->ctx, fixed || !h->chunked || h->form.layered, BRIO_ERR_FORMAT,
                "%s: chunks of different numbers of points need their table, which is missing or, in a pipe, not "
                "there yet",
                s->name);
    BRIO_FORWARD(make_workers(r, 1));
    while (s->row < h->num_points) {
        loaded_chunk c = {.row = s->row, .points = (size_t)(h->num_points - s->row)};
        if (fixed && c.points > h->chunk) c.points = h->chunk;
        BRIO_FORWARD(h->form.layered ? next_layers(r, &c) : next_stream(r, &c));
        if (c.damaged && r->builder->salvage && s->ended) salvage_chunk(r, &c);
        if (c.missing || (c.damaged && r->builder->salvage && s->ended)) break;
        if (c.damaged) return damaged(r, &c, brio_stream_offset(s));
        s->begin += c.size;
        s->row += c.points;
    }
    return BRIO_OK;
}

brio_status brio_laz_read(brio_stream *s, brio_builder *b, const brio_las_header *h, const brio_las_plan *plan) {
    brio_status status = BRIO_OK;
    laz_reader r = {.stream = s, .builder = b, .header = h, .plan = plan};
    brio_laz_chunk *chunks = NULL;
    size_t count = 0;
    const char *bytes = NULL;
    if (h->chunked && h->num_points) {
        BRIO_TRY(brio_stream_take(s, 8, &bytes));
        status = laz_table_read(s, h, brio_le64(bytes), &chunks, &count);
        if (status != BRIO_ERR_FORMAT || !b->salvage)
            BRIO_TRY(status); /* a file that ends early may do so in its table */
    }
    BRIO_TRY(chunks ? read_with_table(&r, chunks, count) : read_without_table(&r));
    b->missing = h->num_points - s->row;
done:
    free_workers(&r);
    brio_release(s->ctx, chunks);
    return status;
}
