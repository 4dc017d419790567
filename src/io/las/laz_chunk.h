/* What decoder and encoder of a chunk of compressed records share: what is in a record, and the models of its items, which
 * both must change in the same way. */
#ifndef BRIO_IO_LAZ_CHUNK_H
#define BRIO_IO_LAZ_CHUNK_H

#include "io/las/laz_decoder.h"
#include "io/las/laz_items.h"

enum { BRIO_LAZ_CHANNELS = 4 };
/** The layers behind those of a point. Those of the extra bytes follow. */
enum { BRIO_LAZ_COLOUR_LAYER = BRIO_LAZ_POINT14_LAYERS, BRIO_LAZ_INFRARED_LAYER, BRIO_LAZ_FIXED_LAYERS };

/** Colours and extra bytes of one channel. */
typedef struct brio_laz_channel_items {
    bool used;
    uint16_t colour[4]; /* red, green, blue, near infrared */
    brio_laz_colour_models colours;
    brio_laz_infrared_models infrared;
} brio_laz_channel_items;

typedef struct brio_laz_chunk_state {
    brio_laz_form form;
    brio_laz_model *extra_models; /* num_extra for each channel */
    uint8_t *extra_last;          /* likewise */
    uint32_t channel;             /* whose colours and extra bytes are the current ones */
    brio_laz_channel_items items[BRIO_LAZ_CHANNELS];
    brio_laz_time time;
    union {
        brio_laz_point10 point10;
        brio_laz_point14 point14;
    };
    brio_laz_arena arena;
} brio_laz_chunk_state;

static inline bool brio_laz_has_time(const brio_laz_form *form) {
    return form->format == 1 || form->format == 3;
}
static inline bool brio_laz_has_colour(const brio_laz_form *form) {
    return form->format == 2 || form->format == 3 || form->format == 7 || form->format == 8 || form->format == 10;
}
static inline bool brio_laz_has_infrared(const brio_laz_form *form) {
    return form->format == 8 || form->format == 10;
}
static inline bool brio_laz_has_wave(const brio_laz_form *form) {
    return form->format == 9 || form->format == 10;
}
/** Returns the place of the colours in a record. */
static inline size_t brio_laz_colour_at(const brio_laz_form *form) {
    return form->layered ? BRIO_LAZ_POINT14 : BRIO_LAZ_POINT10 + (brio_laz_has_time(form) ? 8 : 0);
}
static inline size_t brio_laz_num_layers(const brio_laz_form *form) {
    return BRIO_LAZ_POINT14_LAYERS + (size_t)brio_laz_has_colour(form) + (size_t)brio_laz_has_infrared(form) +
           (size_t)brio_laz_has_wave(form) + form->num_extra;
}

/** Returns the bytes of the memory that a state needs behind itself. */
size_t brio_laz_state_bytes(const brio_laz_form *form);
/** Makes a state.   memory  brio_laz_state_bytes(form) bytes, owned by the caller; models first, so aligned for them. */
void brio_laz_state_make(brio_laz_chunk_state *state, void *memory, const brio_laz_form *form);
/** Begins a chunk with its first record. */
void brio_laz_state_begin(brio_laz_chunk_state *state, const uint8_t *record);

/** Goes to the colours and extra bytes of a channel.
 *  Returns the channel whose last colour and extra bytes are the current ones. */
uint32_t brio_laz_switch_items(brio_laz_chunk_state *state, uint32_t channel);

#endif
