/* Decodes a chunk of a LAZ file.
 *
 * A chunk begins with its first record as it is. In formats 0 to 5 one stream of bytes follows, in which the items of
 * the records alternate. In formats 6 to 10 the number of points follows, the sizes of the layers, and the layers.
 *
 * Layers of version 3 keep two mistakes of the first encoder. Colours and extra bytes of a point are those of channel 0
 * unless the channel changes at that point. Where it changes to a channel that was used before, the last colours and
 * extra bytes are those of the channel that was left, with the models of the new one. */
#include "io/las/laz_decoder.h"
#include "io/las/laz_items.h"
#include "io/little_endian.h"

enum { CHANNELS = 4 };

/* Colours and extra bytes of one channel. */
typedef struct {
    bool used;
    uint16_t colour[4]; /* red, green, blue, near infrared */
    brio_laz_colour_models colours;
    brio_laz_infrared_models infrared;
} channel_items;

struct brio_laz_decoder {
    brio_laz_form form;
    const uint8_t *bytes;
    bool first;                                         /* whether the next record is the first one of its chunk */
    brio_laz_coder coders[BRIO_LAZ_POINT14_LAYERS + 2]; /* without layers: one */
    brio_laz_coder *extra_coders;
    brio_laz_model *extra_models; /* num_extra for each channel */
    uint8_t *extra_last;          /* likewise */
    uint32_t channel;             /* whose colours and extra bytes are the current ones */
    channel_items items[CHANNELS];
    brio_laz_time time;
    union {
        brio_laz_point10 point10;
        brio_laz_point14 point14;
    };
    brio_laz_arena arena;
};

enum { COLOUR_LAYER = BRIO_LAZ_POINT14_LAYERS, INFRARED_LAYER };

/* --- what is in a record --- */

static bool has_time(const brio_laz_form *form) {
    return form->format == 1 || form->format == 3;
}
static bool has_colour(const brio_laz_form *form) {
    return form->format == 2 || form->format == 3 || form->format == 7 || form->format == 8 || form->format == 10;
}
static bool has_infrared(const brio_laz_form *form) {
    return form->format == 8 || form->format == 10;
}
static bool has_wave(const brio_laz_form *form) {
    return form->format == 9 || form->format == 10;
}
static size_t colour_at(const brio_laz_form *form) {
    return form->layered ? BRIO_LAZ_POINT14 : BRIO_LAZ_POINT10 + (has_time(form) ? 8 : 0);
}
static size_t num_layers(const brio_laz_form *form) {
    return BRIO_LAZ_POINT14_LAYERS + (size_t)has_colour(form) + (size_t)has_infrared(form) + (size_t)has_wave(form) +
           form->num_extra;
}

/* --- memory --- */

static size_t arena_bytes(const brio_laz_form *form) {
    size_t byte = brio_laz_model_bytes(256), items = brio_laz_integer_bytes(32), colours = 10 * byte;
    size_t time = 2 * brio_laz_model_bytes(520) + items;
    if (!form->layered) return 771 * byte + 5 * items + time + colours + form->num_extra * byte;
    size_t channel = 128 * byte + 64 * brio_laz_model_bytes(64) + 8 * brio_laz_model_bytes(128) +
                     34 * brio_laz_model_bytes(16) + 6 * items + time + colours + form->num_extra * byte;
    return CHANNELS * channel;
}

static size_t channels_of(const brio_laz_form *form) {
    return form->layered ? CHANNELS : 1;
}

size_t brio_laz_decoder_bytes(const brio_laz_form *form) {
    size_t extra = form->num_extra * (sizeof(brio_laz_coder) + channels_of(form) * (sizeof(brio_laz_model) + 1));
    return sizeof(brio_laz_decoder) + extra + 64 + arena_bytes(form);
}

brio_laz_decoder *brio_laz_decoder_make(void *memory, const brio_laz_form *form) {
    brio_laz_decoder *d = memory;
    size_t channels = channels_of(form);
    memset(d, 0, sizeof *d); /* a compound literal of its size could be made on the stack first */
    d->form = *form;
    d->extra_coders = (brio_laz_coder *)(void *)(d + 1);
    d->extra_models = (brio_laz_model *)(void *)(d->extra_coders + form->num_extra);
    d->extra_last = (uint8_t *)(d->extra_models + channels * form->num_extra);
    uintptr_t end = (uintptr_t)(d->extra_last + channels * form->num_extra);
    d->arena.memory = (char *)d->extra_last + channels * form->num_extra + (-end & 15);
    d->arena.size = arena_bytes(form);
    return d;
}

/* --- the beginning of a chunk --- */

size_t brio_laz_layers_head(const brio_laz_form *form) {
    return form->record + 4 + 4 * num_layers(form);
}

uint64_t brio_laz_layers_bytes(const brio_laz_form *form, const uint8_t *bytes, size_t size, uint32_t *points) {
    uint64_t sum = brio_laz_layers_head(form);
    if (size < sum) return 0;
    *points = brio_le32(bytes + form->record);
    for (size_t i = 0; i < num_layers(form); i++) sum += brio_le32(bytes + form->record + 4 + 4 * i);
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
    const uint8_t *size = d->bytes + d->form.record + 4, *at = d->bytes + brio_laz_layers_head(&d->form);
    int used = BRIO_LAZ_POINT14_LAYERS + has_colour(&d->form) + has_infrared(&d->form);
    for (int i = 0; i < used; i++, size += 4) begin_layer(&d->coders[i], size, &at);
    if (has_wave(&d->form)) {
        at += brio_le32(size);
        size += 4;
    }
    for (size_t i = 0; i < d->form.num_extra; i++, size += 4) begin_layer(&d->extra_coders[i], size, &at);
}

