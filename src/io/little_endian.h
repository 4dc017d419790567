/* Little-endian numbers at addresses of any alignment. The compiler makes one instruction of each. */
#ifndef BRIO_IO_LITTLE_ENDIAN_H
#define BRIO_IO_LITTLE_ENDIAN_H

#include <stdint.h>
#include <string.h>

static inline uint16_t brio_le16(const void *bytes) {
    const uint8_t *b = bytes;
    return (uint16_t)(b[0] | b[1] << 8);
}
static inline uint32_t brio_le32(const void *bytes) {
    const uint8_t *b = bytes;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}
static inline uint64_t brio_le64(const void *bytes) {
    return brio_le32(bytes) | (uint64_t)brio_le32((const uint8_t *)bytes + 4) << 32;
}
static inline double brio_le_double(const void *bytes) {
    uint64_t bits = brio_le64(bytes);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void brio_put_le16(void *bytes, uint16_t x) {
    uint8_t *b = bytes;
    b[0] = (uint8_t)x;
    b[1] = (uint8_t)(x >> 8);
}
static inline void brio_put_le32(void *bytes, uint32_t x) {
    uint8_t *b = bytes;
    for (int i = 0; i < 4; i++) b[i] = (uint8_t)(x >> 8 * i);
}
static inline void brio_put_le64(void *bytes, uint64_t x) {
    uint8_t *b = bytes;
    for (int i = 0; i < 8; i++) b[i] = (uint8_t)(x >> 8 * i);
}
static inline void brio_put_le_double(void *bytes, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    brio_put_le64(bytes, bits);
}

#endif
