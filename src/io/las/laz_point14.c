/* Compressed points of LAS formats 6 to 10: nine layers, each with its own bytes and decoder.
 *
 * The first layer says what changed, and has the returns and steps in x and y. All predictors exist once for each
 * channel of the scanner. A channel that is new in its chunk begins with the last point of the channel before it. */
#include "io/las/laz_items.h"
#include "io/las/laz_write.h"
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

/* Begins a channel with the point that was the last one before it. */
static void laz_channel_begin(brio_laz_channel *h, const uint8_t *first) {
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
    laz_channel_begin(&p->channels[p->channel], first);
}

/* Returns the context of the steps in x and y, by the byte of the returns. */
static uint32_t laz_return_context14(uint8_t returns) {
    return return_context[returns >> 4][returns & 15];
}

/* Returns the place of a return in its pulse: bit 0: the first one, bit 1: the last one. */
static uint32_t laz_place14(uint8_t returns) {
    uint32_t r = returns & 15, n = returns >> 4;
    return (r == 1) + 2u * (r >= n);
}

static void switch_channel(brio_laz_point14 *p, brio_laz_coder *c, brio_laz_arena *arena) {
    brio_laz_channel *old = &p->channels[p->channel];
    p->channel = (p->channel + brio_laz_symbol(c, arena, &old->channel, 3) + 1) & 3;
    brio_laz_channel *h = &p->channels[p->channel];
    if (!h->used) laz_channel_begin(h, old->last);
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
    uint32_t context = 2u * laz_return_context14(h->last[BRIO_LAZ_AT_RETURNS]) + time_changed, single = n == 1;
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
    uint32_t kind = laz_place14(h->last[BRIO_LAZ_AT_RETURNS]) + 4u * h->time_changed;
    uint32_t changed = brio_laz_symbol(c, arena, &h->changed[kind], 128);
    if (changed & BRIO_LAZ_CHANNEL_14) switch_channel(p, c, arena);
    h = &p->channels[p->channel];
    next_returns(h, c, arena, changed);
    next_position(h, layers, arena, changed & BRIO_LAZ_TIME_14);
    uint32_t place = laz_place14(h->last[BRIO_LAZ_AT_RETURNS]);
    next_bytes(h, layers, arena, place);
    next_numbers(h, layers, arena, changed, place);
    h->time_changed = changed & BRIO_LAZ_TIME_14;
    memcpy(row, h->last, sizeof h->last);
    return changed & BRIO_LAZ_CHANNEL_14;
}

/* --- the same, encoded --- */

/* Encodes points of formats 6 to 8 in layers: the counterpart of laz_point14.c. */

static uint32_t channel_of(const uint8_t *row) {
    return row[BRIO_LAZ_AT_FLAGS] >> 4 & 3;
}

/* Finds what changed since the last point of the channel. */
static uint32_t changes(const uint8_t *last, const uint8_t *row) {
    uint32_t old = last[BRIO_LAZ_AT_RETURNS], new = row[BRIO_LAZ_AT_RETURNS], by = (new - old) & 15;
    uint32_t changed = by == 0 ? 0 : by == 1 ? 1 : by == 15 ? 2 : 3;
    if (old >> 4 != new >> 4) changed |= BRIO_LAZ_RETURNS_14;
    if (memcmp(last + BRIO_LAZ_AT_SCAN_ANGLE, row + BRIO_LAZ_AT_SCAN_ANGLE, 2)) changed |= BRIO_LAZ_ANGLE_14;
    if (memcmp(last + BRIO_LAZ_AT_SOURCE, row + BRIO_LAZ_AT_SOURCE, 2)) changed |= BRIO_LAZ_SOURCE_14;
    if (memcmp(last + BRIO_LAZ_AT_TIME, row + BRIO_LAZ_AT_TIME, 8)) changed |= BRIO_LAZ_TIME_14;
    return changed;
}

static void put_channel(brio_laz_point14 *p, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t channel) {
    brio_laz_channel *old = &p->channels[p->channel];
    brio_laz_put_symbol(pen, arena, &old->channel, 3, (channel - p->channel - 1) & 3);
    p->channel = channel;
}

static void put_returns(brio_laz_channel *h, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t changed,
                        const uint8_t *row) {
    uint32_t old = h->last[BRIO_LAZ_AT_RETURNS], r = old & 15, new = row[BRIO_LAZ_AT_RETURNS] & 15;
    if (changed & BRIO_LAZ_RETURNS_14)
        brio_laz_put_symbol(pen, arena, &h->num_returns[old >> 4], 16, row[BRIO_LAZ_AT_RETURNS] >> 4);
    if ((changed & BRIO_LAZ_RETURN_14) != 3) return;
    if (changed & BRIO_LAZ_TIME_14)
        brio_laz_put_symbol(pen, arena, &h->return_number[r], 16, new);
    else
        brio_laz_put_symbol(pen, arena, &h->return_same_time, 13, ((new - r) & 15) - 2);
}

static int32_t step_of(const uint8_t *last, const uint8_t *row) {
    return (int32_t)(brio_le32(row) - brio_le32(last));
}

