/* Reads the packets of an E57 file's section of points.
 *
 * A data packet holds bytes for every field, and what it holds of one field need not end where a number ends, nor have
 * as many numbers as what it holds of another. Each field has a decoder that goes on from packet to packet. Index
 * packets and empty packets are passed over.
 *
 * Based on: ASTM E2807-11, 9 (binary sections). */
#include "io/e57/e57_section.h"
#include "io/little_endian.h"
#include <inttypes.h>

enum { SECTION_HEADER = 32, POINTS_SECTION = 1 };
enum { INDEX_PACKET = 0, DATA_PACKET = 1, EMPTY_PACKET = 2, PACKET_HEADER = 4, DATA_HEADER = 6 };

brio_status brio_e57_section_check(const brio_e57_pages *p, const brio_e57_scans *scans, const brio_e57_section *s) {
    brio_status status = BRIO_OK;
    const brio_e57_scan *scan = &scans->scans[s->scan];
    uint64_t bits = 0, need, bytes = s->end - s->data;
    if (!scan->records) return BRIO_OK;
    BRIO_REQUIRE(p->stream->ctx, s->data >= s->begin + SECTION_HEADER && s->data <= s->end, BRIO_ERR_FORMAT,
                 "%s: byte %" PRIu64 ": packets from byte %" PRIu64 " on, outside of their section", p->stream->name,
                 scan->section + 16, brio_e57_physical(s->data));
    for (size_t i = 0; i < scan->num_fields; i++) bits += scans->fields[scan->first_field + i].code.bits;
    if (!bits) bits = 1; /* points that are all the same one; a packet is not worth more of them than of others */
    if (__builtin_mul_overflow(bits, scan->records, &need)) need = UINT64_MAX;
    BRIO_REQUIRE(p->stream->ctx, need / 8 <= bytes, BRIO_ERR_FORMAT,
                 "%s: scan %zu (counted from 0): its %" PRIu64 " points of %" PRIu64 " bits need more than the %" PRIu64
                 " bytes of its section at byte %" PRIu64,
                 p->stream->name, s->scan, scan->records, bits, bytes, scan->section);
done:
    return status;
}

brio_status brio_e57_section_open(brio_e57_pages *p, const brio_e57_scans *scans, size_t scan, brio_e57_section *out) {
    brio_status status = BRIO_OK;
    brio_stream *s = p->stream;
    const char *header = NULL;
    uint64_t at = scans->scans[scan].section;
    *out = (brio_e57_section){.scan = scan};
    if (!scans->scans[scan].records) return BRIO_OK;
    BRIO_TRY(brio_e57_logical(p, "the points of a scan", at, &out->begin));
    BRIO_TRY(brio_e57_take(p, out->begin, SECTION_HEADER, &header));
    unsigned id = (uint8_t)header[0];
    uint64_t length = brio_le64(header + 8), data = brio_le64(header + 16);
    BRIO_REQUIRE(s->ctx, id == POINTS_SECTION, BRIO_ERR_FORMAT,
                 "%s: byte %" PRIu64 ": a section of the kind %u, expected points (%d)", s->name, at, id,
                 POINTS_SECTION);
    out->endless = length == 0 || length == SECTION_HEADER;
    BRIO_REQUIRE(s->ctx, out->endless || (length > SECTION_HEADER && length <= brio_e57_size(p) - out->begin),
                 BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": a section of %" PRIu64 " bytes, expected %d to %" PRIu64,
                 s->name, at + 8, length, SECTION_HEADER, brio_e57_size(p) - out->begin);
    out->end = out->begin + length;
    BRIO_TRY(brio_e57_logical(p, "the packets of a scan", data, &out->data));
done:
    return status;
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
    brio_status status = BRIO_OK;
    const char *packet = NULL;
    BRIO_TRY(brio_e57_take(r->pages, *at, PACKET_HEADER, &packet));
    unsigned kind = (uint8_t)packet[0];
    size_t size = (size_t)brio_le16(packet + 2) + 1;
    if (kind > EMPTY_PACKET)
        BRIO_TRY(brio_fail(r->pages->stream->ctx, BRIO_ERR_FORMAT,
                           "%s: byte %" PRIu64 ": a packet of the kind %u, expected 0, 1 or 2", r->pages->stream->name,
                           brio_e57_physical(*at), kind));
    if (size % 4) BRIO_TRY(refuse_packet(r, *at, "bytes", size, (size + 3) / 4 * 4));
    if (size > r->section->end - *at) BRIO_TRY(refuse_packet(r, *at, "bytes at most", size, r->section->end - *at));
    if (kind == DATA_PACKET) {
        BRIO_TRY(brio_e57_take(r->pages, *at, size, &packet));
        BRIO_TRY(decode_packet(r, *at, packet, size));
    }
    *at += size;
done:
    return status;
}

/* Returns the first field whose values are not all there, or the number of fields. */
static size_t first_unfinished(const packet_reader *r) {
    size_t i = 0;
    while (i < r->count && (r->fields[i].text || r->decoders[i].done == r->decoders[i].count)) i++;
    return i;
}

brio_status brio_e57_section_read(brio_e57_pages *p, const brio_e57_section *section, const brio_e57_field *fields,
                                  brio_e57_decoder *decoders, size_t count) {
    brio_status status = BRIO_OK;
    packet_reader r = {p, section, fields, decoders, count};
    for (size_t i = 0; i < count; i++)
        if (!fields[i].text && !fields[i].code.bits) brio_e57_fill(&decoders[i]);
    for (uint64_t at = section->data; section->end - at >= PACKET_HEADER && first_unfinished(&r) < count;)
        BRIO_TRY(read_packet(&r, &at));
    size_t missing = first_unfinished(&r);
    BRIO_REQUIRE(p->stream->ctx, missing == count, BRIO_ERR_FORMAT,
                 "%s: scan %zu (counted from 0): its packets end at byte %" PRIu64 " with %" PRIu64 " of %" PRIu64
                 " values of %s",
                 p->stream->name, section->scan, brio_e57_physical(section->end), decoders[missing].done,
                 decoders[missing].count, fields[missing].name);
done:
    return status;
}
