/* Compressed colours: bytes that changed, green and blue predicted by the change of red. */
#include "io/las/laz_items.h"

enum { ALL_EQUAL_NOT = 1 << 6 /* green or blue differ from red */ };

static int clamped(int x) {
    return x < 0 ? 0 : x > 255 ? 255 : x;
}

/* Decodes a byte that changed, or returns the last one. */
static int next_byte(brio_laz_coder *c, brio_laz_arena *arena, brio_laz_model *m, bool changed, int last,
                     int predicted) {
    return changed ? (int)((uint32_t)predicted + brio_laz_symbol(c, arena, m, 256)) & 255 : last;
}

void brio_laz_colour_next(brio_laz_colour_models *m, brio_laz_coder *c, brio_laz_arena *arena, uint16_t last[3]) {
    uint32_t used = brio_laz_symbol(c, arena, &m->used, 128);
    int bytes[3][2] = {{0}};
    for (int half = 0; half < 2; half++) {
        int old = last[0] >> 8 * half & 255;
        bytes[0][half] = next_byte(c, arena, &m->differences[half], used >> half & 1, old, old);
        bytes[1][half] = bytes[2][half] = bytes[0][half];
    }
    for (int half = 0; half < 2 && used & ALL_EQUAL_NOT; half++) {
        int red = last[0] >> 8 * half & 255, green = last[1] >> 8 * half & 255, blue = last[2] >> 8 * half & 255;
        int step = bytes[0][half] - red;
        bytes[1][half] =
            next_byte(c, arena, &m->differences[2 + half], used >> (2 + half) & 1, green, clamped(green + step));
        step = (step + bytes[1][half] - green) / 2;
        bytes[2][half] =
            next_byte(c, arena, &m->differences[4 + half], used >> (4 + half) & 1, blue, clamped(blue + step));
    }
    for (int i = 0; i < 3; i++) last[i] = (uint16_t)(bytes[i][0] | bytes[i][1] << 8);
}

void brio_laz_infrared_next(brio_laz_infrared_models *m, brio_laz_coder *c, brio_laz_arena *arena, uint16_t *last) {
    uint32_t used = brio_laz_symbol(c, arena, &m->used, 4);
    int value = 0;
    for (int half = 0; half < 2; half++) {
        int old = *last >> 8 * half & 255;
        value |= next_byte(c, arena, &m->differences[half], used >> half & 1, old, old) << 8 * half;
    }
    *last = (uint16_t)value;
}
