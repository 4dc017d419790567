/* Blocks of a page: bytes, compressed where zlib is there, as base 64 in an element of the page.
 *
 * A column is a sequence of numbers in a block: plane by plane, first the lowest byte of every number, last the highest
 * one. So the bytes that hardly change stand together and pack well. Before that each number is replaced by how it
 * differs from the one before it (brio_page_mode). */
#ifndef BRIO_PAGE_BLOCK_H
#define BRIO_PAGE_BLOCK_H

#include "io/output.h"

typedef struct brio_page_block brio_page_block;

/** Begins a block.   layer, name  how the page's program finds it: which layer, and what of it.
 *  Call brio_page_block_free even if this fails. */
brio_status brio_page_block_begin(brio_page_block **b, brio_output *out, size_t layer, const char *name);
/** Adds a byte, or bytes. */
brio_status brio_page_byte(brio_page_block *b, uint8_t byte);
brio_status brio_page_bytes(brio_page_block *b, const void *bytes, size_t size);
/** Adds a number in groups of seven bits, the lowest first; the highest bit of a byte says that more follow. */
brio_status brio_page_varint(brio_page_block *b, uint32_t x);
/** Ends the block. */
brio_status brio_page_block_end(brio_page_block *b);
void brio_page_block_free(brio_page_block *b);

/** Maps numbers near 0 to small ones: 0, -1, 1, -2, 2 to 0, 1, 2, 3, 4. */
static inline uint64_t brio_zigzag(int64_t x) {
    return (uint64_t)x << 1 ^ (uint64_t)(x >> 63);
}

typedef enum {
    BRIO_PAGE_DELTA, /* the difference from the number before, modulo 2^(8 width), by brio_zigzag */
    BRIO_PAGE_XOR    /* the bits in which it differs, for floating point */
} brio_page_mode;

/** Returns number i of a column. */
typedef uint64_t (*brio_page_value)(const void *user, size_t i);

/** A column: its numbers, and how they are stored. */
typedef struct {
    brio_page_value value;
    const void *user; /* passed to value */
    size_t n;
    int width; /* bytes of a number: 1 to 4, or 8 with BRIO_PAGE_XOR */
    brio_page_mode mode;
} brio_page_column;

/** Writes a block that is one column. */
brio_status brio_page_put_column(brio_output *out, size_t layer, const char *name, const brio_page_column *column);

#endif
