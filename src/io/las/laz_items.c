/* The items of compressed LAS records other than points in layers: decoded, and encoded. Each encoder makes the same
 * changes to the models as its decoder. */
#include "io/las/laz_items.h"
#include "io/las/laz_write.h"
#include "io/little_endian.h"

/* --- points of formats 0 to 5 --- */

/* Compressed points of LAS formats 0 to 5.
 *
 * The first symbol says which of six attributes changed. Steps in x and y are predicted by the median of the last steps
 * of points with the same return, heights by the last height of the same return, each with models that depend on how
 * large the other steps were. */

/* The context of a return: by the number of returns and the number of this one. Pairs that no scanner makes, which are
 * in files all the same, have contexts, too. */
static const uint8_t return_context[8][8] = {{15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},
                                             {13, 1, 2, 4, 7, 11, 11, 10},    {12, 3, 4, 5, 8, 12, 12, 11},
                                             {11, 6, 7, 8, 9, 13, 13, 12},    {10, 10, 11, 12, 13, 14, 14, 13},
                                             {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15}};

/* Returns the context of a return, by the byte of its number and the number of returns. */
static uint32_t laz_return_context10(uint8_t flags) {
    return return_context[flags >> 3 & 7][flags & 7];
}

void brio_laz_point10_begin(brio_laz_point10 *p, const uint8_t *first) {
    memcpy(p->last, first, sizeof p->last);
    for (int i = 0; i < 3; i++) p->position[i] = (int32_t)brio_le32(first + 4 * i);
    brio_put_le16(p->last + 12, 0);
}

/* Decodes a byte with the models that its last value chooses. */
static void next_byte(brio_laz_coder *c, brio_laz_arena *arena, brio_laz_model *models, uint8_t *byte) {
    *byte = (uint8_t)brio_laz_symbol(c, arena, &models[*byte], 256);
}

static void next_attributes(brio_laz_point10 *p, brio_laz_coder *c, brio_laz_arena *arena, uint32_t changed,
                            uint32_t returns) {
    uint8_t *last = p->last;
    if (changed & BRIO_LAZ_INTENSITY_CHANGED)
        p->intensities[returns] =
            brio_laz_int16(c, arena, &p->intensity, p->intensities[returns], returns < 3 ? returns : 3);
    brio_put_le16(last + 12, p->intensities[returns]);
    if (changed & BRIO_LAZ_CLASS_CHANGED) next_byte(c, arena, p->classification, last + 15);
    if (changed & BRIO_LAZ_ANGLE_CHANGED) {
        uint32_t direction = last[14] >> 6 & 1;
        last[16] = (uint8_t)(last[16] + brio_laz_symbol(c, arena, &p->scan_angle[direction], 256));
    }
    if (changed & BRIO_LAZ_USER_DATA_CHANGED) next_byte(c, arena, p->user_data, last + 17);
    if (changed & BRIO_LAZ_SOURCE_CHANGED)
        brio_put_le16(last + 18, brio_laz_int16(c, arena, &p->source, brio_le16(last + 18), 0));
}

static uint32_t at_most(uint32_t bits, uint32_t most) {
    return bits < most ? bits & ~1u : most;
}

static void next_position(brio_laz_point10 *p, brio_laz_coder *c, brio_laz_arena *arena, uint32_t returns) {
    uint32_t n = p->last[14] >> 3 & 7, r = p->last[14] & 7, level = n > r ? n - r : r - n, single = n == 1;
    int32_t step = brio_laz_int32(c, arena, &p->dx, brio_laz_median_of(&p->x[returns]), single);
    p->position[0] = (int32_t)((uint32_t)p->position[0] + (uint32_t)step);
    brio_laz_median_add(&p->x[returns], step);
    step = brio_laz_int32(c, arena, &p->dy, brio_laz_median_of(&p->y[returns]), single + at_most(p->dx.k, 20));
    p->position[1] = (int32_t)((uint32_t)p->position[1] + (uint32_t)step);
    brio_laz_median_add(&p->y[returns], step);
    uint32_t context = single + at_most((p->dx.k + p->dy.k) / 2, 18);
    p->position[2] = p->heights[level] = brio_laz_int32(c, arena, &p->z, p->heights[level], context);
}

