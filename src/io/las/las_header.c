/* Reads the header of a LAS file of version 1.0 to 1.4 and its records of variable length.
 *
 * Of these records two matter: the one of LASzip, without which compressed points cannot be read, and the one that
 * names the extra bytes. All others are passed over.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. Isenburg. LASzip. 2013. */
#include "io/las/las_header.h"
#include "base/memory.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LEAST_HEADER = 227, HEADER_1_4 = 375, RECORD_HEADER = 54, EXTRA_RECORD = 192, LASZIP = 22204, EXTRA_BYTES = 4 };

static const uint8_t record_bytes[BRIO_LAS_FORMATS] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

size_t brio_las_record_bytes(unsigned format) {
    return record_bytes[format];
}

size_t brio_las_extra_bytes(unsigned type) {
    static const uint8_t bytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return type < sizeof bytes ? bytes[type] : 0;
}

/* --- the header --- */

static brio_status check_header(brio_stream *s, const brio_las_header *h) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(s->ctx, h->format < BRIO_LAS_FORMATS, BRIO_ERR_FORMAT,
                 "%s: byte 104: point format %u, expected 0 to 10", s->name, h->format);
    BRIO_REQUIRE(s->ctx, h->record >= record_bytes[h->format], BRIO_ERR_FORMAT,
                 "%s: byte 105: records of %zu bytes, point format %u has %u", s->name, h->record, h->format,
                 record_bytes[h->format]);
    for (int k = 0; k < 3; k++)
        BRIO_REQUIRE(s->ctx, isfinite(h->scale[k]) && isfinite(h->offset[k]) && h->scale[k] != 0, BRIO_ERR_FORMAT,
                     "%s: byte %d: %c has scale %g and offset %g", s->name, 131 + 8 * k, "xyz"[k], h -> scale[k],
                     h -> offset[k]);
done:
    return status;
}

static void take_fields(brio_las_header *h, const char *bytes, size_t size) {
    unsigned format = (uint8_t)bytes[104];
    h->minor = (uint8_t)bytes[25];
    h->data = brio_le32(bytes + 96);
    /* LASzip marks compression in the two upper bits */
    h->compressed = format >> 6;
    h->format = format & 63;
    h->record = brio_le16(bytes + 105);
    h->num_points = brio_le32(bytes + 107);
    if (h->minor >= 4 && size >= HEADER_1_4 && brio_le64(bytes + 247)) h->num_points = brio_le64(bytes + 247);
    for (int k = 0; k < 3; k++) {
        h->scale[k] = brio_le_double(bytes + 131 + 8 * k);
        h->offset[k] = brio_le_double(bytes + 155 + 8 * k);
    }
}

/* Reads the fixed part.   num_records  receives the number of records of variable length. */
static brio_status read_fixed(brio_stream *s, brio_las_header *h, uint32_t *num_records) {
    brio_status status = BRIO_OK;
    const char *bytes = NULL;
    brio_stream_element(s, "header", 1);
    BRIO_TRY(brio_stream_fill(s, LEAST_HEADER));
    bytes = s->buffer + s->begin;
    BRIO_REQUIRE(s->ctx, brio_stream_left(s) < 4 || !memcmp(bytes, "LASF", 4), BRIO_ERR_FORMAT,
                 "%s: byte 0: expected LASF: not a LAS or LAZ file", s->name);
    if (brio_stream_left(s) < LEAST_HEADER) return brio_stream_truncated(s);
    size_t size = brio_le16(bytes + 94);
    BRIO_REQUIRE(s->ctx, bytes[24] == 1 && (uint8_t)bytes[25] <= 4, BRIO_ERR_FORMAT,
                 "%s: byte 24: version %u.%u, expected 1.0 to 1.4", s->name, (uint8_t)bytes[24], (uint8_t)bytes[25]);
    BRIO_REQUIRE(s->ctx, size >= LEAST_HEADER, BRIO_ERR_FORMAT, "%s: byte 94: a header of %zu bytes, expected %d",
                 s->name, size, LEAST_HEADER);
    BRIO_TRY(brio_stream_take(s, size, &bytes));
    take_fields(h, bytes, size);
    *num_records = brio_le32(bytes + 100);
    BRIO_REQUIRE(s->ctx, h->data >= size, BRIO_ERR_FORMAT,
                 "%s: byte 96: the points begin at byte %" PRIu64 ", within the header", s->name, h->data);
    BRIO_TRY(check_header(s, h));
done:
    return status;
}

/* --- extra bytes --- */

