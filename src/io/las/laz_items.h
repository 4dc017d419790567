/* The items of a compressed LAS record and their predictors. An item keeps what it decoded last; the next value is
 * coded as a difference to it. The bytes of an item are those of a LAS record.
 *
 * An item whose bytes are all 0, except for what its _begin function sets, is at the beginning of a chunk.
 *
 * Based on: Isenburg. LASzip: lossless compression of LiDAR data. Photogrammetric Engineering and Remote Sensing 79,
 * 2013. */
#ifndef BRIO_IO_LAZ_ITEMS_H
#define BRIO_IO_LAZ_ITEMS_H

#include "io/las/laz_decoder.h"
#include "io/las/laz_model.h"

/* --- the median of the last values --- */

/** Five values in ascending order. A new one replaces the largest or the smallest in turn, so that the middle one
 *  follows the median of a changing sequence. */
typedef struct brio_laz_median {
    int32_t values[5];
    bool drops_smallest;
} brio_laz_median;

static inline int32_t brio_laz_median_of(const brio_laz_median *m) {
    return m->values[2];
}

static inline void brio_laz_median_add(brio_laz_median *m, int32_t x) {
    int32_t old[4], middle = m->values[2];
    bool drops_smallest = m->drops_smallest;
    for (int i = 0; i < 4; i++) old[i] = m->values[i + drops_smallest];
    m->drops_smallest = drops_smallest ? middle < x : x >= middle;
    for (int i = 0; i < 4; i++) {
        int32_t low = old[i] < x ? old[i] : x;
        x = old[i] < x ? x : old[i];
        m->values[i] = low;
    }
    m->values[4] = x;
}

/* --- points of formats 0 to 5 --- */

enum { BRIO_LAZ_POINT10 = 20, BRIO_LAZ_POINT14 = 30 /* bytes */ };

typedef struct brio_laz_point10 {
    uint8_t last[BRIO_LAZ_POINT10];
    int32_t position[3];
    brio_laz_median x[16], y[16];
    uint16_t intensities[16];
    int32_t heights[8];
    brio_laz_model changed, scan_angle[2], flags[256], classification[256], user_data[256];
    brio_laz_integer intensity, source, dx, dy, z;
} brio_laz_point10;

/** The attributes that changed, as the first symbol of a point says it. */
enum {
    BRIO_LAZ_SOURCE_CHANGED = 1,
    BRIO_LAZ_USER_DATA_CHANGED = 2,
    BRIO_LAZ_ANGLE_CHANGED = 4,
    BRIO_LAZ_CLASS_CHANGED = 8,
    BRIO_LAZ_INTENSITY_CHANGED = 16,
    BRIO_LAZ_FLAGS_CHANGED = 32
};

void brio_laz_point10_begin(brio_laz_point10 *p, const uint8_t *first);
void brio_laz_point10_next(brio_laz_point10 *p, brio_laz_coder *c, brio_laz_arena *arena, uint8_t *row);

/* --- times --- */

/** Four sequences of times, of which one is the current one. */
typedef struct brio_laz_time {
    uint64_t times[4]; /* the bits of doubles */
    int32_t steps[4];
    int extremes[4]; /* steps one after the other that were far from a multiple of the step */
    uint32_t last, next;
    brio_laz_model multiple, first;
    brio_laz_integer difference;
} brio_laz_time;

void brio_laz_time_begin(brio_laz_time *t, uint64_t first);

/* Symbols of a multiple: 0 something else than a multiple, 1 to MOST_STEPS the multiple, above MOST_STEPS negative ones
 * down to LEAST_STEPS. Behind these come the symbols of a new time and of the other sequences. */
enum {
    BRIO_LAZ_MOST_STEPS = 500,
    BRIO_LAZ_LEAST_STEPS = -10,
    BRIO_LAZ_NEW_TIME = BRIO_LAZ_MOST_STEPS - BRIO_LAZ_LEAST_STEPS + 1
};

/* Contexts of the difference of times. */
enum {
    BRIO_LAZ_FROM_ZERO,
    BRIO_LAZ_FROM_STEP,
    BRIO_LAZ_FROM_SMALL,
    BRIO_LAZ_FROM_LARGE,
    BRIO_LAZ_FROM_MOST,
    BRIO_LAZ_FROM_NEGATIVE,
    BRIO_LAZ_FROM_LEAST,
    BRIO_LAZ_FROM_NOTHING,
    BRIO_LAZ_FROM_TIME
};

