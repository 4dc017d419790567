/* LZF, the compression of PCD files. */
#ifndef BRIO_IO_LZF_H
#define BRIO_IO_LZF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BRIO_LZF_MOST_RATIO = 88 /* bytes that one byte stands for, at most: 264 for 3 */ };

/** Decompresses bytes. Returns whether they are sound and give exactly `size` bytes. */
bool brio_lzf_decompress(const uint8_t *bytes, size_t count, uint8_t *out, size_t size);

/** Returns room for any `count` bytes when compressed. */
static inline size_t brio_lzf_room(size_t count) {
    return count + count / 32 + 1;
}

enum { BRIO_LZF_TABLE = 1 << 14 };

/** Compresses bytes.   count  below 2^32.   out  brio_lzf_room(count) bytes.   table  BRIO_LZF_TABLE numbers, workspace.
 *  Returns the size of what was written. */
size_t brio_lzf_compress(const uint8_t *bytes, size_t count, uint8_t *out, uint32_t *table);

#endif
