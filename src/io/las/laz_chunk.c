/* The models of a chunk of compressed records, see laz_chunk.h.
 *
 * Layers of version 3 keep two mistakes of the first encoder. Colours and extra bytes of a point are those of channel 0
 * unless the channel changes at that point. Where it changes to a channel that was used before, the last colours and
 * extra bytes are those of the channel that was left, with the models of the new one. */
#include "io/las/laz_chunk.h"
#include "io/little_endian.h"

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
