/* Decodes a chunk of a LAZ file.
 *
 * A chunk begins with its first record as it is. In formats 0 to 5 one stream of bytes follows, in which the items of
 * the records alternate. In formats 6 to 10 the number of points follows, the sizes of the layers, and the layers. */
#include "io/las/las.h"
#include "io/las/laz_items.h"
#include "io/las/laz_decoder.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <string.h>

/* --- LASzip's record --- */

/* LASzip's record, without which compressed points cannot be read: how they are compressed.
 *
 * Based on: Isenburg. LASzip. 2013. */

typedef struct {
    uint16_t type, size, version;
} laz_item;

/* The items that LASzip's record lists. */
enum { HEAD = 34, ITEM = 6 }; /* bytes of the record before its items, and of an item */
enum { ITEM_BYTES = 0, POINT10 = 6, TIME11, RGB12, WAVE13, POINT14, RGB14, RGBNIR14, WAVE14, BYTES14, MOST_ITEMS = 5 };

/* Lists the items of a format; returns their number. */
static size_t items_of(unsigned format, size_t record, laz_item *items) {
    static const uint8_t types[BRIO_LAS_FORMATS][3] = {
        {POINT10},        {POINT10, TIME11},   {POINT10, RGB12},  {POINT10, TIME11, RGB12},   {0}, {0}, {POINT14},
        {POINT14, RGB14}, {POINT14, RGBNIR14}, {POINT14, WAVE14}, {POINT14, RGBNIR14, WAVE14}};
    static const uint8_t sizes[] = {
        [POINT10] = 20, [TIME11] = 8, [RGB12] = 6, [POINT14] = 30, [RGB14] = 6, [RGBNIR14] = 8, [WAVE14] = 29};
    size_t count = 0;
    for (int i = 0; i < 3 && types[format][i]; i++) {
        uint16_t type = types[format][i];
        items[count++] = (laz_item){type, sizes[type], 0};
    }
    size_t extra = record - brio_las_record_bytes(format);
    if (count && extra) items[count++] = (laz_item){format < 6 ? ITEM_BYTES : BYTES14, (uint16_t)extra, 0};
    return count;
}

brio_laz_form brio_laz_form_of(unsigned format, size_t record) {
    return (brio_laz_form){.format = format,
                           .record = record,
                           .num_extra = record - brio_las_record_bytes(format),
                           .layered = format >= 6};
}

/* --- reading --- */

static brio_status check_items(brio_stream *s, brio_las_header *h, const char *bytes, size_t count) {
    laz_item items[MOST_ITEMS];
    size_t expected = items_of(h->format, h->record, items);
    bool layered = h->format >= 6, own_colours = false;
    BRIO_EXPECT(s->ctx, expected, BRIO_ERR_FORMAT, "%s: compressed points of format %u: waveforms are not read",
                s->name, h->format);
    BRIO_EXPECT(s->ctx, count == expected, BRIO_ERR_FORMAT,
                "%s: LASzip's record lists %zu items, point format %u has %zu", s->name, count, h->format, expected);
    for (size_t i = 0; i < count; i++, bytes += ITEM) {
        unsigned type = brio_le16(bytes), size = brio_le16(bytes + 2), version = brio_le16(bytes + 4);
        BRIO_EXPECT(s->ctx, type == items[i].type && size == items[i].size, BRIO_ERR_FORMAT,
                    "%s: LASzip's record: item %zu has type %u and %u bytes, expected type %u and %u bytes", s->name, i,
                    type, size, items[i].type, items[i].size);
        BRIO_EXPECT(s->ctx, version != 1, BRIO_ERR_FORMAT,
                    "%s: compressed by LASzip 1, whose form of points is not read: decompress the file with LASzip or "
                    "LAStools first",
                    s->name);
        BRIO_EXPECT(s->ctx, layered ? version == 3 || version == 4 : version == 2, BRIO_ERR_FORMAT,
                    "%s: LASzip's record: item %zu has version %u, expected %s", s->name, i, version,
                    layered ? "3 or 4" : "2");
        own_colours = version == 4;
    }
    h->form = brio_laz_form_of(h->format, h->record);
    h->form.own_colours = own_colours;
    return BRIO_OK;
}