/** Decodes the next time.   may_stay  1 in formats 0 to 5, where a symbol says that the time stays; 0 in the layers. */
uint64_t brio_laz_time_next(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t may_stay);

/* --- colours --- */

typedef struct brio_laz_colour_models {
    brio_laz_model used, differences[6];
} brio_laz_colour_models;

/** Decodes red, green and blue.   last  the last colour, which the new one replaces. */
void brio_laz_colour_next(brio_laz_colour_models *m, brio_laz_coder *c, brio_laz_arena *arena, uint16_t last[3]);

typedef struct brio_laz_infrared_models {
    brio_laz_model used, differences[2];
} brio_laz_infrared_models;
void brio_laz_infrared_next(brio_laz_infrared_models *m, brio_laz_coder *c, brio_laz_arena *arena, uint16_t *last);

/* --- points of formats 6 to 10, in layers --- */

/** The layers of a point, in the file's order. A layer without bytes has values that stay. */
typedef enum {
    BRIO_LAZ_RETURNS_XY,
    BRIO_LAZ_Z,
    BRIO_LAZ_CLASSIFICATION,
    BRIO_LAZ_FLAGS,
    BRIO_LAZ_INTENSITY,
    BRIO_LAZ_SCAN_ANGLE,
    BRIO_LAZ_USER_DATA,
    BRIO_LAZ_SOURCE,
    BRIO_LAZ_TIME,
    BRIO_LAZ_POINT14_LAYERS
} brio_laz_layer;

/** What is kept for each channel of the scanner. */
typedef struct brio_laz_channel {
    bool used, time_changed;
    uint8_t last[BRIO_LAZ_POINT14];
    brio_laz_median x[12], y[12];
    int32_t heights[8];
    uint16_t intensities[8];
    brio_laz_model changed[8], channel, num_returns[16], return_number[16], return_same_time;
    brio_laz_model classification[64], flags[64], user_data[64];
    brio_laz_integer dx, dy, z, intensity, scan_angle, source;
    brio_laz_time time;
} brio_laz_channel;

typedef struct brio_laz_point14 {
    brio_laz_channel channels[4];
    uint32_t channel; /* the current one */
} brio_laz_point14;

/** What changed, as the first symbol of a point says it. */
enum {
    BRIO_LAZ_RETURN_14 = 3, /* 0: the same; 1: the next; 2: the one before; 3: another one */
    BRIO_LAZ_RETURNS_14 = 1 << 2,
    BRIO_LAZ_ANGLE_14 = 1 << 3,
    BRIO_LAZ_TIME_14 = 1 << 4,
    BRIO_LAZ_SOURCE_14 = 1 << 5,
    BRIO_LAZ_CHANNEL_14 = 1 << 6
};

/** Where the bytes of the attributes are. */
enum {
    BRIO_LAZ_AT_INTENSITY = 12,
    BRIO_LAZ_AT_RETURNS = 14,
    BRIO_LAZ_AT_FLAGS = 15,
    BRIO_LAZ_AT_CLASSIFICATION = 16,
    BRIO_LAZ_AT_USER_DATA = 17,
    BRIO_LAZ_AT_SCAN_ANGLE = 18,
    BRIO_LAZ_AT_SOURCE = 20,
    BRIO_LAZ_AT_TIME = 22
};

void brio_laz_point14_begin(brio_laz_point14 *p, const uint8_t *first);

/** Decodes the next point.   layers  the decoders of the layers; the one of an empty layer has no bytes.
 *  Returns whether the channel changed. */
bool brio_laz_point14_next(brio_laz_point14 *p, brio_laz_coder *layers, brio_laz_arena *arena, uint8_t *row);

/* --- a chunk --- */

/* What decoder and encoder of a chunk of compressed records share: what is in a record, and the models of its items,
 * which both must change in the same way. */

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
/** Makes a state.   memory  brio_laz_state_bytes(form) bytes, owned by the caller; models first, so aligned for
 *  them. */
void brio_laz_state_make(brio_laz_chunk_state *state, void *memory, const brio_laz_form *form);
/** Begins a chunk with its first record. */
void brio_laz_state_begin(brio_laz_chunk_state *state, const uint8_t *record);

/** Goes to the colours and extra bytes of a channel.
 *  Returns the channel whose last colour and extra bytes are the current ones. */
uint32_t brio_laz_switch_items(brio_laz_chunk_state *state, uint32_t channel);

#endif
