/* Writes the chunks of a LAZ file and their table.
 *
 * Records are collected until there is a chunk for each thread; the threads encode their chunks side by side, and the
 * chunks are written in the order of the points. So the file does not depend on the number of threads.
 *
 * Based on: Isenburg. LASzip: lossless compression of LiDAR data. Photogrammetric Engineering and Remote Sensing 79,
 * 2013. */
#include "io/las/laz_write.h"
#include "base/memory.h"
#include "base/team.h"
#include "io/las/laz_items.h"
#include "io/little_endian.h"

/* --- one chunk --- */

/* Encodes a chunk of a LAZ file: the counterpart of laz_decoder.c, so that both change the same models in the same
 * way. */

enum { USUAL_POINTS = 50000 /* as in LASzip */, MOST_BYTES = 1 << 26 /* of a chunk's memory; chosen */ };

struct brio_laz_packer {
    brio_laz_chunk_state state;
    brio_laz_pen pens[BRIO_LAZ_FIXED_LAYERS]; /* without layers: one */
    brio_laz_pen *extra_pens;
    uint8_t *bytes; /* the chunk, and behind it the layers before they are put together */
};

/* --- memory --- */

/* Bytes of a point in layer i of the fixed ones, at most: symbols, then integers. A time is a symbol for each change of
 * the sequence, another one, an integer and 32 bits. */
static size_t layer_bytes(int i) {
    static const uint8_t symbols[BRIO_LAZ_FIXED_LAYERS] = {4, 0, 1, 1, 0, 0, 1, 0, 4, 7, 3};
    static const uint8_t integers[BRIO_LAZ_FIXED_LAYERS] = {2, 1, 0, 0, 1, 1, 0, 1, 2, 0, 0};
    return symbols[i] * (size_t)BRIO_LAZ_SYMBOL_BYTES + integers[i] * (size_t)BRIO_LAZ_INTEGER_BYTES;
}

/* Bytes of a point, at most, in all layers or in the one stream, which has the same items. */
static size_t point_bytes(const brio_laz_form *form) {
    size_t sum = form->num_extra * BRIO_LAZ_SYMBOL_BYTES;
    for (int i = 0; i < BRIO_LAZ_FIXED_LAYERS; i++) sum += layer_bytes(i);
    return sum;
}

uint32_t brio_laz_chunk_points(const brio_laz_form *form) {
    size_t most = MOST_BYTES / point_bytes(form);
    return most < USUAL_POINTS ? (uint32_t)(most ? most : 1) : USUAL_POINTS;
}

/* Bytes of a chunk, at most. */
static size_t chunk_bytes(const brio_laz_form *form) {
    size_t layers = BRIO_LAZ_FIXED_LAYERS + form->num_extra;
    return brio_laz_layers_head(form) + brio_laz_chunk_points(form) * point_bytes(form) + layers * BRIO_LAZ_END_BYTES;
}

size_t brio_laz_packer_bytes(const brio_laz_form *form) {
    return sizeof(brio_laz_packer) + form->num_extra * sizeof(brio_laz_pen) + brio_laz_state_bytes(form) +
           (form->layered ? 2 : 1) * chunk_bytes(form);
}

/* Makes a packer.   memory  brio_laz_packer_bytes(form) bytes, owned by the caller. */
static brio_laz_packer *laz_packer_make(void *memory, const brio_laz_form *form) {
    brio_laz_packer *p = memory;
    p->extra_pens = (brio_laz_pen *)(void *)(p + 1);
    char *models = (char *)(p->extra_pens + form->num_extra);
    brio_laz_state_make(&p->state, models, form);
    p->bytes = (uint8_t *)models + brio_laz_state_bytes(form);
    return p;
}

/* --- without layers --- */

static void get_colour(const uint8_t *row, uint16_t *colour, int count) {
    for (int i = 0; i < count; i++) colour[i] = brio_le16(row + 2 * i);
}

