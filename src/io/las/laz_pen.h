/* The entropy encoder of LAZ files: the counterpart of the decoder in laz_model.h, with the same models.
 *
 * A pen writes into memory that its owner has made large enough: a symbol takes at most BRIO_LAZ_SYMBOL_BITS bits and
 * what rounding adds, so 2 bytes; an integer two symbols and its raw bits, so 8.
 *
 * Based on: Isenburg. LASzip: lossless compression of LiDAR data. Photogrammetric Engineering and Remote Sensing 79,
 * 2013. Said. Introduction to arithmetic coding: theory and practice. HP Labs 2004. */
#ifndef BRIO_IO_LAZ_PEN_H
#define BRIO_IO_LAZ_PEN_H

#include "io/las/laz_model.h"

/** Bytes of a symbol and of an integer of 32 or 16 bits, at most; and what a pen adds at its end. */
enum { BRIO_LAZ_SYMBOL_BYTES = 2, BRIO_LAZ_INTEGER_BYTES = 8, BRIO_LAZ_END_BYTES = 8 };

typedef struct brio_laz_pen {
    uint8_t *begin, *at;
    uint32_t base, length;
    bool differs; /* a layer: whether a value differs from the one before; otherwise the layer is left out */
} brio_laz_pen;

static inline void brio_laz_pen_begin(brio_laz_pen *p, uint8_t *bytes) {
    *p = (brio_laz_pen){.begin = bytes, .at = bytes, .length = UINT32_MAX};
}

/** Adds to the base. A sum over 32 bits is carried into the bytes that were written. */
static inline void brio_laz_pen_add(brio_laz_pen *p, uint32_t add) {
    p->base += add;
    if (p->base >= add) return;
    uint8_t *at = p->at;
    while (*--at == 0xff) *at = 0;
    ++*at;
}

static inline void brio_laz_pen_renew(brio_laz_pen *p) {
    while (p->length < 1u << 24) {
        *p->at++ = (uint8_t)(p->base >> 24);
        p->base <<= 8;
        p->length <<= 8;
    }
}

/** Encodes a symbol. Makes the model if this is its first use. */
static inline void brio_laz_put_symbol(brio_laz_pen *p, brio_laz_arena *arena, brio_laz_model *m, uint32_t symbols,
                                       uint32_t symbol) {
    if (__builtin_expect(!m->cumulative, 0)) brio_laz_model_make(arena, m, symbols);
    uint32_t unit = p->length >> BRIO_LAZ_SYMBOL_BITS, begin = m->cumulative[symbol] * unit;
    p->length = (symbol + 1 < m->symbols ? m->cumulative[symbol + 1] * unit : p->length) - begin;
    brio_laz_pen_add(p, begin);
    brio_laz_pen_renew(p);
    m->counts[symbol]++;
    if (--m->until == 0) brio_laz_model_update(m);
}

static inline void brio_laz_put_bit(brio_laz_pen *p, brio_laz_bit *b, uint32_t bit) {
    if (!b->count) brio_laz_bit_make(b);
    uint32_t border = b->zero * (p->length >> BRIO_LAZ_BIT_BITS);
    if (bit) {
        p->length -= border;
        brio_laz_pen_add(p, border);
    } else {
        p->length = border;
        b->zeros++;
    }
    brio_laz_pen_renew(p);
    if (--b->until == 0) brio_laz_bit_update(b);
}

/** Encodes 1 to 19 bits that are equally probable. */
static inline void brio_laz_put_few_bits(brio_laz_pen *p, uint32_t bits, uint32_t number) {
    p->length >>= bits;
    brio_laz_pen_add(p, number * p->length);
    brio_laz_pen_renew(p);
}

/** Encodes 1 to 32 such bits. */
static inline void brio_laz_put_bits(brio_laz_pen *p, uint32_t bits, uint32_t number) {
    if (bits > 19) {
        brio_laz_put_few_bits(p, 16, number & 0xffff);
        number >>= 16;
        bits -= 16;
    }
    brio_laz_put_few_bits(p, bits, number);
}

/** Encodes the difference of an integer of `width` bits to its prediction. */
static inline void brio_laz_put_difference(brio_laz_pen *p, brio_laz_arena *arena, brio_laz_integer *n, uint32_t width,
                                           uint32_t context, int32_t d) {
    uint32_t size = d <= 0 ? -(uint32_t)d : (uint32_t)d - 1, k = 0;
    while (k < 32 && size >> k) k++;
    n->k = k;
    brio_laz_put_symbol(p, arena, &n->bits[context], width + 1, k);
    if (k == 0) brio_laz_put_bit(p, &n->one, (uint32_t)d);
    if (k == 0 || k == 32) return;
    uint32_t place = d < 0 ? (uint32_t)d + ((1u << k) - 1) : (uint32_t)d - 1;
    if (k <= BRIO_LAZ_WHOLE) {
        brio_laz_put_symbol(p, arena, &n->difference[k], 1u << k, place);
        return;
    }
    uint32_t rest = k - BRIO_LAZ_WHOLE;
    brio_laz_put_symbol(p, arena, &n->difference[k], 1u << BRIO_LAZ_WHOLE, place >> rest);
    brio_laz_put_bits(p, rest, place & ((1u << rest) - 1));
}

/** Encode an integer. Differences wrap, as in the format. */
static inline void brio_laz_put_int32(brio_laz_pen *p, brio_laz_arena *arena, brio_laz_integer *n, int32_t predicted,
                                      int32_t x, uint32_t context) {
    brio_laz_put_difference(p, arena, n, 32, context, (int32_t)((uint32_t)x - (uint32_t)predicted));
}
static inline void brio_laz_put_int16(brio_laz_pen *p, brio_laz_arena *arena, brio_laz_integer *n, uint16_t predicted,
                                      uint16_t x, uint32_t context) {
    brio_laz_put_difference(p, arena, n, 16, context, (int16_t)(uint16_t)(x - predicted));
}

/** Ends the bytes: any number of the last interval, and the zeros that the decoder reads ahead. Returns how many they
 *  are. */
static inline size_t brio_laz_pen_end(brio_laz_pen *p) {
    bool longer = p->length > 2u << 24;
    brio_laz_pen_add(p, longer ? 1u << 24 : 1u << 23);
    p->length = longer ? 1u << 23 : 1u << 15;
    brio_laz_pen_renew(p);
    for (int i = 0; i < 2 + longer; i++) *p->at++ = 0;
    return (size_t)(p->at - p->begin);
}

#endif
