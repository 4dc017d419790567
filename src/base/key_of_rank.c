/* The key of a rank among many, without sorting them: eight passes count by one byte after the other, from the highest,
 * those that share the bytes that are known so far.
 *
 * Based on: Knuth. The art of computer programming, volume 3. 1998, section 5.2.5 (sorting by digits). */
#include "base/sort.h"
#include <assert.h>

/* BLOCK: keys between two looks; chosen. */
enum { BYTE = 8, VALUES = 1 << BYTE, BLOCK = 1 << 16 };

/* Counts keys by the byte at `shift`: those whose higher bytes are those of `known`. */
static brio_status count_bytes(brio_context *ctx, const uint64_t *keys, size_t n, uint64_t known, int shift,
                               size_t *count) {
    const uint64_t higher = shift + BYTE < 64 ? UINT64_MAX << (shift + BYTE) : 0;
    for (int i = 0; i < VALUES; i++) count[i] = 0;
    for (size_t begin = 0; begin < n; begin += BLOCK) {
        size_t end = n - begin < BLOCK ? n : begin + BLOCK;
        for (size_t i = begin; i < end; i++)
            if (((keys[i] ^ known) & higher) == 0) count[keys[i] >> shift & (VALUES - 1)]++;
        BRIO_FORWARD(brio_look(ctx, end - begin));
    }
    return BRIO_OK;
}

brio_status brio_key_of_rank(brio_context *ctx, const uint64_t *keys, size_t n, size_t rank, uint64_t *key) {
    assert(rank < n);
    *key = 0;
    for (int shift = 64 - BYTE; shift >= 0; shift -= BYTE) {
        size_t count[VALUES], value = 0;
        BRIO_FORWARD(count_bytes(ctx, keys, n, *key, shift, count));
        for (; rank >= count[value]; value++) rank -= count[value];
        *key |= (uint64_t)value << shift;
    }
    return BRIO_OK;
}