static void put_record(brio_laz_packer *p, const uint8_t *row) {
    brio_laz_chunk_state *s = &p->state;
    brio_laz_pen *pen = &p->pens[0];
    const brio_laz_form *form = &s->form;
    uint16_t colour[3];
    brio_laz_point10_put(&s->point10, pen, &s->arena, row);
    if (brio_laz_has_time(form)) brio_laz_time_put(&s->time, pen, &s->arena, 1, brio_le64(row + BRIO_LAZ_POINT10));
    if (brio_laz_has_colour(form)) {
        get_colour(row + brio_laz_colour_at(form), colour, 3);
        brio_laz_colour_put(&s->items[0].colours, pen, &s->arena, s->items[0].colour, colour);
    }
    const uint8_t *extra = row + form->record - form->num_extra;
    for (size_t i = 0; i < form->num_extra; i++) {
        uint8_t step = (uint8_t)(extra[i] - s->extra_last[i]);
        brio_laz_put_symbol(pen, &s->arena, &s->extra_models[i], 256, step);
        s->extra_last[i] = extra[i];
    }
}

static size_t pack_stream(brio_laz_packer *p, const uint8_t *rows, size_t count) {
    size_t record = p->state.form.record;
    memcpy(p->bytes, rows, record);
    brio_laz_pen_begin(&p->pens[0], p->bytes + record);
    for (size_t i = 1; i < count; i++) put_record(p, rows + i * record);
    return record + brio_laz_pen_end(&p->pens[0]);
}

/* --- layers --- */

static void put_layered_record(brio_laz_packer *p, const uint8_t *row) {
    brio_laz_chunk_state *s = &p->state;
    const brio_laz_form *form = &s->form;
    size_t n = form->num_extra;
    uint16_t colour[4];
    bool switched = brio_laz_point14_put(&s->point14, p->pens, &s->arena, row);
    uint32_t last = brio_laz_switch_items(s, switched ? s->point14.channel : 0);
    brio_laz_channel_items *items = &s->items[s->channel];
    if (brio_laz_has_colour(form)) {
        get_colour(row + brio_laz_colour_at(form), colour, brio_laz_has_infrared(form) ? 4 : 3);
        brio_laz_colour_put(&items->colours, &p->pens[BRIO_LAZ_COLOUR_LAYER], &s->arena, s->items[last].colour, colour);
    }
    if (brio_laz_has_infrared(form))
        brio_laz_infrared_put(&items->infrared, &p->pens[BRIO_LAZ_INFRARED_LAYER], &s->arena, &s->items[last].colour[3],
                              colour[3]);
    const uint8_t *extra = row + form->record - n;
    uint8_t *bytes = s->extra_last + last * n;
    for (size_t i = 0; i < n; i++) {
        uint8_t step = (uint8_t)(extra[i] - bytes[i]);
        brio_laz_put_symbol(&p->extra_pens[i], &s->arena, &s->extra_models[s->channel * n + i], 256, step);
        p->extra_pens[i].differs |= step != 0;
        bytes[i] = extra[i];
    }
}

/* Puts a layer behind the others; one without changes has no bytes. */
static void add_layer(brio_laz_pen *pen, uint8_t **size, uint8_t **to) {
    size_t bytes = brio_laz_pen_end(pen);
    if (!pen->differs) bytes = 0;
    memcpy(*to, pen->begin, bytes);
    brio_put_le32(*size, (uint32_t)bytes);
    *size += 4;
    *to += bytes;
}

static size_t pack_layers(brio_laz_packer *p, const uint8_t *rows, size_t count) {
    const brio_laz_form *form = &p->state.form;
    size_t record = form->record;
    int fixed = BRIO_LAZ_POINT14_LAYERS + brio_laz_has_colour(form) + brio_laz_has_infrared(form);
    uint8_t *at = p->bytes + chunk_bytes(form), *size = p->bytes + record + 4;
    for (int i = 0; i < fixed; i++) {
        brio_laz_pen_begin(&p->pens[i], at);
        at += count * layer_bytes(i) + BRIO_LAZ_END_BYTES;
    }
    for (size_t i = 0; i < form->num_extra; i++) {
        brio_laz_pen_begin(&p->extra_pens[i], at);
        at += count * BRIO_LAZ_SYMBOL_BYTES + BRIO_LAZ_END_BYTES;
    }
    for (size_t i = 1; i < count; i++) put_layered_record(p, rows + i * record);
    p->pens[BRIO_LAZ_RETURNS_XY].differs = p->pens[BRIO_LAZ_Z].differs = true; /* LASzip always has these two */
    memcpy(p->bytes, rows, record);
    brio_put_le32(p->bytes + record, (uint32_t)count);
    uint8_t *to = p->bytes + brio_laz_layers_head(form);
    for (int i = 0; i < fixed; i++) add_layer(&p->pens[i], &size, &to);
    for (size_t i = 0; i < form->num_extra; i++) add_layer(&p->extra_pens[i], &size, &to);
    return (size_t)(to - p->bytes);
}

