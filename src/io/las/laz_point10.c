/* Compressed points of LAS formats 0 to 5.
 *
 * The first symbol says which of six attributes changed. Steps in x and y are predicted by the median of the last steps
 * of points with the same return, heights by the last height of the same return, each with models that depend on how
 * large the other steps were. */
#include "io/las/laz_items.h"
#include "io/little_endian.h"

/* The context of a return: by the number of returns and the number of this one. Pairs that no scanner makes, which are
 * in files all the same, have contexts, too. */
static const uint8_t return_context[8][8] = {{15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},
                                             {13, 1, 2, 4, 7, 11, 11, 10},    {12, 3, 4, 5, 8, 12, 12, 11},
                                             {11, 6, 7, 8, 9, 13, 13, 12},    {10, 10, 11, 12, 13, 14, 14, 13},
                                             {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15}};

uint32_t brio_laz_return_context10(uint8_t flags) {
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
    uint32_t returns = brio_laz_return_context10(p->last[14]);
    if (changed) next_attributes(p, c, arena, changed, returns);
    next_position(p, c, arena, returns);
    memcpy(row, p->last, sizeof p->last);
    for (int i = 0; i < 3; i++) brio_put_le32(row + 4 * i, (uint32_t)p->position[i]);
}