void brio_laz_point10_next(brio_laz_point10 *p, brio_laz_coder *c, brio_laz_arena *arena, uint8_t *row) {
    uint32_t changed = brio_laz_symbol(c, arena, &p->changed, 64);
    if (changed & BRIO_LAZ_FLAGS_CHANGED) next_byte(c, arena, p->flags, p->last + 14);
    uint32_t returns = laz_return_context10(p->last[14]);
    if (changed) next_attributes(p, c, arena, changed, returns);
    next_position(p, c, arena, returns);
    memcpy(row, p->last, sizeof p->last);
    for (int i = 0; i < 3; i++) brio_put_le32(row + 4 * i, (uint32_t)p->position[i]);
}

/* --- times --- */

/* Compressed times of points.
 *
 * Points of several flight lines alternate: four sequences are kept. Within a sequence times grow by multiples of a
 * step, and most symbols are such a multiple. The step is replaced after four extreme multiples one after the other. */

enum { SMALL = 10, EXTREMES = 3 };

void brio_laz_time_begin(brio_laz_time *t, uint64_t first) {
    t->times[0] = first;
}

static void add(brio_laz_time *t, int32_t difference) {
    t->times[t->last] += (uint64_t)(int64_t)difference;
}

/* Decodes a time that has nothing to do with the step, and begins a sequence with it. */
static void next_sequence(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena) {
    int32_t high = brio_laz_int32(c, arena, &t->difference, (int32_t)(t->times[t->last] >> 32), BRIO_LAZ_FROM_TIME);
    t->next = (t->next + 1) & 3;
    t->last = t->next;
    t->times[t->last] = (uint64_t)(uint32_t)high << 32 | brio_laz_bits(c, 32);
    t->steps[t->last] = 0;
    t->extremes[t->last] = 0;
}

/* Returns the context of the difference to a multiple, by its symbol. */
static uint32_t laz_steps_context(uint32_t symbol) {
    static const struct {
        uint32_t last, context;
    } kinds[] = {{0, BRIO_LAZ_FROM_NOTHING},
                 {1, BRIO_LAZ_FROM_STEP},
                 {SMALL - 1, BRIO_LAZ_FROM_SMALL},
                 {BRIO_LAZ_MOST_STEPS - 1, BRIO_LAZ_FROM_LARGE},
                 {BRIO_LAZ_MOST_STEPS, BRIO_LAZ_FROM_MOST},
                 {BRIO_LAZ_MOST_STEPS - BRIO_LAZ_LEAST_STEPS - 1, BRIO_LAZ_FROM_NEGATIVE},
                 {BRIO_LAZ_MOST_STEPS - BRIO_LAZ_LEAST_STEPS, BRIO_LAZ_FROM_LEAST}};
    int kind = 0;
    while (kinds[kind].last < symbol) kind++;
    return kinds[kind].context;
}

/* Replaces the step after several extreme multiples one after the other. */
static void laz_time_step(brio_laz_time *t, int32_t difference, uint32_t context) {
    if (context == BRIO_LAZ_FROM_STEP) t->extremes[t->last] = 0;
    if (context != BRIO_LAZ_FROM_NOTHING && context != BRIO_LAZ_FROM_MOST && context != BRIO_LAZ_FROM_LEAST) return;
    if (++t->extremes[t->last] > EXTREMES) {
        t->steps[t->last] = difference;
        t->extremes[t->last] = 0;
    }
}

/* Decodes a time that differs from the last one by about a multiple of the step. */
static void next_multiple(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t symbol) {
    uint32_t context = laz_steps_context(symbol);
    int32_t multiple = symbol <= BRIO_LAZ_MOST_STEPS ? (int32_t)symbol : BRIO_LAZ_MOST_STEPS - (int32_t)symbol;
    uint32_t predicted = (uint32_t)multiple * (uint32_t)t->steps[t->last];
    int32_t difference = brio_laz_int32(c, arena, &t->difference, (int32_t)predicted, context);
    add(t, difference);
    laz_time_step(t, difference, context);
}

/* Decodes a time of a sequence that has no step yet, or goes to another sequence. Returns whether it did the
 * latter. */
static bool next_without_step(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t may_stay) {
    uint32_t symbol = brio_laz_symbol(c, arena, &t->first, 5 + may_stay);
    if (symbol < may_stay) return false;
    symbol -= may_stay;
    if (symbol == 0) {
        t->steps[t->last] = brio_laz_int32(c, arena, &t->difference, 0, BRIO_LAZ_FROM_ZERO);
        t->extremes[t->last] = 0;
        add(t, t->steps[t->last]);
    } else if (symbol == 1) {
        next_sequence(t, c, arena);
    } else {
        t->last = (t->last + symbol - 1) & 3;
    }
    return symbol > 1;
}

