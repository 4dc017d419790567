/* The points of a scan in an E57 file: packets, and the byte streams in them, from which numbers are decoded. */
#include "io/e57/e57.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <string.h>

/* --- numbers in bits --- */

/* Decodes byte streams of an E57 file.
 *
 * A block of numbers is taken out of the bits first, and then converted to the type of the target: each loop knows one
 * kind and one type, and the block stays in the cache between the two.
 *
 * Based on: ASTM E2807-11, 9.7 (bitPackCodec). Huber. The ASTM E57 file format for 3D imaging data exchange. SPIE 7864,
 * 2011. */

enum { BLOCK = 512 /* numbers; chosen: 4 KiB */ };

/* --- numbers --- */

static uint64_t mask_of(unsigned bits) {
    return bits < 64 ? (UINT64_C(1) << bits) - 1 : UINT64_MAX;
}

/* Returns the number of `bits` bits that begins at a bit of the bytes. Reads 9 bytes. */
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

/* Decodes a stream of numbers of 0 bits, which has no bytes: every value is the same. */
static void e57_fill(brio_e57_decoder *d) {
    uint64_t numbers[BLOCK] = {0};
    while (d->done < d->count) put(d, numbers, d->count - d->done < BLOCK ? (size_t)(d->count - d->done) : BLOCK);
}

/* --- the section --- */

/* Reads the packets of an E57 file's section of points.
 *
 * A data packet holds bytes for every field, and what it holds of one field need not end where a number ends, nor have
 * as many numbers as what it holds of another. Each field has a decoder that goes on from packet to packet. Index
 * packets and empty packets are passed over.
 *
 * Based on: ASTM E2807-11, 9 (binary sections). */

enum { SECTION_HEADER = 32, POINTS_SECTION = 1 };
enum { INDEX_PACKET = 0, DATA_PACKET = 1, EMPTY_PACKET = 2, PACKET_HEADER = 4, DATA_HEADER = 6 };

brio_status brio_e57_section_check(const brio_e57_pages *p, const brio_e57_scans *scans, const brio_e57_section *s) {
    const brio_e57_scan *scan = &scans->scans[s->scan];
    uint64_t bits = 0, need, bytes = s->end - s->data;
    if (!scan->records) return BRIO_OK;
    BRIO_EXPECT(p->stream->ctx, s->data >= s->begin + SECTION_HEADER && s->data <= s->end, BRIO_ERR_FORMAT,
                "%s: byte %" PRIu64 ": packets from byte %" PRIu64 " on, outside of their section", p->stream->name,
                scan->section + 16, brio_e57_physical(s->data));
    for (size_t i = 0; i < scan->num_fields; i++) bits += scans->fields[scan->first_field + i].code.bits;
    if (!bits) bits = 1; /* points that are all the same one; a packet is not worth more of them than of others */
    if (__builtin_mul_overflow(bits, scan->records, &need)) need = UINT64_MAX;
    BRIO_EXPECT(p->stream->ctx, need / 8 <= bytes, BRIO_ERR_FORMAT,
                "%s: scan %zu (counted from 0): its %" PRIu64 " points of %" PRIu64 " bits need more than the %" PRIu64
                " bytes of its section at byte %" PRIu64,
                p->stream->name, s->scan, scan->records, bits, bytes, scan->section);
    return BRIO_OK;
}

brio_status brio_e57_section_open(brio_e57_pages *p, const brio_e57_scans *scans, size_t scan, brio_e57_section *out) {
    brio_stream *s = p->stream;
    const char *header = NULL;
    uint64_t at = scans->scans[scan].section;
    *out = (brio_e57_section){.scan = scan};
    if (!scans->scans[scan].records) return BRIO_OK;
    BRIO_FORWARD(brio_e57_logical(p, "the points of a scan", at, &out->begin));
    BRIO_FORWARD(brio_e57_take(p, out->begin, SECTION_HEADER, &header));
    unsigned id = (uint8_t)header[0];
    uint64_t length = brio_le64(header + 8), data = brio_le64(header + 16);
    BRIO_EXPECT(s->ctx, id == POINTS_SECTION, BRIO_ERR_FORMAT,
                "%s: byte %" PRIu64 ": a section of the kind %u, expected points (%d)", s->name, at, id,
                POINTS_SECTION);
    out->endless = length == 0 || length == SECTION_HEADER;
    BRIO_EXPECT(s->ctx, out->endless || (length > SECTION_HEADER && length <= brio_e57_size(p) - out->begin),
                BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": a section of %" PRIu64 " bytes, expected %d to %" PRIu64,
                s->name, at + 8, length, SECTION_HEADER, brio_e57_size(p) - out->begin);
    out->end = out->begin + length;
    return brio_e57_logical(p, "the packets of a scan", data, &out->data);
}