brio_status brio_laz_form_read(brio_stream *s, brio_las_header *h, const char *bytes, size_t size) {
    BRIO_EXPECT(s->ctx, size >= HEAD, BRIO_ERR_FORMAT, "%s: LASzip's record has %zu bytes, expected %d or more",
                s->name, size, (int)HEAD);
    unsigned compressor = brio_le16(bytes), coder = brio_le16(bytes + 2);
    size_t count = brio_le16(bytes + 32);
    BRIO_EXPECT(s->ctx,
                coder == 0 && compressor == (h->format >= 6    ? 3
                                             : compressor == 1 ? 1
                                                               : 2),
                BRIO_ERR_FORMAT, "%s: LASzip's record: compressor %u with coder %u for point format %u is not known",
                s->name, compressor, coder, h->format);
    BRIO_EXPECT(s->ctx, size >= HEAD + ITEM * count, BRIO_ERR_FORMAT,
                "%s: LASzip's record has %zu bytes, %zu items need %zu", s->name, size, count, HEAD + ITEM * count);
    h->chunked = compressor != 1;
    h->chunk = brio_le32(bytes + 12);
    if (!h->chunk) h->chunk = UINT32_MAX; /* so LAStools writes COPC */
    return check_items(s, h, bytes + HEAD, count);
}

/* --- writing --- */

size_t brio_laz_form_write(const brio_laz_form *form, uint32_t chunk, char record[BRIO_LAZ_FORM]) {
    laz_item items[MOST_ITEMS];
    size_t count = items_of(form->format, form->record, items);
    memset(record, 0, BRIO_LAZ_FORM);
    brio_put_le16(record, form->layered ? 3 : 2);
    record[4] = 2; /* the version of LASzip that wrote first what this is: 2.2, and 3.0 for layers */
    record[5] = 2;
    if (form->layered) record[4] = 3, record[5] = 0;
    brio_put_le32(record + 12, chunk);
    brio_put_le64(record + 16, UINT64_MAX); /* no records of other programs, as LASzip writes it */
    brio_put_le64(record + 24, UINT64_MAX);
    brio_put_le16(record + 32, (uint16_t)count);
    for (size_t i = 0; i < count; i++) {
        char *item = record + HEAD + ITEM * i;
        brio_put_le16(item, items[i].type);
        brio_put_le16(item + 2, items[i].size);
        brio_put_le16(item + 4, form->layered ? 3 : 2);
    }
    return HEAD + ITEM * count;
}

/* --- the state of a chunk --- */

/* The models of a chunk of compressed records, see laz_items.h.
 *
 * Layers of version 3 keep two mistakes of the first encoder. Colours and extra bytes of a point are those of channel 0
 * unless the channel changes at that point. Where it changes to a channel that was used before, the last colours and
 * extra bytes are those of the channel that was left, with the models of the new one. */

static size_t arena_bytes(const brio_laz_form *form) {
    size_t byte = brio_laz_model_bytes(256), items = brio_laz_integer_bytes(32), colours = 10 * byte;
    size_t time = 2 * brio_laz_model_bytes(520) + items;
    if (!form->layered) return 771 * byte + 5 * items + time + colours + form->num_extra * byte;
    size_t channel = 128 * byte + 64 * brio_laz_model_bytes(64) + 8 * brio_laz_model_bytes(128) +
                     34 * brio_laz_model_bytes(16) + 6 * items + time + colours + form->num_extra * byte;
    return BRIO_LAZ_CHANNELS * channel;
}

static size_t channels_of(const brio_laz_form *form) {
    return form->layered ? BRIO_LAZ_CHANNELS : 1;
}

size_t brio_laz_state_bytes(const brio_laz_form *form) {
    return form->num_extra * channels_of(form) * (sizeof(brio_laz_model) + 1) + 64 + arena_bytes(form);
}

void brio_laz_state_make(brio_laz_chunk_state *s, void *memory, const brio_laz_form *form) {
    size_t models = channels_of(form) * form->num_extra;
    memset(s, 0, sizeof *s); /* a compound literal of its size could be made on the stack first */
    s->form = *form;
    s->extra_models = memory;
    s->extra_last = (uint8_t *)(s->extra_models + models);
    uintptr_t end = (uintptr_t)(s->extra_last + models);
    s->arena.memory = (char *)s->extra_last + models + (-end & 15);
    s->arena.size = arena_bytes(form);
}

