/* Encodes points of formats 6 to 8 in layers: the counterpart of laz_point14.c. */
#include "io/las/laz_packer.h"
#include "io/little_endian.h"

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

static void switch_channel(brio_laz_point14 *p, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t channel) {
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

static uint32_t at_most(uint32_t bits, uint32_t most) {
    return bits < most ? bits & ~1u : most;
}

static int32_t step_of(const uint8_t *last, const uint8_t *row) {
    return (int32_t)(brio_le32(row) - brio_le32(last));
}

static void put_position(brio_laz_channel *h, brio_laz_pen *layers, brio_laz_arena *arena, bool time_changed,
                         const uint8_t *row) {
    uint32_t r = row[BRIO_LAZ_AT_RETURNS] & 15, n = row[BRIO_LAZ_AT_RETURNS] >> 4, level = n > r ? n - r : r - n;
    uint32_t context = 2u * brio_laz_return_context14(row[BRIO_LAZ_AT_RETURNS]) + time_changed, single = n == 1;
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

/* The edge of the flight line, the direction of the scan and the flags of the classification, without the channel that lies
 * between them in the byte. */
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
    uint32_t kind = brio_laz_place14(old->last[BRIO_LAZ_AT_RETURNS]) + 4u * old->time_changed;
    if (!h->used) brio_laz_channel_begin(h, old->last);
    uint32_t changed = changes(h->last, row);
    if (h != old) changed |= BRIO_LAZ_CHANNEL_14;
    brio_laz_put_symbol(pen, arena, &old->changed[kind], 128, changed);
    if (h != old) switch_channel(p, pen, arena, channel_of(row));
    put_returns(h, pen, arena, changed, row);
    put_position(h, layers, arena, changed & BRIO_LAZ_TIME_14, row);
    uint32_t place = brio_laz_place14(row[BRIO_LAZ_AT_RETURNS]);
    put_bytes(h, layers, arena, place, row);
    put_numbers(h, layers, arena, changed, place, row);
    h->time_changed = changed & BRIO_LAZ_TIME_14;
    memcpy(h->last, row, sizeof h->last);
    layers[BRIO_LAZ_RETURNS_XY].differs = layers[BRIO_LAZ_Z].differs = true;
    return h != old;
}