/* Adds number `which` of `count` numbers of one description. */
static brio_status add_extra(brio_stream *s, brio_las_header *h, const char *bytes, unsigned which, unsigned count,
                             size_t at) {
    brio_status status = BRIO_OK;
    unsigned options = (uint8_t)bytes[3];
    brio_las_extra e = {.type = ((uint8_t)bytes[2] - 1u) % 10 + 1, .at = at, .scale = 1};
    e.scaled = options & 0x18;
    if (options & 8) e.scale = brio_le_double(bytes + 112 + 8 * which);
    if (options & 16) e.offset = brio_le_double(bytes + 136 + 8 * which);
    snprintf(e.name, sizeof e.name, "%.32s", bytes + 4);
    size_t length = strlen(e.name);
    if (count > 1) snprintf(e.name + length, sizeof e.name - length, "_%u", which);
    BRIO_TRY(BRIO_RESERVE(s->ctx, h->extras, h->extra_capacity, h->num_extras + 1));
    h->extras[h->num_extras++] = e;
done:
    return status;
}

/* Reads the descriptions of extra bytes. Those that do not fit into a record are left out, and so are bytes without a
 * type. Types above 10 are two or three numbers. */
static brio_status take_extras(brio_stream *s, brio_las_header *h, const char *bytes, size_t size) {
    brio_status status = BRIO_OK;
    size_t at = 0, room = h->record - record_bytes[h->format];
    h->num_extras = 0;
    for (; size >= EXTRA_RECORD; size -= EXTRA_RECORD, bytes += EXTRA_RECORD) {
        unsigned type = (uint8_t)bytes[2], count = type ? (type - 1) / 10 + 1 : 1;
        if (type > 30) return BRIO_OK;
        size_t width = type ? brio_las_extra_bytes((type - 1) % 10 + 1) : (uint8_t)bytes[3];
        if (count * width > room - at) return BRIO_OK;
        for (unsigned i = 0; i < count && type; i++)
            if (bytes[4]) BRIO_TRY(add_extra(s, h, bytes, i, count, at + i * width));
        at += count * width;
    }
done:
    return status;
}

/* --- LASzip's record --- */

typedef struct {
    uint16_t type, size, version;
} laz_item;

/* The items that LASzip's record lists. */
enum { ITEM_BYTES = 0, POINT10 = 6, TIME11, RGB12, WAVE13, POINT14, RGB14, RGBNIR14, WAVE14, BYTES14, MOST_ITEMS = 5 };

/* Lists the items of a format; returns their number. */
static size_t items_of(const brio_las_header *h, laz_item *items) {
    static const uint8_t types[BRIO_LAS_FORMATS][3] = {
        {POINT10},        {POINT10, TIME11},   {POINT10, RGB12},  {POINT10, TIME11, RGB12},   {0}, {0}, {POINT14},
        {POINT14, RGB14}, {POINT14, RGBNIR14}, {POINT14, WAVE14}, {POINT14, RGBNIR14, WAVE14}};
    static const uint8_t sizes[] = {
        [POINT10] = 20, [TIME11] = 8, [RGB12] = 6, [POINT14] = 30, [RGB14] = 6, [RGBNIR14] = 8, [WAVE14] = 29};
    size_t count = 0;
    for (int i = 0; i < 3 && types[h->format][i]; i++) {
        uint16_t type = types[h->format][i];
        items[count++] = (laz_item){type, sizes[type], 0};
    }
    size_t extra = h->record - record_bytes[h->format];
    if (count && extra) items[count++] = (laz_item){h->format < 6 ? ITEM_BYTES : BYTES14, (uint16_t)extra, 0};
    return count;
}

static brio_status check_items(brio_stream *s, brio_las_header *h, const char *bytes, size_t count) {
    brio_status status = BRIO_OK;
    laz_item items[MOST_ITEMS];
    size_t expected = items_of(h, items);
    bool layered = h->format >= 6;
    BRIO_REQUIRE(s->ctx, expected, BRIO_ERR_FORMAT, "%s: compressed points of format %u: waveforms are not read",
                 s->name, h->format);
    BRIO_REQUIRE(s->ctx, count == expected, BRIO_ERR_FORMAT,
                 "%s: LASzip's record lists %zu items, point format %u has %zu", s->name, count, h->format, expected);
    for (size_t i = 0; i < count; i++, bytes += 6) {
        unsigned type = brio_le16(bytes), size = brio_le16(bytes + 2), version = brio_le16(bytes + 4);
        BRIO_REQUIRE(s->ctx, type == items[i].type && size == items[i].size, BRIO_ERR_FORMAT,
                     "%s: LASzip's record: item %zu has type %u and %u bytes, expected type %u and %u bytes", s->name,
                     i, type, size, items[i].type, items[i].size);
        BRIO_REQUIRE(s->ctx, layered ? version == 3 || version == 4 : version == 2, BRIO_ERR_FORMAT,
                     "%s: LASzip's record: item %zu has version %u, expected %s", s->name, i, version,
                     layered ? "3 or 4" : "2");
        h->form.own_colours = version == 4;
    }
    h->form.format = h->format;
    h->form.record = h->record;
    h->form.num_extra = h->record - record_bytes[h->format];
    h->form.layered = layered;
done:
    return status;
}

