/* The entropy decoder of LAZ files: an arithmetic decoder, and adaptive models of symbols, bits and integers.
 *
 * The decoder never reads behind its bytes: behind them it takes zeros and sets `past`. A symbol is always below the
 * model's number of symbols, whatever the bytes are, so damaged data give wrong numbers but no wrong address.
 *
 * A model is made when it is first used, in the arena of its decoder: a chunk of points uses few of the thousands of
 * models that the format has. A model whose bytes are all 0 is not made yet.
 *
 * Based on: Isenburg. LASzip: lossless compression of LiDAR data. Photogrammetric Engineering and Remote Sensing 79,
 * 2013. Said. Introduction to arithmetic coding: theory and practice. HP Labs 2004. */
#ifndef BRIO_IO_LAZ_MODEL_H
#define BRIO_IO_LAZ_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bits of a probability, as the format has them: of symbols and of single bits. */
enum { BRIO_LAZ_SYMBOL_BITS = 15, BRIO_LAZ_BIT_BITS = 13 };

typedef struct brio_laz_coder {
    const uint8_t *at, *end;
    uint32_t value, length; /* value < length, which keeps symbols below their number */
    bool past;              /* whether bytes were missing, or a number was impossible */
} brio_laz_coder;

/** Room for the tables of models. The caller gives enough of it: see brio_laz_model_bytes. */
typedef struct brio_laz_arena {
    char *memory;
    size_t used, size;
} brio_laz_arena;

typedef struct brio_laz_model {
    uint16_t *cumulative; /* for each symbol, 2^15 times the probability of a smaller one; NULL: not made yet */
    uint16_t *counts;     /* for each symbol */
    uint16_t *table; /* the symbol to begin the search with, by the probability's upper bits; NULL for few symbols */
    uint32_t symbols, total;
    uint32_t cycle, until; /* symbols between two updates, and until the next one */
    uint32_t shift;        /* from a probability to its place in the table */
} brio_laz_model;

typedef struct brio_laz_bit {
    uint32_t zero, count, zeros, cycle, until; /* zero: 2^13 times the probability of a 0 */
} brio_laz_bit;

/** Integers: the model of the number of bits k of the difference to the prediction depends on a context, the models of
 *  the difference on k. */
enum { BRIO_LAZ_CONTEXTS = 22, BRIO_LAZ_WHOLE = 8 /* bits of a difference that are modelled; the others are raw */ };
typedef struct brio_laz_integer {
    brio_laz_model bits[BRIO_LAZ_CONTEXTS];
    brio_laz_model difference[33];
    brio_laz_bit one;
    uint32_t k; /* the bits of the last difference */
} brio_laz_integer;

/** Returns a bound of the arena's bytes that a model takes. */
static inline size_t brio_laz_model_bytes(size_t symbols) {
    return 5 * symbols + 48;
}
/** Returns a bound of the arena's bytes that an integer of 16 or 32 bits takes. */
static inline size_t brio_laz_integer_bytes(unsigned width) {
    return BRIO_LAZ_CONTEXTS * brio_laz_model_bytes(33) + width * brio_laz_model_bytes(256);
}

/** Makes a model in which all symbols are equally probable.   symbols  2 to 2048. */
void brio_laz_model_make(brio_laz_arena *arena, brio_laz_model *m, uint32_t symbols);
void brio_laz_bit_make(brio_laz_bit *b);

/** Compute the probabilities from the counts. */
void brio_laz_model_update(brio_laz_model *m);
void brio_laz_bit_update(brio_laz_bit *b);

static inline uint8_t brio_laz_byte(brio_laz_coder *c) {
    if (__builtin_expect(c->at < c->end, 1)) return *c->at++;
    c->past = true;
    return 0;
}

/** Begins to decode bytes. Four bytes of ones would be a value that is not below the length: no encoder writes them. */
static inline void brio_laz_coder_begin(brio_laz_coder *c, const uint8_t *bytes, const uint8_t *end) {
    *c = (brio_laz_coder){.at = bytes, .end = end, .length = UINT32_MAX};
    for (int i = 0; i < 4; i++) c->value = c->value << 8 | brio_laz_byte(c);
    if (c->value < c->length) return;
    c->past = true;
    c->value = 0;
}

static inline void brio_laz_renew(brio_laz_coder *c) {
    while (c->length < 1u << 24) {
        c->value = c->value << 8 | brio_laz_byte(c);
        c->length <<= 8;
    }
}