void brio_laz_state_begin(brio_laz_chunk_state *s, const uint8_t *record) {
    const brio_laz_form *form = &s->form;
    size_t models = channels_of(form) * form->num_extra;
    memset(&s->items, 0, sizeof s->items);
    if (form->layered) {
        memset(&s->point14, 0, sizeof s->point14);
        brio_laz_point14_begin(&s->point14, record);
    } else {
        memset(&s->point10, 0, sizeof s->point10);
        memset(&s->time, 0, sizeof s->time);
        brio_laz_point10_begin(&s->point10, record);
        if (brio_laz_has_time(form)) brio_laz_time_begin(&s->time, brio_le64(record + BRIO_LAZ_POINT10));
    }
    if (models) memset(s->extra_models, 0, models * sizeof *s->extra_models);
    s->arena.used = 0;
    s->channel = form->layered ? s->point14.channel : 0;
    brio_laz_channel_items *items = &s->items[s->channel];
    items->used = true;
    for (size_t i = 0; i < 3 && brio_laz_has_colour(form); i++)
        items->colour[i] = brio_le16(record + brio_laz_colour_at(form) + 2 * i);
    if (brio_laz_has_infrared(form)) items->colour[3] = brio_le16(record + brio_laz_colour_at(form) + 6);
    if (form->num_extra)
        memcpy(s->extra_last + s->channel * form->num_extra, record + form->record - form->num_extra, form->num_extra);
}

uint32_t brio_laz_switch_items(brio_laz_chunk_state *s, uint32_t channel) {
    uint32_t old = s->channel;
    size_t n = s->form.num_extra;
    brio_laz_channel_items *items = &s->items[channel];
    s->channel = channel;
    if (channel == old) return old;
    if (items->used) return s->form.own_colours ? channel : old;
    items->used = true;
    memcpy(items->colour, s->items[old].colour, sizeof items->colour);
    if (n) memcpy(s->extra_last + channel * n, s->extra_last + old * n, n);
    return channel;
}

/* --- decoding --- */

struct brio_laz_decoder {
    brio_laz_chunk_state state;
    const uint8_t *bytes;
    bool first;                                   /* whether the next record is the first one of its chunk */
    brio_laz_coder coders[BRIO_LAZ_FIXED_LAYERS]; /* without layers: one */
    brio_laz_coder *extra_coders;
};

size_t brio_laz_decoder_bytes(const brio_laz_form *form) {
    return sizeof(brio_laz_decoder) + form->num_extra * sizeof(brio_laz_coder) + brio_laz_state_bytes(form);
}

brio_laz_decoder *brio_laz_decoder_make(void *memory, const brio_laz_form *form) {
    brio_laz_decoder *d = memory;
    memset(d->coders, 0, sizeof d->coders);
    d->bytes = NULL;
    d->first = false;
    d->extra_coders = (brio_laz_coder *)(void *)(d + 1);
    brio_laz_state_make(&d->state, d->extra_coders + form->num_extra, form);
    return d;
}

/* --- the beginning of a chunk --- */

size_t brio_laz_layers_head(const brio_laz_form *form) {
    return form->record + 4 + 4 * brio_laz_num_layers(form);
}

uint64_t brio_laz_layers_bytes(const brio_laz_form *form, const uint8_t *bytes, size_t size, uint32_t *points) {
    uint64_t sum = brio_laz_layers_head(form);
    if (size < sum) return 0;
    *points = brio_le32(bytes + form->record);
    for (size_t i = 0; i < brio_laz_num_layers(form); i++) sum += brio_le32(bytes + form->record + 4 + 4 * i);
    return sum;
}

/* Begins a layer at *at and moves *at behind it. */
static void begin_layer(brio_laz_coder *c, const uint8_t *size, const uint8_t **at) {
    uint32_t bytes = brio_le32(size);
    *c = (brio_laz_coder){0};
    if (bytes) brio_laz_coder_begin(c, *at, *at + bytes);
    *at += bytes;
}

static void begin_layers(brio_laz_decoder *d) {
    const brio_laz_form *form = &d->state.form;
    const uint8_t *size = d->bytes + form->record + 4, *at = d->bytes + brio_laz_layers_head(form);
    int used = BRIO_LAZ_POINT14_LAYERS + brio_laz_has_colour(form) + brio_laz_has_infrared(form);
    for (int i = 0; i < used; i++, size += 4) begin_layer(&d->coders[i], size, &at);
    if (brio_laz_has_wave(form)) {
        at += brio_le32(size);
        size += 4;
    }
    for (size_t i = 0; i < form->num_extra; i++, size += 4) begin_layer(&d->extra_coders[i], size, &at);
}

