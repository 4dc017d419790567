/* Decodes a chunk of a LAZ file.
 *
 * A chunk begins with its first record as it is. In formats 0 to 5 one stream of bytes follows, in which the items of
 * the records alternate. In formats 6 to 10 the number of points follows, the sizes of the layers, and the layers. */
#include "io/las/laz_decoder.h"
#include "io/las/laz_chunk.h"
#include "io/little_endian.h"

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