/* Finds the last symbol whose interval does not begin behind the value, by bisection in [low, high). */
static inline uint32_t brio_laz_search(const brio_laz_model *m, uint32_t low, uint32_t high, uint32_t value,
                                       uint32_t unit) {
    while (high - low > 1) {
        uint32_t middle = (low + high) / 2;
        if (m->cumulative[middle] * unit > value)
            high = middle;
        else
            low = middle;
    }
    return low;
}

/** Decodes a symbol of a model that is made. */
static inline uint32_t brio_laz_symbol_of(brio_laz_coder *c, brio_laz_model *m) {
    uint32_t unit = c->length >> BRIO_LAZ_SYMBOL_BITS, low = 0, high = m->symbols;
    if (m->table) {
        uint32_t place = c->value / unit >> m->shift;
        low = m->table[place];
        high = m->table[place + 1] + 1u;
    }
    uint32_t symbol = brio_laz_search(m, low, high, c->value, unit), begin = m->cumulative[symbol] * unit;
    c->length = (symbol + 1 < m->symbols ? m->cumulative[symbol + 1] * unit : c->length) - begin;
    c->value -= begin;
    brio_laz_renew(c);
    m->counts[symbol]++;
    if (--m->until == 0) brio_laz_model_update(m);
    return symbol;
}

/** Decodes a symbol. Makes the model if this is its first use. */
static inline uint32_t brio_laz_symbol(brio_laz_coder *c, brio_laz_arena *arena, brio_laz_model *m, uint32_t symbols) {
    if (__builtin_expect(!m->cumulative, 0)) brio_laz_model_make(arena, m, symbols);
    return brio_laz_symbol_of(c, m);
}

static inline uint32_t brio_laz_bit_of(brio_laz_coder *c, brio_laz_bit *b) {
    if (!b->count) brio_laz_bit_make(b);
    uint32_t border = b->zero * (c->length >> BRIO_LAZ_BIT_BITS), bit = c->value >= border;
    if (bit) {
        c->value -= border;
        c->length -= border;
    } else {
        c->length = border;
        b->zeros++;
    }
    brio_laz_renew(c);
    if (--b->until == 0) brio_laz_bit_update(b);
    return bit;
}

/** Decodes 1 to 19 bits that are equally probable. */
static inline uint32_t brio_laz_few_bits(brio_laz_coder *c, uint32_t bits) {
    c->length >>= bits;
    uint32_t number = c->value / c->length;
    c->value -= number * c->length;
    brio_laz_renew(c);
    if (number >> bits) c->past = true;
    return number & ((1u << bits) - 1);
}

/** Decodes 1 to 32 such bits. */
static inline uint32_t brio_laz_bits(brio_laz_coder *c, uint32_t bits) {
    if (bits <= 19) return brio_laz_few_bits(c, bits);
    uint32_t low = brio_laz_few_bits(c, 16);
    return low | brio_laz_few_bits(c, bits - 16) << 16;
}

/** Decodes the difference of an integer of `width` bits to its prediction. */
static inline uint32_t brio_laz_difference(brio_laz_coder *c, brio_laz_arena *arena, brio_laz_integer *n,
                                           uint32_t width, uint32_t context) {
    uint32_t k = n->k = brio_laz_symbol(c, arena, &n->bits[context], width + 1), d;
    if (k == 0) return brio_laz_bit_of(c, &n->one);
    if (k == 32) return 1u << 31;
    if (k <= BRIO_LAZ_WHOLE) {
        d = brio_laz_symbol(c, arena, &n->difference[k], 1u << k);
    } else {
        d = brio_laz_symbol(c, arena, &n->difference[k], 1u << BRIO_LAZ_WHOLE) << (k - BRIO_LAZ_WHOLE);
        d |= brio_laz_bits(c, k - BRIO_LAZ_WHOLE);
    }
    /* [0, 2^k) stands for [1 - 2^k, -2^(k-1)] and [2^(k-1) + 1, 2^k] */
    return d >> (k - 1) ? d + 1 : d - ((1u << k) - 1);
}

/** Decodes an integer. Sums wrap, as in the format. */
static inline int32_t brio_laz_int32(brio_laz_coder *c, brio_laz_arena *arena, brio_laz_integer *n, int32_t predicted,
                                     uint32_t context) {
    return (int32_t)((uint32_t)predicted + brio_laz_difference(c, arena, n, 32, context));
}
static inline uint16_t brio_laz_int16(brio_laz_coder *c, brio_laz_arena *arena, brio_laz_integer *n, uint32_t predicted,
                                      uint32_t context) {
    return (uint16_t)(predicted + brio_laz_difference(c, arena, n, 16, context));
}

#endif
