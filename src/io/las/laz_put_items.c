/* Encodes the items of records of formats 0 to 3, and times, colours and near infrared of all formats. Each function is the
 * counterpart of the one that decodes: laz_point10.c, laz_time.c, laz_colour.c. */
#include "io/las/laz_packer.h"
#include "io/little_endian.h"

/* --- points of formats 0 to 5 --- */

/* Encodes a byte with the models that its last value chooses. */
static void put_byte(brio_laz_pen *pen, brio_laz_arena *arena, brio_laz_model *models, uint8_t *last, uint8_t byte) {
    brio_laz_put_symbol(pen, arena, &models[*last], 256, byte);
    *last = byte;
}

static void put_attributes(brio_laz_point10 *p, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t changed,
                           uint32_t returns, const uint8_t *row) {
    uint8_t *last = p->last;
    uint16_t intensity = brio_le16(row + 12);
    if (changed & BRIO_LAZ_INTENSITY_CHANGED)
        brio_laz_put_int16(pen, arena, &p->intensity, p->intensities[returns], intensity, returns < 3 ? returns : 3);
    p->intensities[returns] = intensity;
    if (changed & BRIO_LAZ_CLASS_CHANGED) put_byte(pen, arena, p->classification, last + 15, row[15]);
    if (changed & BRIO_LAZ_ANGLE_CHANGED) {
        uint32_t direction = row[14] >> 6 & 1;
        brio_laz_put_symbol(pen, arena, &p->scan_angle[direction], 256, (uint8_t)(row[16] - last[16]));
    }
    if (changed & BRIO_LAZ_USER_DATA_CHANGED) put_byte(pen, arena, p->user_data, last + 17, row[17]);
    if (changed & BRIO_LAZ_SOURCE_CHANGED)
        brio_laz_put_int16(pen, arena, &p->source, brio_le16(last + 18), brio_le16(row + 18), 0);
}

static uint32_t at_most(uint32_t bits, uint32_t most) {
    return bits < most ? bits & ~1u : most;
}

static void put_position(brio_laz_point10 *p, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t returns,
                         const uint8_t *row) {
    uint32_t n = row[14] >> 3 & 7, r = row[14] & 7, level = n > r ? n - r : r - n, single = n == 1;
    int32_t z = (int32_t)brio_le32(row + 8);
    int32_t step = (int32_t)(brio_le32(row) - (uint32_t)p->position[0]);
    brio_laz_put_int32(pen, arena, &p->dx, brio_laz_median_of(&p->x[returns]), step, single);
    brio_laz_median_add(&p->x[returns], step);
    step = (int32_t)(brio_le32(row + 4) - (uint32_t)p->position[1]);
    brio_laz_put_int32(pen, arena, &p->dy, brio_laz_median_of(&p->y[returns]), step, single + at_most(p->dx.k, 20));
    brio_laz_median_add(&p->y[returns], step);
    brio_laz_put_int32(pen, arena, &p->z, p->heights[level], z, single + at_most((p->dx.k + p->dy.k) / 2, 18));
    p->heights[level] = z;
    for (int i = 0; i < 3; i++) p->position[i] = (int32_t)brio_le32(row + 4 * i);
}

void brio_laz_point10_put(brio_laz_point10 *p, brio_laz_pen *pen, brio_laz_arena *arena, const uint8_t *row) {
    uint8_t *last = p->last;
    uint32_t returns = brio_laz_return_context10(row[14]);
    uint32_t changed = (last[14] != row[14] ? BRIO_LAZ_FLAGS_CHANGED : 0u) |
                       (p->intensities[returns] != brio_le16(row + 12) ? BRIO_LAZ_INTENSITY_CHANGED : 0u) |
                       (last[15] != row[15] ? BRIO_LAZ_CLASS_CHANGED : 0u) |
                       (last[16] != row[16] ? BRIO_LAZ_ANGLE_CHANGED : 0u) |
                       (last[17] != row[17] ? BRIO_LAZ_USER_DATA_CHANGED : 0u) |
                       (brio_le16(last + 18) != brio_le16(row + 18) ? BRIO_LAZ_SOURCE_CHANGED : 0u);
    brio_laz_put_symbol(pen, arena, &p->changed, 64, changed);
    if (changed & BRIO_LAZ_FLAGS_CHANGED) put_byte(pen, arena, p->flags, last + 14, row[14]);
    put_attributes(p, pen, arena, changed, returns, row);
    put_position(p, pen, arena, returns, row);
    memcpy(last, row, sizeof p->last);
}

/* --- times --- */

static bool is_near(uint64_t a, uint64_t b, int32_t *difference) {
    int64_t d = (int64_t)(a - b);
    *difference = (int32_t)d;
    return d == *difference;
}

/* Finds another sequence whose last time is near: 1 to 3 behind the current one, or 0. */
static uint32_t near_sequence(const brio_laz_time *t, uint64_t time) {
    int32_t difference;
    for (uint32_t i = 1; i < 4; i++)
        if (is_near(time, t->times[(t->last + i) & 3], &difference)) return i;
    return 0;
}

/* Begins a sequence with a time that has nothing to do with the others. */
static void put_sequence(brio_laz_time *t, brio_laz_pen *pen, brio_laz_arena *arena, uint64_t time) {
    int32_t predicted = (int32_t)(t->times[t->last] >> 32);
    brio_laz_put_int32(pen, arena, &t->difference, predicted, (int32_t)(time >> 32), BRIO_LAZ_FROM_TIME);
    brio_laz_put_bits(pen, 32, (uint32_t)time);
    t->next = (t->next + 1) & 3;
    t->last = t->next;
    t->times[t->last] = time;
    t->steps[t->last] = 0;
    t->extremes[t->last] = 0;
}

