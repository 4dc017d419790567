/* Compressed points of LAS formats 6 to 10: nine layers, each with its own bytes and decoder.
 *
 * The first layer says what changed, and has the returns and steps in x and y. All predictors exist once for each
 * channel of the scanner. A channel that is new in its chunk begins with the last point of the channel before it. */
#include "io/las/laz_items.h"
#include "io/little_endian.h"

/* The context of a return: by the number of returns and the number of this one. */
static const uint8_t return_context[16][16] = {
    {0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5}, {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
    {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3}, {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
    {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4}, {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
    {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4}, {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
    {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
    {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5}, {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5}};

void brio_laz_channel_begin(brio_laz_channel *h, const uint8_t *first) {
    h->used = true;
    memcpy(h->last, first, sizeof h->last);
    for (int i = 0; i < 8; i++) {
        h->heights[i] = (int32_t)brio_le32(first + 8);
        h->intensities[i] = brio_le16(first + BRIO_LAZ_AT_INTENSITY);
    }
    brio_laz_time_begin(&h->time, brio_le64(first + BRIO_LAZ_AT_TIME));
}

void brio_laz_point14_begin(brio_laz_point14 *p, const uint8_t *first) {
    p->channel = first[BRIO_LAZ_AT_FLAGS] >> 4 & 3;
    brio_laz_channel_begin(&p->channels[p->channel], first);
}

uint32_t brio_laz_return_context14(uint8_t returns) {
    return return_context[returns >> 4][returns & 15];
}

uint32_t brio_laz_place14(uint8_t returns) {
    uint32_t r = returns & 15, n = returns >> 4;
    return (r == 1) + 2u * (r >= n);
}

static void switch_channel(brio_laz_point14 *p, brio_laz_coder *c, brio_laz_arena *arena) {
    brio_laz_channel *old = &p->channels[p->channel];
    p->channel = (p->channel + brio_laz_symbol(c, arena, &old->channel, 3) + 1) & 3;
    brio_laz_channel *h = &p->channels[p->channel];
    if (!h->used) brio_laz_channel_begin(h, old->last);
    h->last[BRIO_LAZ_AT_FLAGS] = (uint8_t)((h->last[BRIO_LAZ_AT_FLAGS] & ~0x30) | p->channel << 4);
}

static void next_returns(brio_laz_channel *h, brio_laz_coder *c, brio_laz_arena *arena, uint32_t changed) {
    uint32_t r = h->last[BRIO_LAZ_AT_RETURNS] & 15, n = h->last[BRIO_LAZ_AT_RETURNS] >> 4;
    if (changed & BRIO_LAZ_RETURNS_14) n = brio_laz_symbol(c, arena, &h->num_returns[n], 16);
    if ((changed & BRIO_LAZ_RETURN_14) == 1)
        r = (r + 1) & 15;
    else if ((changed & BRIO_LAZ_RETURN_14) == 2)
        r = (r + 15) & 15;
    else if ((changed & BRIO_LAZ_RETURN_14) == 3 && changed & BRIO_LAZ_TIME_14)
        r = brio_laz_symbol(c, arena, &h->return_number[r], 16);
    else if ((changed & BRIO_LAZ_RETURN_14) == 3)
        r = (r + brio_laz_symbol(c, arena, &h->return_same_time, 13) + 2) & 15;
    h->last[BRIO_LAZ_AT_RETURNS] = (uint8_t)(r | n << 4);
}

static uint32_t at_most(uint32_t bits, uint32_t most) {
    return bits < most ? bits & ~1u : most;
}

static void add(uint8_t *coordinate, int32_t step) {
    brio_put_le32(coordinate, brio_le32(coordinate) + (uint32_t)step);
}

static void next_position(brio_laz_channel *h, brio_laz_coder *layers, brio_laz_arena *arena, bool time_changed) {
    uint32_t r = h->last[BRIO_LAZ_AT_RETURNS] & 15, n = h->last[BRIO_LAZ_AT_RETURNS] >> 4,
             level = n > r ? n - r : r - n;
    uint32_t context = 2u * brio_laz_return_context14(h->last[BRIO_LAZ_AT_RETURNS]) + time_changed, single = n == 1;
    brio_laz_coder *c = &layers[BRIO_LAZ_RETURNS_XY];
    int32_t step = brio_laz_int32(c, arena, &h->dx, brio_laz_median_of(&h->x[context]), single);
    add(h->last, step);
    brio_laz_median_add(&h->x[context], step);
    step = brio_laz_int32(c, arena, &h->dy, brio_laz_median_of(&h->y[context]), single + at_most(h->dx.k, 20));
    add(h->last + 4, step);
    brio_laz_median_add(&h->y[context], step);
    if (!layers[BRIO_LAZ_Z].end) return;
    if (level > 7) level = 7;
    h->heights[level] = brio_laz_int32(&layers[BRIO_LAZ_Z], arena, &h->z, h->heights[level],
                                       single + at_most((h->dx.k + h->dy.k) / 2, 18));
    brio_put_le32(h->last + 8, (uint32_t)h->heights[level]);
}

/* Decodes the edge of the flight line, the direction of the scan and the flags of the classification, which are one
 * symbol. The channel lies between them in the byte. */
static void next_flags(brio_laz_channel *h, brio_laz_coder *c, brio_laz_arena *arena) {
    uint32_t byte = h->last[BRIO_LAZ_AT_FLAGS], flags = (byte & 15) | (byte >> 2 & 0x30);
    flags = brio_laz_symbol(c, arena, &h->flags[flags], 64);
    h->last[BRIO_LAZ_AT_FLAGS] = (uint8_t)((byte & 0x30) | (flags & 15) | (flags & 0x30) << 2);
}

static void next_bytes(brio_laz_channel *h, brio_laz_coder *layers, brio_laz_arena *arena, uint32_t place) {
    uint8_t *last = h->last;
    if (layers[BRIO_LAZ_CLASSIFICATION].end) {
        brio_laz_model *m = &h->classification[(last[BRIO_LAZ_AT_CLASSIFICATION] & 31) * 2 + (place == 3)];
        last[BRIO_LAZ_AT_CLASSIFICATION] = (uint8_t)brio_laz_symbol(&layers[BRIO_LAZ_CLASSIFICATION], arena, m, 256);
    }
    if (layers[BRIO_LAZ_FLAGS].end) next_flags(h, &layers[BRIO_LAZ_FLAGS], arena);
    if (layers[BRIO_LAZ_USER_DATA].end) {
        brio_laz_model *m = &h->user_data[last[BRIO_LAZ_AT_USER_DATA] / 4];
        last[BRIO_LAZ_AT_USER_DATA] = (uint8_t)brio_laz_symbol(&layers[BRIO_LAZ_USER_DATA], arena, m, 256);
    }
}

/* Decodes a number of 16 bits, predicted by its last value. */
static void next_number(uint8_t *number, brio_laz_coder *c, brio_laz_arena *arena, brio_laz_integer *models,
                        uint32_t context) {
    brio_put_le16(number, brio_laz_int16(c, arena, models, brio_le16(number), context));
}

static void next_numbers(brio_laz_channel *h, brio_laz_coder *layers, brio_laz_arena *arena, uint32_t changed,
                         uint32_t place) {
    bool time_changed = changed & BRIO_LAZ_TIME_14;
    if (layers[BRIO_LAZ_INTENSITY].end) {
        uint16_t *intensity = &h->intensities[2 * place + time_changed];
        *intensity = brio_laz_int16(&layers[BRIO_LAZ_INTENSITY], arena, &h->intensity, *intensity, place);
        brio_put_le16(h->last + BRIO_LAZ_AT_INTENSITY, *intensity);
    }
    if (changed & BRIO_LAZ_ANGLE_14 && layers[BRIO_LAZ_SCAN_ANGLE].end)
        next_number(h->last + BRIO_LAZ_AT_SCAN_ANGLE, &layers[BRIO_LAZ_SCAN_ANGLE], arena, &h->scan_angle,
                    time_changed);
    if (changed & BRIO_LAZ_SOURCE_14 && layers[BRIO_LAZ_SOURCE].end)
        next_number(h->last + BRIO_LAZ_AT_SOURCE, &layers[BRIO_LAZ_SOURCE], arena, &h->source, 0);
    if (time_changed && layers[BRIO_LAZ_TIME].end)
        brio_put_le64(h->last + BRIO_LAZ_AT_TIME, brio_laz_time_next(&h->time, &layers[BRIO_LAZ_TIME], arena, 0));
}

bool brio_laz_point14_next(brio_laz_point14 *p, brio_laz_coder *layers, brio_laz_arena *arena, uint8_t *row) {
    brio_laz_coder *c = &layers[BRIO_LAZ_RETURNS_XY];
    brio_laz_channel *h = &p->channels[p->channel];
    uint32_t kind = brio_laz_place14(h->last[BRIO_LAZ_AT_RETURNS]) + 4u * h->time_changed;
    uint32_t changed = brio_laz_symbol(c, arena, &h->changed[kind], 128);
    if (changed & BRIO_LAZ_CHANNEL_14) switch_channel(p, c, arena);
    h = &p->channels[p->channel];
    next_returns(h, c, arena, changed);
    next_position(h, layers, arena, changed & BRIO_LAZ_TIME_14);
    uint32_t place = brio_laz_place14(h->last[BRIO_LAZ_AT_RETURNS]);
    next_bytes(h, layers, arena, place);
    next_numbers(h, layers, arena, changed, place);
    h->time_changed = changed & BRIO_LAZ_TIME_14;
    memcpy(row, h->last, sizeof h->last);
    return changed & BRIO_LAZ_CHANNEL_14;
}
