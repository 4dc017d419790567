/* Decodes byte streams of an E57 file.
 *
 * A block of numbers is taken out of the bits first, and then converted to the type of the target: each loop knows one
 * kind and one type, and the block stays in the cache between the two.
 *
 * Based on: ASTM E2807-11, 9.7 (bitPackCodec). Huber. The ASTM E57 file format for 3D imaging data exchange. SPIE 7864,
 * 2011. */
#include "io/e57/e57_bits.h"
#include "io/little_endian.h"
#include <string.h>

enum { BLOCK = 512 /* numbers; chosen: 4 KiB */ };

/* --- numbers --- */

static uint64_t mask_of(unsigned bits) {
    return bits < 64 ? (UINT64_C(1) << bits) - 1 : UINT64_MAX;
}

/* The number of `bits` bits that begins at a bit of the bytes. Reads 9 bytes. */
static inline uint64_t number_at(const uint8_t *bytes, uint64_t bit, unsigned bits) {
    const uint8_t *at = bytes + bit / 8;
    unsigned shift = bit % 8;
    uint64_t number = brio_le64(at) >> shift;
    if (shift + bits > 64) number |= (uint64_t)at[8] << (64 - shift);
    return number & mask_of(bits);
}

static void unpack(uint64_t *numbers, const uint8_t *bytes, uint64_t bit, unsigned bits, size_t count) {
    if (bits > 57) {
        for (size_t i = 0; i < count; i++, bit += bits) numbers[i] = number_at(bytes, bit, bits);
        return;
    }
    uint64_t mask = mask_of(bits);
    for (size_t i = 0; i < count; i++, bit += bits) numbers[i] = brio_le64(bytes + bit / 8) >> bit % 8 & mask;
}

/* --- values --- */

static inline int64_t integer_of(uint64_t number, int64_t least) {
    return (int64_t)((uint64_t)least + number);
}

static inline double single_of(uint64_t number) {
    uint32_t bits = (uint32_t)number;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

#define STORE_ALL(type, expression)                                                                                    \
    for (size_t i = 0; i < count; i++, to += stride) {                                                                 \
        type value = (type)(expression);                                                                               \
        memcpy(to, &value, sizeof value);                                                                              \
    }                                                                                                                  \
    break

static void store_doubles(char *to, size_t stride, const brio_e57_code *code, const uint64_t *numbers, size_t count) {
    int64_t least = code->least;
    double scale = code->scale, offset = code->offset;
    switch (code->kind) {
    case BRIO_E57_INTEGER:
        STORE_ALL(double, integer_of(numbers[i], least));
    case BRIO_E57_SCALED:
        STORE_ALL(double, (double)integer_of(numbers[i], least) * scale + offset);
    case BRIO_E57_SINGLE:
        STORE_ALL(double, single_of(numbers[i]));
    case BRIO_E57_DOUBLE:
        STORE_ALL(uint64_t, numbers[i]);
    }
}

/* Stores whether values are not 0, of any kind. */
static void store_tests(char *to, size_t stride, const brio_e57_code *code, const uint64_t *numbers, size_t count) {
    double values[BLOCK] = {0};
    store_doubles((char *)values, sizeof *values, code, numbers, count);
    for (size_t i = 0; i < count; i++) to[i * stride] = values[i] != 0;
}

/* Stores integers in a type that holds them, and floats in their own type. */
static void store(const brio_e57_decoder *d, char *to, const uint64_t *numbers, size_t count) {
    int64_t least = d->code.least;
    size_t stride = d->stride;
    if (d->tests) {
        store_tests(to, stride, &d->code, numbers, count);
        return;
    }
    switch (d->type) {
    case BRIO_SCALAR_INT8:
    case BRIO_SCALAR_UINT8:
        STORE_ALL(uint8_t, integer_of(numbers[i], least));
    case BRIO_SCALAR_INT16:
    case BRIO_SCALAR_UINT16:
        STORE_ALL(uint16_t, integer_of(numbers[i], least));
    case BRIO_SCALAR_INT32:
    case BRIO_SCALAR_UINT32:
        STORE_ALL(uint32_t, integer_of(numbers[i], least));
    case BRIO_SCALAR_FLOAT32: /* SINGLE alone has this target */
        STORE_ALL(uint32_t, numbers[i]);
    case BRIO_SCALAR_FLOAT64:
        store_doubles(to, stride, &d->code, numbers, count);
        break;
    case BRIO_SCALAR_END:
        break;
    }
}

/* Returns whether no double has one of the integers. */
static bool some_are_rounded(const brio_e57_code *code, const uint64_t *numbers, size_t count) {
    for (size_t i = 0; i < count; i++) {
        int64_t value = integer_of(numbers[i], code->least);
        uint64_t size = value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
        if ((uint64_t)(double)size != size) return true; /* at most 2^63, so that the way back is defined */
    }
    return false;
}

static void put(brio_e57_decoder *d, const uint64_t *numbers, size_t count) {
    if (d->target && d->type == BRIO_SCALAR_FLOAT64 && d->code.kind == BRIO_E57_INTEGER)
        d->rounded |= some_are_rounded(&d->code, numbers, count);
    if (d->target) store(d, d->target + d->done * d->stride, numbers, count);
    d->done += count;
}

/* --- streams --- */

/* Completes the number that the last part ended in; returns the bits of this part that it took. */
static uint64_t complete(brio_e57_decoder *d, const uint8_t *bytes, uint64_t bits) {
    unsigned need = d->code.bits - d->carried;
    if (!d->carried) return 0;
    if (need > bits) need = (unsigned)bits;
    d->carry |= number_at(bytes, 0, need) << d->carried;
    d->carried += need;
    if (d->carried < d->code.bits) return need;
    put(d, &d->carry, 1);
    d->carry = d->carried = 0;
    return need;
}

void brio_e57_decode(brio_e57_decoder *d, const char *bytes, size_t size) {
    const uint8_t *from = (const uint8_t *)bytes;
    uint64_t end = 8 * (uint64_t)size, numbers[BLOCK];
    if (!d->code.bits || !size) return;
    uint64_t bit = complete(d, from, end);
    while (d->done < d->count && end - bit >= d->code.bits) {
        uint64_t there = (end - bit) / d->code.bits, left = d->count - d->done;
        if (there > left) there = left;
        size_t count = there < BLOCK ? (size_t)there : BLOCK;
        unpack(numbers, from, bit, d->code.bits, count);
        put(d, numbers, count);
        bit += count * d->code.bits;
    }
    if (d->done == d->count || bit == end) return;
    d->carried = (unsigned)(end - bit);
    d->carry = number_at(from, bit, d->carried);
}

void brio_e57_fill(brio_e57_decoder *d) {
    uint64_t numbers[BLOCK] = {0};
    while (d->done < d->count) put(d, numbers, d->count - d->done < BLOCK ? (size_t)(d->count - d->done) : BLOCK);
}
