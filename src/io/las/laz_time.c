/* Compressed times of points.
 *
 * Points of several flight lines alternate: four sequences are kept. Within a sequence times grow by multiples of a
 * step, and most symbols are such a multiple. The step is replaced after four extreme multiples one after the other. */
#include "io/las/laz_items.h"

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

uint32_t brio_laz_steps_context(uint32_t symbol) {
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

void brio_laz_time_step(brio_laz_time *t, int32_t difference, uint32_t context) {
    if (context == BRIO_LAZ_FROM_STEP) t->extremes[t->last] = 0;
    if (context != BRIO_LAZ_FROM_NOTHING && context != BRIO_LAZ_FROM_MOST && context != BRIO_LAZ_FROM_LEAST) return;
    if (++t->extremes[t->last] > EXTREMES) {
        t->steps[t->last] = difference;
        t->extremes[t->last] = 0;
    }
}

/* Decodes a time that differs from the last one by about a multiple of the step. */
static void next_multiple(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t symbol) {
    uint32_t context = brio_laz_steps_context(symbol);
    int32_t multiple = symbol <= BRIO_LAZ_MOST_STEPS ? (int32_t)symbol : BRIO_LAZ_MOST_STEPS - (int32_t)symbol;
    uint32_t predicted = (uint32_t)multiple * (uint32_t)t->steps[t->last];
    int32_t difference = brio_laz_int32(c, arena, &t->difference, (int32_t)predicted, context);
    add(t, difference);
    brio_laz_time_step(t, difference, context);
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

/* The loop ends in damaged data, too: behind the bytes every symbol becomes 0, which is none of another sequence. */
uint64_t brio_laz_time_next(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t may_stay) {
    while (t->steps[t->last] ? next_with_step(t, c, arena, may_stay) : next_without_step(t, c, arena, may_stay))
        if (c->past) break;
    return t->times[t->last];
}
