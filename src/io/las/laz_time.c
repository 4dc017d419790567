/* Compressed times of points.
 *
 * Points of several flight lines alternate: four sequences are kept. Within a sequence times grow by multiples of a
 * step, and most symbols are such a multiple. The step is replaced after four extreme multiples one after the other. */
#include "io/las/laz_items.h"

/* Symbols of a multiple: 0 something else than a multiple, 1 to MOST the multiple, above MOST negative ones down to
 * LEAST. Behind these come the symbols of a new time and of the other sequences. */
enum { MOST = 500, LEAST = -10, NEW = MOST - LEAST + 1, SMALL = 10, EXTREMES = 3 };

/* Contexts of the difference. */
enum { FROM_ZERO, FROM_STEP, FROM_SMALL, FROM_LARGE, FROM_MOST, FROM_NEGATIVE, FROM_LEAST, FROM_NOTHING, FROM_TIME };

void brio_laz_time_begin(brio_laz_time *t, uint64_t first) {
    t->times[0] = first;
}

static void add(brio_laz_time *t, int32_t difference) {
    t->times[t->last] += (uint64_t)(int64_t)difference;
}

/* Decodes a time that has nothing to do with the step, and begins a sequence with it. */
static void next_sequence(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena) {
    int32_t high = brio_laz_int32(c, arena, &t->difference, (int32_t)(t->times[t->last] >> 32), FROM_TIME);
    t->next = (t->next + 1) & 3;
    t->last = t->next;
    t->times[t->last] = (uint64_t)(uint32_t)high << 32 | brio_laz_bits(c, 32);
    t->steps[t->last] = 0;
    t->extremes[t->last] = 0;
}

/* Decodes a time that differs from the last one by about a multiple of the step. */
static void next_multiple(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t symbol) {
    static const struct {
        int32_t last;
        uint32_t context;
    } kinds[] = {{0, FROM_NOTHING},         {1, FROM_STEP},    {SMALL - 1, FROM_SMALL},
                 {MOST - 1, FROM_LARGE},    {MOST, FROM_MOST}, {MOST - LEAST - 1, FROM_NEGATIVE},
                 {MOST - LEAST, FROM_LEAST}};
    int kind = 0;
    while (kinds[kind].last < (int32_t)symbol) kind++;
    uint32_t context = kinds[kind].context;
    int32_t multiple = symbol <= MOST ? (int32_t)symbol : MOST - (int32_t)symbol;
    uint32_t predicted = (uint32_t)multiple * (uint32_t)t->steps[t->last];
    int32_t difference = brio_laz_int32(c, arena, &t->difference, (int32_t)predicted, context);
    add(t, difference);
    if (context == FROM_STEP) t->extremes[t->last] = 0;
    if (context != FROM_NOTHING && context != FROM_MOST && context != FROM_LEAST) return;
    if (++t->extremes[t->last] > EXTREMES) {
        t->steps[t->last] = difference;
        t->extremes[t->last] = 0;
    }
}

/* Decodes a time of a sequence that has no step yet, or goes to another sequence. Returns whether it did the
 * latter. */
static bool next_without_step(brio_laz_time *t, brio_laz_coder *c, brio_laz_arena *arena, uint32_t may_stay) {
    uint32_t symbol = brio_laz_symbol(c, arena, &t->first, 5 + may_stay);
    if (symbol < may_stay) return false;
    symbol -= may_stay;
    if (symbol == 0) {
        t->steps[t->last] = brio_laz_int32(c, arena, &t->difference, 0, FROM_ZERO);
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
    uint32_t symbol = brio_laz_symbol(c, arena, &t->multiple, NEW + 4 + may_stay);
    if (symbol < NEW) {
        next_multiple(t, c, arena, symbol);
        return false;
    }
    if (symbol < NEW + may_stay) return false;
    symbol -= NEW + may_stay;
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