static brio_status take_laszip(brio_stream *s, brio_las_header *h, const char *bytes, size_t size) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(s->ctx, size >= 34, BRIO_ERR_FORMAT, "%s: LASzip's record has %zu bytes, expected 34 or more", s->name,
                 size);
    unsigned compressor = brio_le16(bytes), coder = brio_le16(bytes + 2);
    size_t count = brio_le16(bytes + 32);
    BRIO_REQUIRE(s->ctx,
                 coder == 0 && compressor == (h->format >= 6    ? 3
                                              : compressor == 1 ? 1
                                                                : 2),
                 BRIO_ERR_FORMAT, "%s: LASzip's record: compressor %u with coder %u for point format %u is not known",
                 s->name, compressor, coder, h->format);
    BRIO_REQUIRE(s->ctx, size >= 34 + 6 * count, BRIO_ERR_FORMAT,
                 "%s: LASzip's record has %zu bytes, %zu items need %zu", s->name, size, count, 34 + 6 * count);
    h->chunked = compressor != 1;
    h->chunk = brio_le32(bytes + 12);
    BRIO_REQUIRE(s->ctx, h->chunk, BRIO_ERR_FORMAT, "%s: LASzip's record: chunks of 0 points", s->name);
    BRIO_TRY(check_items(s, h, bytes + 34, count));
done:
    return status;
}

/* --- records of variable length --- */

static bool is_record(const char *header, const char *user, unsigned id) {
    return !strncmp(header + 2, user, 16) && brio_le16(header + 18) == id;
}

/* Reads one record.   found  whether LASzip's record was read. */
static brio_status read_record(brio_stream *s, brio_las_header *h, bool *found) {
    brio_status status = BRIO_OK;
    char header[RECORD_HEADER];
    const char *bytes = NULL;
    BRIO_TRY(brio_stream_take(s, RECORD_HEADER, &bytes));
    memcpy(header, bytes, RECORD_HEADER);
    size_t size = brio_le16(header + 20);
    BRIO_TRY(brio_stream_take(s, size, &bytes));
    if (h->compressed && is_record(header, "laszip encoded", LASZIP)) {
        BRIO_TRY(take_laszip(s, h, bytes, size));
        *found = true;
    } else if (is_record(header, "LASF_Spec", EXTRA_BYTES)) {
        BRIO_TRY(take_extras(s, h, bytes, size));
    }
done:
    return status;
}

brio_status brio_las_header_read(brio_stream *s, brio_las_header *h) {
    brio_status status = BRIO_OK;
    uint32_t num_records = 0;
    uint64_t start = brio_stream_offset(s);
    bool found = false;
    *h = (brio_las_header){.minor = 0};
    BRIO_TRY(read_fixed(s, h, &num_records));
    brio_stream_element(s, "record of variable length", num_records);
    for (; s->row < num_records && brio_stream_offset(s) - start + RECORD_HEADER <= h->data; s->row++)
        BRIO_TRY(read_record(s, h, &found));
    uint64_t at = brio_stream_offset(s) - start;
    BRIO_REQUIRE(s->ctx, at <= h->data, BRIO_ERR_FORMAT,
                 "%s: byte 96: the points begin at byte %" PRIu64 ", the records before them end at byte %" PRIu64,
                 s->name, h->data, at);
    BRIO_REQUIRE(s->ctx, found || !h->compressed, BRIO_ERR_FORMAT, "%s: compressed, without LASzip's record", s->name);
    brio_stream_element(s, "byte before the points", h->data);
    BRIO_TRY(brio_stream_skip(s, h->data - at));
done:
    return status;
}

void brio_las_header_free(brio_context *ctx, brio_las_header *h) {
    brio_release(ctx, h->extras);
    h->extras = NULL;
}
