/* Scalars of any type and byte order.
 *
 * Every scalar type converts to double without loss. The loops over columns are written out for each type and byte
 * order, so that they test neither. */
#include "io/scalar.h"
#include <math.h>
#include <string.h>

static inline uint8_t turned_8(uint8_t x) {
    return x;
}
static inline uint16_t turned_16(uint16_t x) {
    return __builtin_bswap16(x);
}
static inline uint32_t turned_32(uint32_t x) {
    return __builtin_bswap32(x);
}
static inline uint64_t turned_64(uint64_t x) {
    return __builtin_bswap64(x);
}

#define DEFINE_LOAD(type, bits)                                                                                        \
    static inline double load_##type(const void *bytes, bool swap) {                                                   \
        uint##bits##_t raw;                                                                                            \
        type value;                                                                                                    \
        memcpy(&raw, bytes, sizeof raw);                                                                               \
        if (swap) raw = turned_##bits(raw);                                                                            \
        memcpy(&value, &raw, sizeof value);                                                                            \
        return (double)value;                                                                                          \
    }                                                                                                                  \
    static void convert_##type(double *target, const char *source, size_t rows, size_t stride, bool swap) {            \
        if (stride == 3 * sizeof(type) && !swap) {                                                                     \
            for (size_t i = 0; i < 3 * rows; i++) target[i] = load_##type(source + i * sizeof(type), false);           \
            return;                                                                                                    \
        }                                                                                                              \
        for (size_t i = 0; i < rows; i++, source += stride)                                                            \
            for (size_t j = 0; j < 3; j++) *target++ = load_##type(source + j * sizeof(type), swap);                   \
    }

DEFINE_LOAD(int8_t, 8)
DEFINE_LOAD(uint8_t, 8)
DEFINE_LOAD(int16_t, 16)
DEFINE_LOAD(uint16_t, 16)
DEFINE_LOAD(int32_t, 32)
DEFINE_LOAD(uint32_t, 32)
DEFINE_LOAD(float, 32)
DEFINE_LOAD(double, 64)

double brio_scalar_load(const void *bytes, brio_scalar type, bool swap) {
    switch (type) {
    case BRIO_SCALAR_INT8:
        return load_int8_t(bytes, swap);
    case BRIO_SCALAR_UINT8:
        return load_uint8_t(bytes, swap);
    case BRIO_SCALAR_INT16:
        return load_int16_t(bytes, swap);
    case BRIO_SCALAR_UINT16:
        return load_uint16_t(bytes, swap);
    case BRIO_SCALAR_INT32:
        return load_int32_t(bytes, swap);
    case BRIO_SCALAR_UINT32:
        return load_uint32_t(bytes, swap);
    case BRIO_SCALAR_FLOAT32:
        return load_float(bytes, swap);
    case BRIO_SCALAR_FLOAT64:
        return load_double(bytes, swap);
    case BRIO_SCALAR_END:
        break;
    }
    return 0;
}

void brio_scalar_convert_triples(double *target, const char *source, size_t rows, size_t stride, brio_scalar type,
                                 bool swap) {
    switch (type) {
    case BRIO_SCALAR_INT8:
        convert_int8_t(target, source, rows, stride, swap);
        break;
    case BRIO_SCALAR_UINT8:
        convert_uint8_t(target, source, rows, stride, swap);
        break;
    case BRIO_SCALAR_INT16:
        convert_int16_t(target, source, rows, stride, swap);
        break;
    case BRIO_SCALAR_UINT16:
        convert_uint16_t(target, source, rows, stride, swap);
        break;
    case BRIO_SCALAR_INT32:
        convert_int32_t(target, source, rows, stride, swap);
        break;
    case BRIO_SCALAR_UINT32:
        convert_uint32_t(target, source, rows, stride, swap);
        break;
    case BRIO_SCALAR_FLOAT32:
        convert_float(target, source, rows, stride, swap);
        break;
    case BRIO_SCALAR_FLOAT64:
        convert_double(target, source, rows, stride, swap);
        break;
    case BRIO_SCALAR_END:
        break;
    }
}

#define STORE(type, least, most)                                                                                       \
    do {                                                                                                               \
        if (!(value >= (least) && value <= (most)) || value != floor(value)) return false;                             \
        type stored = (type)value;                                                                                     \
        memcpy(target, &stored, sizeof stored);                                                                        \
        return true;                                                                                                   \
    } while (0)

bool brio_scalar_store(void *target, brio_scalar type, double value) {
    switch (type) {
    case BRIO_SCALAR_INT8:
        STORE(int8_t, INT8_MIN, INT8_MAX);
    case BRIO_SCALAR_UINT8:
        STORE(uint8_t, 0, UINT8_MAX);
    case BRIO_SCALAR_INT16:
        STORE(int16_t, INT16_MIN, INT16_MAX);
    case BRIO_SCALAR_UINT16:
        STORE(uint16_t, 0, UINT16_MAX);
    case BRIO_SCALAR_INT32:
        STORE(int32_t, INT32_MIN, INT32_MAX);
    case BRIO_SCALAR_UINT32:
        STORE(uint32_t, 0, UINT32_MAX);
    case BRIO_SCALAR_FLOAT32: {
        /* beyond the largest float, C leaves the conversion undefined; the format has an infinity */
        bool beyond = fabs(value) > 0x1.ffffffp127;
        float stored = beyond ? (float)copysign((double)INFINITY, value) : (float)value;
        memcpy(target, &stored, sizeof stored);
        return true;
    }
    case BRIO_SCALAR_FLOAT64:
        memcpy(target, &value, sizeof value);
        return true;
    case BRIO_SCALAR_END:
        break;
    }
    return false;
}

#define GATHER(bits)                                                                                                   \
    for (size_t i = 0; i < rows; i++, source += stride, out += sizeof(uint##bits##_t)) {                               \
        uint##bits##_t raw;                                                                                            \
        memcpy(&raw, source, sizeof raw);                                                                              \
        if (swap) raw = turned_##bits(raw);                                                                            \
        memcpy(out, &raw, sizeof raw);                                                                                 \
    }

void brio_scalar_gather(void *target, const char *source, size_t rows, size_t stride, size_t size, bool swap) {
    char *out = target;
    switch (size) {
    case 1:
        GATHER(8) break;
    case 2:
        GATHER(16) break;
    case 4:
        GATHER(32) break;
    default:
        GATHER(64) break;
    }
}
