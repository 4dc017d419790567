/* Adaptive models of LAZ files: how counts become probabilities.
 *
 * Counts are kept below 2^15 by halving. The decoder must update at the same symbols as the encoder did, and round in
 * the same way: cycles, limits and divisions are those of the format. */
#include "io/las/laz_model.h"
#include <assert.h>
#include <string.h>

enum { FEW = 16 /* symbols that need no table */, MOST_COUNTS = 1 << BRIO_LAZ_SYMBOL_BITS };

static uint32_t table_bits(uint32_t symbols) {
    uint32_t bits = 3;
    while (symbols > 1u << (bits + 2)) bits++;
    return bits;
}

void brio_laz_model_make(brio_laz_arena *arena, brio_laz_model *m, uint32_t symbols) {
    uint32_t bits = table_bits(symbols);
    size_t entries = symbols > FEW ? (1u << bits) + 2 : 0;
    size_t bytes = ((2 * symbols + entries) * sizeof *m->cumulative + 15) / 16 * 16;
    assert(symbols >= 2 && arena->used + bytes <= arena->size);
    m->cumulative = (uint16_t *)(void *)(arena->memory + arena->used);
    m->counts = m->cumulative + symbols;
    m->table = entries ? m->counts + symbols : NULL;
    arena->used += bytes;
    m->symbols = symbols;
    m->shift = BRIO_LAZ_SYMBOL_BITS - bits;
    m->total = 0;
    m->cycle = symbols;
    for (uint32_t i = 0; i < symbols; i++) m->counts[i] = 1;
    brio_laz_model_update(m);
    m->until = m->cycle = (symbols + 6) / 2;
}

static void halve(brio_laz_model *m) {
    m->total = 0;
    for (uint32_t i = 0; i < m->symbols; i++) {
        m->counts[i] = (uint16_t)((m->counts[i] + 1) / 2);
        m->total += m->counts[i];
    }
}

/* Fills the table of symbols. Entry i + 1 is the last symbol that begins before i + 1 steps of the table; entry 0 is
 * 0. */
static void fill_table(brio_laz_model *m) {
    uint32_t filled = 0, size = 1u << (BRIO_LAZ_SYMBOL_BITS - m->shift);
    for (uint32_t i = 0; i < m->symbols; i++)
        for (uint32_t place = m->cumulative[i] >> m->shift; filled < place;) m->table[++filled] = (uint16_t)(i - 1);
    m->table[0] = 0;
    while (filled <= size) m->table[++filled] = (uint16_t)(m->symbols - 1);
}

void brio_laz_model_update(brio_laz_model *m) {
    m->total += m->cycle;
    if (m->total > MOST_COUNTS) halve(m);
    uint32_t scale = (1u << 31) / m->total, sum = 0;
    for (uint32_t i = 0; i < m->symbols; i++) {
        m->cumulative[i] = (uint16_t)(scale * sum >> (31 - BRIO_LAZ_SYMBOL_BITS));
        sum += m->counts[i];
    }
    if (m->table) fill_table(m);
    uint32_t most = 8 * (m->symbols + 6);
    m->cycle = 5 * m->cycle / 4;
    if (m->cycle > most) m->cycle = most;
    m->until = m->cycle;
}

void brio_laz_bit_make(brio_laz_bit *b) {
    *b = (brio_laz_bit){.zero = 1u << (BRIO_LAZ_BIT_BITS - 1), .count = 2, .zeros = 1, .cycle = 4, .until = 4};
}

void brio_laz_bit_update(brio_laz_bit *b) {
    b->count += b->cycle;
    if (b->count > 1u << BRIO_LAZ_BIT_BITS) {
        b->count = (b->count + 1) / 2;
        b->zeros = (b->zeros + 1) / 2;
        if (b->zeros == b->count) b->count++;
    }
    b->zero = b->zeros * ((1u << 31) / b->count) >> (31 - BRIO_LAZ_BIT_BITS);
    b->cycle = 5 * b->cycle / 4;
    if (b->cycle > 64) b->cycle = 64;
    b->until = b->cycle;
}