/* Encodes a time that differs from the last one by about a multiple of the step. */
static void put_multiple(brio_laz_time *t, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t symbols,
                         int32_t difference) {
    double ratio = (double)difference / t->steps[t->last];
    int32_t multiple = ratio >= BRIO_LAZ_MOST_STEPS    ? BRIO_LAZ_MOST_STEPS
                       : ratio <= BRIO_LAZ_LEAST_STEPS ? BRIO_LAZ_LEAST_STEPS
                                                       : (int32_t)(ratio < 0 ? ratio - 0.5 : ratio + 0.5);
    uint32_t symbol = (uint32_t)(multiple >= 0 ? multiple : BRIO_LAZ_MOST_STEPS - multiple);
    uint32_t predicted = (uint32_t)multiple * (uint32_t)t->steps[t->last], context = brio_laz_steps_context(symbol);
    brio_laz_put_symbol(pen, arena, &t->multiple, symbols, symbol);
    brio_laz_put_int32(pen, arena, &t->difference, (int32_t)predicted, difference, context);
    brio_laz_time_step(t, difference, context);
}

void brio_laz_time_put(brio_laz_time *t, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t may_stay, uint64_t time) {
    int32_t difference;
    for (;;) {
        bool stepped = t->steps[t->last] != 0, near = is_near(time, t->times[t->last], &difference);
        brio_laz_model *m = stepped ? &t->multiple : &t->first;
        uint32_t symbols = (stepped ? BRIO_LAZ_NEW_TIME + 4u : 5u) + may_stay;
        /* the first symbol of a new time, and of another sequence; without a step a difference comes before it */
        uint32_t other = (stepped ? BRIO_LAZ_NEW_TIME : 1u) + may_stay, sequence = near ? 0 : near_sequence(t, time);
        if (may_stay && time == t->times[t->last]) {
            brio_laz_put_symbol(pen, arena, m, symbols, stepped ? BRIO_LAZ_NEW_TIME : 0);
            return;
        }
        if (near && stepped) {
            put_multiple(t, pen, arena, symbols, difference);
        } else if (near) {
            brio_laz_put_symbol(pen, arena, m, symbols, may_stay);
            brio_laz_put_int32(pen, arena, &t->difference, 0, difference, BRIO_LAZ_FROM_ZERO);
            t->steps[t->last] = difference;
            t->extremes[t->last] = 0;
        } else if (!sequence) {
            brio_laz_put_symbol(pen, arena, m, symbols, other);
            put_sequence(t, pen, arena, time);
        } else {
            brio_laz_put_symbol(pen, arena, m, symbols, other + sequence);
            t->last = (t->last + sequence) & 3;
            continue;
        }
        t->times[t->last] = time;
        return;
    }
}

/* --- colours --- */

enum { ALL_EQUAL_NOT = 1 << 6 };

static int clamped(int x) {
    return x < 0 ? 0 : x > 255 ? 255 : x;
}

static int byte_of(uint16_t value, int half) {
    return value >> 8 * half & 255;
}

static void put_change(brio_laz_pen *pen, brio_laz_arena *arena, brio_laz_model *m, int byte, int predicted) {
    brio_laz_put_symbol(pen, arena, m, 256, (uint8_t)(byte - predicted));
}

void brio_laz_colour_put(brio_laz_colour_models *m, brio_laz_pen *pen, brio_laz_arena *arena, uint16_t last[3],
                         const uint16_t colour[3]) {
    uint32_t used = colour[0] != colour[1] || colour[0] != colour[2] ? ALL_EQUAL_NOT : 0;
    for (int i = 0; i < 3; i++)
        for (int half = 0; half < 2; half++)
            if (byte_of(last[i], half) != byte_of(colour[i], half)) used |= 1u << (2 * i + half);
    brio_laz_put_symbol(pen, arena, &m->used, 128, used);
    for (int half = 0; half < 2; half++)
        if (used >> half & 1)
            put_change(pen, arena, &m->differences[half], byte_of(colour[0], half), byte_of(last[0], half));
    for (int half = 0; half < 2 && used & ALL_EQUAL_NOT; half++) {
        int green = byte_of(last[1], half), blue = byte_of(last[2], half);
        int step = byte_of(colour[0], half) - byte_of(last[0], half);
        if (used >> (2 + half) & 1)
            put_change(pen, arena, &m->differences[2 + half], byte_of(colour[1], half), clamped(green + step));
        step = (step + byte_of(colour[1], half) - green) / 2;
        if (used >> (4 + half) & 1)
            put_change(pen, arena, &m->differences[4 + half], byte_of(colour[2], half), clamped(blue + step));
    }
    for (int i = 0; i < 3; i++) {
        pen->differs |= last[i] != colour[i];
        last[i] = colour[i];
    }
}

void brio_laz_infrared_put(brio_laz_infrared_models *m, brio_laz_pen *pen, brio_laz_arena *arena, uint16_t *last,
                           uint16_t value) {
    uint32_t used = 0;
    for (int half = 0; half < 2; half++)
        if (byte_of(*last, half) != byte_of(value, half)) used |= 1u << half;
    brio_laz_put_symbol(pen, arena, &m->used, 4, used);
    for (int half = 0; half < 2; half++)
        if (used >> half & 1) put_change(pen, arena, &m->differences[half], byte_of(value, half), byte_of(*last, half));
    pen->differs |= *last != value;
    *last = value;
}