/* --- packets --- */

typedef struct {
    brio_e57_pages *pages;
    const brio_e57_section *section;
    const brio_e57_field *fields;
    brio_e57_decoder *decoders;
    size_t count;
} packet_reader;

static brio_status refuse_packet(const packet_reader *r, uint64_t at, const char *what, uint64_t found,
                                 uint64_t expected) {
    return brio_fail(r->pages->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: the packet at byte %" PRIu64 " has %" PRIu64 " %s, expected %" PRIu64, r->pages->stream->name,
                     brio_e57_physical(at), found, what, expected);
}

static brio_status decode_packet(packet_reader *r, uint64_t at, const char *packet, size_t size) {
    size_t used = DATA_HEADER + 2 * r->count;
    if (size < DATA_HEADER || brio_le16(packet + 4) != r->count)
        return refuse_packet(r, at, "byte streams", size < DATA_HEADER ? 0 : brio_le16(packet + 4), r->count);
    if (size < used) return refuse_packet(r, at, "bytes at least", size, used);
    const char *lengths = packet + DATA_HEADER;
    for (size_t i = 0; i < r->count; i++) {
        size_t length = brio_le16(lengths + 2 * i);
        if (length > size - used) return refuse_packet(r, at, "bytes", size, used + length);
        brio_e57_decode(&r->decoders[i], packet + used, length);
        used += length;
    }
    return BRIO_OK;
}

/* Reads a packet and moves *at behind it. */
static brio_status read_packet(packet_reader *r, uint64_t *at) {
    const char *packet = NULL;
    BRIO_FORWARD(brio_e57_take(r->pages, *at, PACKET_HEADER, &packet));
    unsigned kind = (uint8_t)packet[0];
    size_t size = (size_t)brio_le16(packet + 2) + 1;
    if (kind > EMPTY_PACKET)
        BRIO_FORWARD(brio_fail(r->pages->stream->ctx, BRIO_ERR_FORMAT,
                               "%s: byte %" PRIu64 ": a packet of the kind %u, expected 0, 1 or 2",
                               r->pages->stream->name, brio_e57_physical(*at), kind));
    if (size % 4) BRIO_FORWARD(refuse_packet(r, *at, "bytes", size, (size + 3) / 4 * 4));
    if (size > r->section->end - *at) BRIO_FORWARD(refuse_packet(r, *at, "bytes at most", size, r->section->end - *at));
    if (kind == DATA_PACKET) {
        BRIO_FORWARD(brio_e57_take(r->pages, *at, size, &packet));
        BRIO_FORWARD(decode_packet(r, *at, packet, size));
    }
    *at += size;
    return BRIO_OK;
}

/* Returns the first field whose values are not all there, or the number of fields. */
static size_t first_unfinished(const packet_reader *r) {
    size_t i = 0;
    while (i < r->count && (r->fields[i].text || r->decoders[i].done == r->decoders[i].count)) i++;
    return i;
}

brio_status brio_e57_section_read(brio_e57_pages *p, const brio_e57_section *section, const brio_e57_field *fields,
                                  brio_e57_decoder *decoders, size_t count) {
    packet_reader r = {p, section, fields, decoders, count};
    for (size_t i = 0; i < count; i++)
        if (!fields[i].text && !fields[i].code.bits) e57_fill(&decoders[i]);
    for (uint64_t at = section->data; section->end - at >= PACKET_HEADER && first_unfinished(&r) < count;)
        BRIO_FORWARD(read_packet(&r, &at));
    size_t missing = first_unfinished(&r);
    BRIO_EXPECT(p->stream->ctx, missing == count, BRIO_ERR_FORMAT,
                "%s: scan %zu (counted from 0): its packets end at byte %" PRIu64 " with %" PRIu64 " of %" PRIu64
                " values of %s",
                p->stream->name, section->scan, brio_e57_physical(section->end), decoders[missing].done,
                decoders[missing].count, fields[missing].name);
    return BRIO_OK;
}
