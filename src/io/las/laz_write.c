/* Writes the chunks of a LAZ file and their table.
 *
 * Records are collected until there is a chunk for each thread; the threads encode their chunks side by side, and the chunks
 * are written in the order of the points. So the file does not depend on the number of threads.
 *
 * Based on: Isenburg. LASzip: lossless compression of LiDAR data. Photogrammetric Engineering and Remote Sensing 79,
 * 2013. */
#include "io/las/laz_write.h"
#include "base/memory.h"
#include "base/team.h"
#include "io/little_endian.h"

enum { BYTES = 1 /* the context of the table's integers, as in laz_table.c */, MOST_ENTRY = 8 /* bytes */ };

typedef struct brio_laz_worker {
    brio_laz_packer *packer;
    const uint8_t *bytes; /* its chunk, compressed */
    size_t size;
} worker;

static uint64_t chunks_of(const brio_laz_writer *w) {
    return (w->num_rows + w->chunk - 1) / w->chunk;
}

brio_status brio_laz_write_begin(brio_laz_writer *w, brio_output *out, const brio_laz_form *form) {
    brio_status status = BRIO_OK;
    brio_context *ctx = out->ctx;
    char place[8];
    w->form = *form;
    w->chunk = brio_laz_chunk_points(form);
    w->threads = brio_threads(ctx, SIZE_MAX, 1);
    size_t count = (size_t)w->threads, bytes = brio_laz_packer_bytes(form);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, w->workers, count));
    BRIO_TRY(BRIO_ALLOC(ctx, w->rows, count * w->chunk * form->record));
    for (size_t i = 0; i < count; i++) {
        char *memory;
        BRIO_TRY(BRIO_ALLOC(ctx, memory, bytes));
        w->workers[i].packer = brio_laz_packer_make(memory, form);
    }
    w->place = brio_output_offset(out);
    brio_put_le64(place, UINT64_MAX);
    BRIO_TRY(brio_output_bytes(out, place, sizeof place));
done:
    return status;
}

static void pack_part(void *user, size_t begin, size_t end, int thread) {
    const brio_laz_writer *w = user;
    (void)thread; /* chunk i has packer i */
    for (size_t i = begin; i < end; i++) {
        size_t first = i * w->chunk, count = w->num_rows - first < w->chunk ? w->num_rows - first : w->chunk;
        worker *k = &w->workers[i];
        k->size = brio_laz_pack(k->packer, w->rows + first * w->form.record, count, &k->bytes);
    }
}

/* Encodes and writes what was collected. */
static brio_status flush(brio_laz_writer *w, brio_output *out) {
    brio_status status = BRIO_OK;
    size_t n = (size_t)chunks_of(w);
    BRIO_TRY(BRIO_RESERVE(out->ctx, w->sizes, w->chunk_capacity, w->num_chunks + n));
    BRIO_TRY(brio_for_chunks(out->ctx, brio_threads(out->ctx, n, 1), n, 1, pack_part, w));
    for (size_t i = 0; i < n; i++) {
        BRIO_TRY(brio_output_bytes(out, w->workers[i].bytes, w->workers[i].size));
        w->sizes[w->num_chunks++] = (uint32_t)w->workers[i].size;
    }
    w->num_rows = 0;
done:
    return status;
}

brio_status brio_laz_write_rows(brio_laz_writer *w, brio_output *out, const uint8_t *rows, size_t count) {
    brio_status status = BRIO_OK;
    size_t record = w->form.record, most = (size_t)w->threads * w->chunk;
    while (count) {
        size_t taken = most - w->num_rows < count ? most - w->num_rows : count;
        memcpy(w->rows + w->num_rows * record, rows, taken * record);
        w->num_rows += taken;
        rows += taken * record;
        count -= taken;
        if (w->num_rows == most) BRIO_TRY(flush(w, out));
    }
done:
    return status;
}

/* Writes the table: compressed integers, each predicted by the last one. */
static brio_status write_table(const brio_laz_writer *w, brio_output *out) {
    brio_status status = BRIO_OK;
    brio_laz_arena arena = {.size = brio_laz_integer_bytes(32)};
    brio_laz_integer *integer = NULL;
    brio_laz_pen pen;
    uint8_t *bytes = NULL;
    char head[8] = {0};
    brio_put_le32(head + 4, (uint32_t)w->num_chunks);
    BRIO_TRY(brio_output_bytes(out, head, sizeof head));
    BRIO_TRY(BRIO_ALLOC(out->ctx, arena.memory, arena.size));
    BRIO_TRY(BRIO_ALLOC_ZERO(out->ctx, integer, 1));
    BRIO_TRY(BRIO_ALLOC(out->ctx, bytes, MOST_ENTRY * w->num_chunks + BRIO_LAZ_END_BYTES));
    brio_laz_pen_begin(&pen, bytes);
    for (size_t i = 0; i < w->num_chunks; i++)
        brio_laz_put_int32(&pen, &arena, integer, i ? (int32_t)w->sizes[i - 1] : 0, (int32_t)w->sizes[i], BYTES);
    BRIO_TRY(brio_output_bytes(out, bytes, brio_laz_pen_end(&pen)));
done:
    brio_release(out->ctx, bytes);
    brio_release(out->ctx, integer);
    brio_release(out->ctx, arena.memory);
    return status;
}

brio_status brio_laz_write_end(brio_laz_writer *w, brio_output *out) {
    brio_status status = BRIO_OK;
    char place[8];
    if (w->num_rows) BRIO_TRY(flush(w, out));
    brio_put_le64(place, brio_output_offset(out));
    BRIO_TRY(write_table(w, out));
    if (brio_output_can_patch(out))
        BRIO_TRY(brio_output_patch(out, w->place, place, sizeof place));
    else
        BRIO_TRY(brio_output_bytes(out, place, sizeof place));
done:
    return status;
}

void brio_laz_write_free(brio_laz_writer *w, brio_context *ctx) {
    for (int i = 0; i < w->threads && w->workers; i++) brio_release(ctx, w->workers[i].packer);
    brio_release(ctx, w->workers);
    brio_release(ctx, w->rows);
    brio_release(ctx, w->sizes);
    w->workers = NULL;
}