static void begin_items(brio_laz_decoder *d) {
    const brio_laz_form *form = &d->form;
    size_t models = channels_of(form) * form->num_extra;
    memset(&d->items, 0, sizeof d->items);
    if (form->layered) {
        memset(&d->point14, 0, sizeof d->point14);
        brio_laz_point14_begin(&d->point14, d->bytes);
    } else {
        memset(&d->point10, 0, sizeof d->point10);
        memset(&d->time, 0, sizeof d->time);
        brio_laz_point10_begin(&d->point10, d->bytes);
        if (has_time(form)) brio_laz_time_begin(&d->time, brio_le64(d->bytes + BRIO_LAZ_POINT10));
    }
    if (models) memset(d->extra_models, 0, models * sizeof *d->extra_models);
    d->arena.used = 0;
    d->channel = form->layered ? d->point14.channel : 0;
    channel_items *items = &d->items[d->channel];
    items->used = true;
    for (size_t i = 0; i < 3 && has_colour(form); i++) items->colour[i] = brio_le16(d->bytes + colour_at(form) + 2 * i);
    if (has_infrared(form)) items->colour[3] = brio_le16(d->bytes + colour_at(form) + 6);
    if (form->num_extra)
        memcpy(d->extra_last + d->channel * form->num_extra, d->bytes + form->record - form->num_extra,
               form->num_extra);
}

bool brio_laz_begin(brio_laz_decoder *d, const uint8_t *bytes, size_t size) {
    uint32_t points;
    uint64_t need = d->form.record + 4;
    if (d->form.layered) need = brio_laz_layers_bytes(&d->form, bytes, size, &points);
    if (!need || size < need) return false;
    d->bytes = bytes;
    d->first = true;
    begin_items(d);
    if (d->form.layered)
        begin_layers(d);
    else
        brio_laz_coder_begin(&d->coders[0], bytes + d->form.record, bytes + size);
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
    const brio_laz_form *form = &d->form;
    brio_laz_point10_next(&d->point10, c, &d->arena, row);
    if (has_time(form)) brio_put_le64(row + BRIO_LAZ_POINT10, brio_laz_time_next(&d->time, c, &d->arena, 1));
    if (has_colour(form)) {
        brio_laz_colour_next(&d->items[0].colours, c, &d->arena, d->items[0].colour);
        put_colour(row + colour_at(form), d->items[0].colour, 3);
    }
    uint8_t *extra = row + form->record - form->num_extra;
    for (size_t i = 0; i < form->num_extra; i++) {
        d->extra_last[i] = (uint8_t)(d->extra_last[i] + brio_laz_symbol(c, &d->arena, &d->extra_models[i], 256));
        extra[i] = d->extra_last[i];
    }
}

/* Returns the channel whose last colour and extra bytes are the current ones. */
static uint32_t switch_items(brio_laz_decoder *d, uint32_t channel) {
    uint32_t old = d->channel;
    size_t n = d->form.num_extra;
    channel_items *items = &d->items[channel];
    d->channel = channel;
    if (channel == old) return old;
    if (items->used) return d->form.own_colours ? channel : old;
    items->used = true;
    memcpy(items->colour, d->items[old].colour, sizeof items->colour);
    if (n) memcpy(d->extra_last + channel * n, d->extra_last + old * n, n);
    return channel;
}

static void next_layered_record(brio_laz_decoder *d, uint8_t *row) {
    const brio_laz_form *form = &d->form;
    size_t n = form->num_extra;
    bool switched = brio_laz_point14_next(&d->point14, d->coders, &d->arena, row);
    uint32_t last = switch_items(d, switched || form->own_colours ? d->point14.channel : 0);
    channel_items *items = &d->items[d->channel];
    uint16_t *colour = d->items[last].colour;
    if (has_colour(form)) {
        if (d->coders[COLOUR_LAYER].end)
            brio_laz_colour_next(&items->colours, &d->coders[COLOUR_LAYER], &d->arena, colour);
        if (has_infrared(form) && d->coders[INFRARED_LAYER].end)
            brio_laz_infrared_next(&items->infrared, &d->coders[INFRARED_LAYER], &d->arena, &colour[3]);
        put_colour(row + colour_at(form), colour, has_infrared(form) ? 4 : 3);
    }
    uint8_t *bytes = d->extra_last + last * n;
    for (size_t i = 0; i < n; i++)
        if (d->extra_coders[i].end)
            bytes[i] = (uint8_t)(bytes[i] + brio_laz_symbol(&d->extra_coders[i], &d->arena,
                                                            &d->extra_models[d->channel * n + i], 256));
    if (n) memcpy(row + form->record - n, bytes, n);
}

static bool is_past(const brio_laz_decoder *d) {
    size_t coders = d->form.layered ? sizeof d->coders / sizeof *d->coders : 1;
    for (size_t i = 0; i < coders; i++)
        if (d->coders[i].past) return true;
    for (size_t i = 0; d->form.layered && i < d->form.num_extra; i++)
        if (d->extra_coders[i].past) return true;
    return false;
}

bool brio_laz_next(brio_laz_decoder *d, uint8_t *rows, size_t count) {
    size_t record = d->form.record;
    if (d->first && count) {
        memcpy(rows, d->bytes, record);
        rows += record;
        count--;
        d->first = false;
    }
    /* a layer without bytes has no coder: all others may be absent, this one only where no second record is */
    if (count && d->form.layered && !d->coders[BRIO_LAZ_RETURNS_XY].end) return false;
    for (; count; count--, rows += record) {
        if (d->form.layered)
            next_layered_record(d, rows);
        else
            next_record(d, rows);
    }
    return !is_past(d);
}