size_t brio_laz_pack(brio_laz_packer *p, const uint8_t *rows, size_t count, const uint8_t **bytes) {
    brio_laz_state_begin(&p->state, rows);
    *bytes = p->bytes;
    return p->state.form.layered ? pack_layers(p, rows, count) : pack_stream(p, rows, count);
}

/* --- all chunks --- */

enum { BYTES = 1 /* the context of the table's integers, as in laz_read.c */, MOST_ENTRY = 8 /* bytes */ };

typedef struct brio_laz_worker {
    brio_laz_packer *packer;
    const uint8_t *bytes; /* its chunk, compressed */
    size_t size;
} worker;

static uint64_t chunks_of(const brio_laz_writer *w) {
    return (w->num_rows + w->chunk - 1) / w->chunk;
}

/* Returns how many threads encode chunks: those whose chunks fit in a part of the memory. */
static int workers_for(brio_context *ctx, size_t bytes) {
    enum { SHARE = 4 /* chosen */ };
    size_t fit = brio_memory_limit(ctx) / SHARE / bytes;
    int threads = brio_threads(ctx, SIZE_MAX, 1);
    return fit < 1 ? 1 : fit < (size_t)threads ? (int)fit : threads;
}

brio_status brio_laz_write_begin(brio_laz_writer *w, brio_output *out, const brio_laz_form *form) {
    brio_context *ctx = out->ctx;
    char place[8];
    w->form = *form;
    w->chunk = brio_laz_chunk_points(form);
    size_t bytes = brio_laz_packer_bytes(form), rows = w->chunk * form->record;
    w->threads = workers_for(ctx, bytes + rows);
    size_t count = (size_t)w->threads;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, w->workers, count));
    BRIO_FORWARD(BRIO_ALLOC(ctx, w->rows, count * rows));
    for (size_t i = 0; i < count; i++) {
        char *memory;
        BRIO_FORWARD(BRIO_ALLOC(ctx, memory, bytes));
        w->workers[i].packer = laz_packer_make(memory, form);
    }
    w->place = brio_output_offset(out);
    brio_put_le64(place, UINT64_MAX);
    return brio_output_bytes(out, place, sizeof place);
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
    size_t n = (size_t)chunks_of(w);
    BRIO_FORWARD(BRIO_RESERVE(out->ctx, w->sizes, w->chunk_capacity, w->num_chunks + n));
    BRIO_FORWARD(brio_for_chunks(out->ctx, brio_threads(out->ctx, n, 1), n, 1, pack_part, w));
    for (size_t i = 0; i < n; i++) {
        BRIO_FORWARD(brio_output_bytes(out, w->workers[i].bytes, w->workers[i].size));
        w->sizes[w->num_chunks++] = (uint32_t)w->workers[i].size;
    }
    w->num_rows = 0;
    return BRIO_OK;
}

brio_status brio_laz_write_rows(brio_laz_writer *w, brio_output *out, const uint8_t *rows, size_t count) {
    size_t record = w->form.record, most = (size_t)w->threads * w->chunk;
    while (count) {
        size_t taken = most - w->num_rows < count ? most - w->num_rows : count;
        memcpy(w->rows + w->num_rows * record, rows, taken * record);
        w->num_rows += taken;
        rows += taken * record;
        count -= taken;
        if (w->num_rows == most) BRIO_FORWARD(flush(w, out));
    }
    return BRIO_OK;
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
    char place[8];
    if (w->num_rows) BRIO_FORWARD(flush(w, out));
    brio_put_le64(place, brio_output_offset(out));
    BRIO_FORWARD(write_table(w, out));
    if (brio_output_can_patch(out))
        BRIO_FORWARD(brio_output_patch(out, w->place, place, sizeof place));
    else
        BRIO_FORWARD(brio_output_bytes(out, place, sizeof place));
    return BRIO_OK;
}

void brio_laz_write_free(brio_laz_writer *w, brio_context *ctx) {
    for (int i = 0; i < w->threads && w->workers; i++) brio_release(ctx, w->workers[i].packer);
    brio_release(ctx, w->workers);
    brio_release(ctx, w->rows);
    brio_release(ctx, w->sizes);
    w->workers = NULL;
}