static void put_position(brio_laz_channel *h, brio_laz_pen *layers, brio_laz_arena *arena, bool time_changed,
                         const uint8_t *row) {
    uint32_t r = row[BRIO_LAZ_AT_RETURNS] & 15, n = row[BRIO_LAZ_AT_RETURNS] >> 4, level = n > r ? n - r : r - n;
    uint32_t context = 2u * laz_return_context14(row[BRIO_LAZ_AT_RETURNS]) + time_changed, single = n == 1;
    brio_laz_pen *pen = &layers[BRIO_LAZ_RETURNS_XY];
    int32_t step = step_of(h->last, row), z = (int32_t)brio_le32(row + 8);
    brio_laz_put_int32(pen, arena, &h->dx, brio_laz_median_of(&h->x[context]), step, single);
    brio_laz_median_add(&h->x[context], step);
    step = step_of(h->last + 4, row + 4);
    brio_laz_put_int32(pen, arena, &h->dy, brio_laz_median_of(&h->y[context]), step, single + at_most(h->dx.k, 20));
    brio_laz_median_add(&h->y[context], step);
    if (level > 7) level = 7;
    brio_laz_put_int32(&layers[BRIO_LAZ_Z], arena, &h->z, h->heights[level], z,
                       single + at_most((h->dx.k + h->dy.k) / 2, 18));
    h->heights[level] = z;
}

/* Returns the edge of the flight line, the direction of the scan and the flags of the classification, without the
 * channel that lies between them in the byte. */
static uint32_t flags_of(uint8_t byte) {
    return (byte & 15) | (byte >> 2 & 0x30);
}

static void put_bytes(brio_laz_channel *h, brio_laz_pen *layers, brio_laz_arena *arena, uint32_t place,
                      const uint8_t *row) {
    const uint8_t *last = h->last;
    uint8_t kind = last[BRIO_LAZ_AT_CLASSIFICATION], data = last[BRIO_LAZ_AT_USER_DATA];
    uint32_t flags = flags_of(last[BRIO_LAZ_AT_FLAGS]), new_flags = flags_of(row[BRIO_LAZ_AT_FLAGS]);
    brio_laz_put_symbol(&layers[BRIO_LAZ_CLASSIFICATION], arena, &h->classification[(kind & 31) * 2 + (place == 3)],
                        256, row[BRIO_LAZ_AT_CLASSIFICATION]);
    layers[BRIO_LAZ_CLASSIFICATION].differs |= kind != row[BRIO_LAZ_AT_CLASSIFICATION];
    brio_laz_put_symbol(&layers[BRIO_LAZ_FLAGS], arena, &h->flags[flags], 64, new_flags);
    layers[BRIO_LAZ_FLAGS].differs |= flags != new_flags;
    brio_laz_put_symbol(&layers[BRIO_LAZ_USER_DATA], arena, &h->user_data[data / 4], 256, row[BRIO_LAZ_AT_USER_DATA]);
    layers[BRIO_LAZ_USER_DATA].differs |= data != row[BRIO_LAZ_AT_USER_DATA];
}

static void put_numbers(brio_laz_channel *h, brio_laz_pen *layers, brio_laz_arena *arena, uint32_t changed,
                        uint32_t place, const uint8_t *row) {
    const uint8_t *last = h->last;
    bool time_changed = changed & BRIO_LAZ_TIME_14;
    uint16_t intensity = brio_le16(row + BRIO_LAZ_AT_INTENSITY), *known = &h->intensities[2 * place + time_changed];
    brio_laz_put_int16(&layers[BRIO_LAZ_INTENSITY], arena, &h->intensity, *known, intensity, place);
    layers[BRIO_LAZ_INTENSITY].differs |= brio_le16(last + BRIO_LAZ_AT_INTENSITY) != intensity;
    *known = intensity;
    if (changed & BRIO_LAZ_ANGLE_14)
        brio_laz_put_int16(&layers[BRIO_LAZ_SCAN_ANGLE], arena, &h->scan_angle,
                           brio_le16(last + BRIO_LAZ_AT_SCAN_ANGLE), brio_le16(row + BRIO_LAZ_AT_SCAN_ANGLE),
                           time_changed);
    if (changed & BRIO_LAZ_SOURCE_14)
        brio_laz_put_int16(&layers[BRIO_LAZ_SOURCE], arena, &h->source, brio_le16(last + BRIO_LAZ_AT_SOURCE),
                           brio_le16(row + BRIO_LAZ_AT_SOURCE), 0);
    if (time_changed) brio_laz_time_put(&h->time, &layers[BRIO_LAZ_TIME], arena, 0, brio_le64(row + BRIO_LAZ_AT_TIME));
    layers[BRIO_LAZ_SCAN_ANGLE].differs |= changed & BRIO_LAZ_ANGLE_14;
    layers[BRIO_LAZ_SOURCE].differs |= changed & BRIO_LAZ_SOURCE_14;
    layers[BRIO_LAZ_TIME].differs |= time_changed;
}

bool brio_laz_point14_put(brio_laz_point14 *p, brio_laz_pen *layers, brio_laz_arena *arena, const uint8_t *row) {
    brio_laz_pen *pen = &layers[BRIO_LAZ_RETURNS_XY];
    brio_laz_channel *old = &p->channels[p->channel], *h = &p->channels[channel_of(row)];
    uint32_t kind = laz_place14(old->last[BRIO_LAZ_AT_RETURNS]) + 4u * old->time_changed;
    if (!h->used) laz_channel_begin(h, old->last);
    uint32_t changed = changes(h->last, row);
    if (h != old) changed |= BRIO_LAZ_CHANNEL_14;
    brio_laz_put_symbol(pen, arena, &old->changed[kind], 128, changed);
    if (h != old) put_channel(p, pen, arena, channel_of(row));
    put_returns(h, pen, arena, changed, row);
    put_position(h, layers, arena, changed & BRIO_LAZ_TIME_14, row);
    uint32_t place = laz_place14(row[BRIO_LAZ_AT_RETURNS]);
    put_bytes(h, layers, arena, place, row);
    put_numbers(h, layers, arena, changed, place, row);
    h->time_changed = changed & BRIO_LAZ_TIME_14;
    memcpy(h->last, row, sizeof h->last);
    layers[BRIO_LAZ_RETURNS_XY].differs = layers[BRIO_LAZ_Z].differs = true;
    return h != old;
}
