/* The checksum of zip archives: the remainder of the bytes modulo the polynomial 0xedb88320 (bits in reverse). */
#ifndef BRIO_IO_CRC32_H
#define BRIO_IO_CRC32_H

#include <stddef.h>
#include <stdint.h>

typedef struct brio_crc32 {
    uint32_t tables[8][256]; /* tables[k][b]: what byte b adds that has k bytes behind it */
    uint32_t value;
} brio_crc32;

void brio_crc32_begin(brio_crc32 *c);
void brio_crc32_add(brio_crc32 *c, const void *bytes, size_t size);
static inline uint32_t brio_crc32_end(const brio_crc32 *c) {
    return ~c->value;
}

#endif
