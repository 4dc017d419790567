/* The checksum, eight bytes at a time.
 *
 * Based on: Kounavis, Berry. A systematic approach to building high performance, software-based, CRC generators. ISCC
 * 2005. */
#include "io/crc32.h"
#include "io/little_endian.h"

void brio_crc32_begin(brio_crc32 *c) {
    for (uint32_t b = 0; b < 256; b++) {
        uint32_t rest = b;
        for (int i = 0; i < 8; i++) rest = rest & 1 ? rest >> 1 ^ UINT32_C(0xedb88320) : rest >> 1;
        c->tables[0][b] = rest;
    }
    for (int k = 1; k < 8; k++)
        for (int b = 0; b < 256; b++)
            c->tables[k][b] = c->tables[k - 1][b] >> 8 ^ c->tables[0][c->tables[k - 1][b] & 255];
    c->value = UINT32_MAX;
}

void brio_crc32_add(brio_crc32 *c, const void *bytes, size_t size) {
    const uint8_t *p = bytes;
    uint32_t value = c->value;
    for (; size >= 8; size -= 8, p += 8) {
        uint32_t low = value ^ brio_le32(p), high = brio_le32(p + 4);
        value = 0;
        for (int k = 0; k < 4; k++)
            value ^= c->tables[7 - k][low >> 8 * k & 255] ^ c->tables[3 - k][high >> 8 * k & 255];
    }
    for (; size; size--) value = value >> 8 ^ c->tables[0][(value ^ *p++) & 255];
    c->value = value;
}