static bool next_with_step(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t may_stay) {
    uint32_t symbol = brio_laz_symbol(c, arena, &t->multiple, BRIO_LAZ_NEW_TIME + 4 + may_stay);
    if (symbol < BRIO_LAZ_NEW_TIME) {
        next_multiple(t, c, arena, symbol);
        return false;
    }
    if (symbol < BRIO_LAZ_NEW_TIME + may_stay) return false;
    symbol -= BRIO_LAZ_NEW_TIME + may_stay;
    if (symbol == 0)
        next_sequence(t, c, arena);
    else
        t->last = (t->last + symbol) & 3;
    return symbol > 0;
}

/* Decodes a time. The loop ends in damaged data, too: behind the bytes every symbol becomes 0, which is none of another
 * sequence. */
uint64_t brio_laz_time_next(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t may_stay) {
    while (t->steps[t->last] ? next_with_step(t, c, arena, may_stay) : next_without_step(t, c, arena, may_stay))
        if (c->past) break;
    return t->times[t->last];
}

/* --- colours --- */

/* Compressed colours: bytes that changed, green and blue predicted by the change of red. */

enum { ALL_EQUAL_NOT = 1 << 6 /* green or blue differ from red */ };

static int clamped(int x) {
    return x < 0 ? 0 : x > 255 ? 255 : x;
}

/* Decodes a byte that changed, or returns the last one. */
static int next_colour_byte(brio_laz_coder *c, brio_laz_arena *arena, brio_laz_model *m, bool changed, int last,
                            int predicted) {
    return changed ? (int)((uint32_t)predicted + brio_laz_symbol(c, arena, m, 256)) & 255 : last;
}

void brio_laz_colour_next(brio_laz_colour_models *m, brio_laz_coder *c, brio_laz_arena *arena, uint16_t last[3]) {
    uint32_t used = brio_laz_symbol(c, arena, &m->used, 128);
    int bytes[3][2] = {{0}};
    for (int half = 0; half < 2; half++) {
        int old = last[0] >> 8 * half & 255;
        bytes[0][half] = next_colour_byte(c, arena, &m->differences[half], used >> half & 1, old, old);
        bytes[1][half] = bytes[2][half] = bytes[0][half];
    }
    for (int half = 0; half < 2 && used & ALL_EQUAL_NOT; half++) {
        int red = last[0] >> 8 * half & 255, green = last[1] >> 8 * half & 255, blue = last[2] >> 8 * half & 255;
        int step = bytes[0][half] - red;
        bytes[1][half] =
            next_colour_byte(c, arena, &m->differences[2 + half], used >> (2 + half) & 1, green, clamped(green + step));
        step = (step + bytes[1][half] - green) / 2;
        bytes[2][half] =
            next_colour_byte(c, arena, &m->differences[4 + half], used >> (4 + half) & 1, blue, clamped(blue + step));
    }
    for (int i = 0; i < 3; i++) last[i] = (uint16_t)(bytes[i][0] | bytes[i][1] << 8);
}

void brio_laz_infrared_next(brio_laz_infrared_models *m, brio_laz_coder *c, brio_laz_arena *arena, uint16_t *last) {
    uint32_t used = brio_laz_symbol(c, arena, &m->used, 4);
    int value = 0;
    for (int half = 0; half < 2; half++) {
        int old = *last >> 8 * half & 255;
        value |= next_colour_byte(c, arena, &m->differences[half], used >> half & 1, old, old) << 8 * half;
    }
    *last = (uint16_t)value;
}

/* --- the same, encoded --- */

/* Encodes the items of records of formats 0 to 3, and times, colours and near infrared of all formats. Each function is
 * the counterpart of the one above that decodes. */

/* --- points of formats 0 to 5, encoded --- */

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
    uint32_t returns = laz_return_context10(row[14]);
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

/* --- times, encoded --- */

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
    uint32_t predicted = (uint32_t)multiple * (uint32_t)t->steps[t->last], context = laz_steps_context(symbol);
    brio_laz_put_symbol(pen, arena, &t->multiple, symbols, symbol);
    brio_laz_put_int32(pen, arena, &t->difference, (int32_t)predicted, difference, context);
    laz_time_step(t, difference, context);
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

/* --- colours, encoded --- */

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