bool brio_laz_begin(brio_laz_decoder *d, const uint8_t *bytes, size_t size) {
    const brio_laz_form *form = &d->state.form;
    uint32_t points;
    uint64_t need = form->record + 4;
    if (form->layered) need = brio_laz_layers_bytes(form, bytes, size, &points);
    if (!need || size < need) return false;
    d->bytes = bytes;
    d->first = true;
    brio_laz_state_begin(&d->state, bytes);
    if (form->layered)
        begin_layers(d);
    else
        brio_laz_coder_begin(&d->coders[0], bytes + form->record, bytes + size);
    return true;
}

size_t brio_laz_used(const brio_laz_decoder *d) {
    return (size_t)(d->coders[0].at - d->bytes);
}

/* --- records --- */

static void put_colour(uint8_t *row, const uint16_t *colour, int count) {
    for (int i = 0; i < count; i++) brio_put_le16(row + 2 * i, colour[i]);
}

static void next_record(brio_laz_decoder *d, uint8_t *row) {
    brio_laz_coder *c = &d->coders[0];
    brio_laz_chunk_state *s = &d->state;
    const brio_laz_form *form = &s->form;
    brio_laz_point10_next(&s->point10, c, &s->arena, row);
    if (brio_laz_has_time(form)) brio_put_le64(row + BRIO_LAZ_POINT10, brio_laz_time_next(&s->time, c, &s->arena, 1));
    if (brio_laz_has_colour(form)) {
        brio_laz_colour_next(&s->items[0].colours, c, &s->arena, s->items[0].colour);
        put_colour(row + brio_laz_colour_at(form), s->items[0].colour, 3);
    }
    uint8_t *extra = row + form->record - form->num_extra;
    for (size_t i = 0; i < form->num_extra; i++) {
        s->extra_last[i] = (uint8_t)(s->extra_last[i] + brio_laz_symbol(c, &s->arena, &s->extra_models[i], 256));
        extra[i] = s->extra_last[i];
    }
}

static void next_layered_record(brio_laz_decoder *d, uint8_t *row) {
    brio_laz_chunk_state *s = &d->state;
    const brio_laz_form *form = &s->form;
    size_t n = form->num_extra;
    brio_laz_coder *c = d->coders;
    bool switched = brio_laz_point14_next(&s->point14, c, &s->arena, row);
    uint32_t last = brio_laz_switch_items(s, switched || form->own_colours ? s->point14.channel : 0);
    brio_laz_channel_items *items = &s->items[s->channel];
    uint16_t *colour = s->items[last].colour;
    if (brio_laz_has_colour(form)) {
        if (c[BRIO_LAZ_COLOUR_LAYER].end)
            brio_laz_colour_next(&items->colours, &c[BRIO_LAZ_COLOUR_LAYER], &s->arena, colour);
        if (brio_laz_has_infrared(form) && c[BRIO_LAZ_INFRARED_LAYER].end)
            brio_laz_infrared_next(&items->infrared, &c[BRIO_LAZ_INFRARED_LAYER], &s->arena, &colour[3]);
        put_colour(row + brio_laz_colour_at(form), colour, brio_laz_has_infrared(form) ? 4 : 3);
    }
    uint8_t *bytes = s->extra_last + last * n;
    for (size_t i = 0; i < n; i++)
        if (d->extra_coders[i].end)
            bytes[i] = (uint8_t)(bytes[i] + brio_laz_symbol(&d->extra_coders[i], &s->arena,
                                                            &s->extra_models[s->channel * n + i], 256));
    if (n) memcpy(row + form->record - n, bytes, n);
}

static bool is_past(const brio_laz_decoder *d) {
    const brio_laz_form *form = &d->state.form;
    size_t coders = form->layered ? sizeof d->coders / sizeof *d->coders : 1;
    for (size_t i = 0; i < coders; i++)
        if (d->coders[i].past) return true;
    for (size_t i = 0; form->layered && i < form->num_extra; i++)
        if (d->extra_coders[i].past) return true;
    return false;
}

bool brio_laz_next(brio_laz_decoder *d, uint8_t *rows, size_t count) {
    const brio_laz_form *form = &d->state.form;
    size_t record = form->record;
    if (d->first && count) {
        memcpy(rows, d->bytes, record);
        rows += record;
        count--;
        d->first = false;
    }
    /* a layer without bytes has no coder: all others may be absent, this one only where no second record is */
    if (count && form->layered && !d->coders[BRIO_LAZ_RETURNS_XY].end) return false;
    for (; count; count--, rows += record) {
        if (form->layered)
            next_layered_record(d, rows);
        else
            next_record(d, rows);
    }
    return !is_past(d);
}
