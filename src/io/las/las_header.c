/* Reads the header of a LAS file of version 1.0 to 1.5.
 *
 * Version 1.5 may count times from an own origin: they become adjusted standard GPS times, which all versions know.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. ASPRS. LAS specification 1.5. 2025. */
#include "io/las/las.h"
#include "base/memory.h"
#include "base/utf8.h"
#include "io/crs.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- extra bytes --- */

/* Descriptions of extra bytes: the numbers of a record behind the fields of its format.
 *
 * Descriptions come in records of variable length, of which there may be several, before the points or behind them: all
 * of them are one list, and the numbers lie in its order. What a description does not give, or the record has no room
 * for, is left out and named.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */

enum { TYPES = 10 /* of one number; the next ten are two numbers, the last ten three */, MOST_TYPE = 3 * TYPES };
/* no-data, least, greatest value, scale, offset: three numbers of 8 bytes each */
enum { TRIPLES = 40, TRIPLE = 24, NUM_TRIPLES = 5 };

size_t brio_las_extra_bytes(unsigned type) {
    static const uint8_t bytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return type < sizeof bytes ? bytes[type] : 0;
}

/* Names what is not read: NAME (WHY). */
static brio_status leave_out(brio_builder *b, const char *bytes, const char *why) {
    char name[BRIO_LAS_NAME + 1], text[128];
    snprintf(name, sizeof name, "%.32s", bytes + BRIO_EXTRA_NAME);
    snprintf(text, sizeof text, "%s (%s)", name[0] ? name : "extra bytes", why);
    return brio_builder_leave_out(b, text);
}

/* Adds number `which` of the `count` numbers of one description. */
static brio_status add_extra(brio_builder *b, brio_las_header *h, const char *bytes, unsigned which, unsigned count) {
    unsigned options = (uint8_t)bytes[BRIO_EXTRA_OPTIONS];
    brio_las_extra e = {.type = ((uint8_t)bytes[BRIO_EXTRA_TYPE] - 1u) % TYPES + 1, .scale = 1};
    char name[BRIO_LAS_NAME + 1];
    memcpy(e.description, bytes, sizeof e.description);
    e.description[BRIO_EXTRA_TYPE] = (char)e.type;
    for (size_t i = 0; i < NUM_TRIPLES; i++) {
        char *triple = e.description + TRIPLES + TRIPLE * i;
        memcpy(triple, bytes + TRIPLES + TRIPLE * i + 8 * which, 8);
        memset(triple + 8, 0, TRIPLE - 8);
    }
    e.scaled = options & (BRIO_EXTRA_SCALED | BRIO_EXTRA_SHIFTED);
    if (options & BRIO_EXTRA_SCALED) e.scale = brio_le_double(e.description + BRIO_EXTRA_SCALE);
    if (options & BRIO_EXTRA_SHIFTED) e.offset = brio_le_double(e.description + BRIO_EXTRA_OFFSET);
    e.at = h->described + which * brio_las_extra_bytes(e.type);
    snprintf(name, sizeof name, "%.32s", bytes + BRIO_EXTRA_NAME);
    brio_utf8_copy(e.name, sizeof e.name, name[0] ? name : "extra_bytes");
    if (count > 1) brio_numbered_name(e.name, sizeof e.name, name[0] ? name : "extra_bytes", which);
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, h->extras, h->extra_capacity, h->num_extras + 1));
    h->extras[h->num_extras++] = e;
    return BRIO_OK;
}

/* Takes descriptions of extra bytes: a record's payload. Several records are one list. */
static brio_status las_take_extras(brio_builder *b, brio_las_header *h, const char *bytes, size_t size) {
    size_t room = h->record - brio_las_record_bytes(h->format);
    for (; size >= BRIO_LAS_EXTRA; size -= BRIO_LAS_EXTRA, bytes += BRIO_LAS_EXTRA) {
        unsigned type = (uint8_t)bytes[BRIO_EXTRA_TYPE], count = type ? (type - 1) / TYPES + 1 : 1;
        size_t width = type ? brio_las_extra_bytes((type - 1) % TYPES + 1) : (uint8_t)bytes[BRIO_EXTRA_OPTIONS];
        h->closed |= type > MOST_TYPE || count * width > room - h->described;
        if (h->closed) {
            BRIO_FORWARD(
                leave_out(b, bytes, type > MOST_TYPE ? "extra bytes of a reserved type" : "not in the records"));
            continue;
        }
        for (unsigned i = 0; i < count && type; i++) BRIO_FORWARD(add_extra(b, h, bytes, i, count));
        if (!type) BRIO_FORWARD(leave_out(b, bytes, "extra bytes without a type"));
        h->described += count * width;
    }
    return BRIO_OK;
}

/* Names the extra bytes of which nothing was said. */
static brio_status las_end_extras(brio_builder *b, const brio_las_header *h) {
    if (h->record - brio_las_record_bytes(h->format) == h->described) return BRIO_OK;
    return brio_builder_leave_out(b, "extra bytes that nothing describes");
}

/* --- records of variable length --- */

/* Records of variable length of LAS files, before the points or behind them: what each is for.
 *
 * Two say how to read the points: LASzip's, and the descriptions of extra bytes. Coordinate systems and all that is
 * true of the file without its points become metadata of the mesh. Indices of the points and descriptions of waveforms
 * are left out and named: they are wrong for a file that brio writes.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. Hobu. COPC specification 1.0. 2021. */

enum { LASZIP = 22204, EXTRA_BYTES = 4, WKT = 2112, FIRST_KEYS = 34735, LAST_KEYS = 34737 };
enum { FIRST_WAVE = 100, LAST_WAVE = 354, WAVES = 65535, TREE = 30, MOST_RECORD = 1 << 28 /* bytes; chosen */ };

static bool is_record(const char *header, const char *user, unsigned first, unsigned last) {
    unsigned id = brio_le16(header + BRIO_RECORD_ID);
    return !strncmp(header + BRIO_RECORD_USER, user, 16) && id >= first && id <= last;
}

static brio_status keep(brio_context *ctx, brio_las_records *records, const char *header, const char *bytes,
                        size_t size) {
    size_t need = records->size + BRIO_RECORD_HEADER + size;
    BRIO_FORWARD(BRIO_RESERVE(ctx, records->bytes, records->capacity, need));
    memcpy(records->bytes + records->size, header, BRIO_RECORD_HEADER);
    memcpy(records->bytes + records->size + BRIO_RECORD_HEADER, bytes, size);
    records->size = need;
    return BRIO_OK;
}

/* Returns the name of what a record belongs to that is not kept, or NULL. */
static const char *dropped(const char *header) {
    if (is_record(header, "LASF_Spec", FIRST_WAVE, LAST_WAVE) || is_record(header, "LASF_Spec", WAVES, WAVES))
        return "waveforms";
    if (is_record(header, "copc", 0, UINT16_MAX)) return "COPC index";
    if (is_record(header, "LAStools", TREE, TREE)) return "LAStools index";
    return NULL;
}

static size_t length_of(const char *text, size_t size) {
    const char *end = memchr(text, 0, size);
    return end ? (size_t)(end - text) : size;
}

static brio_status take_record(brio_stream *s, brio_builder *b, brio_las_header *h, const char *header,
                               const char *bytes, size_t size) {
    if (is_record(header, "laszip encoded", LASZIP, LASZIP)) {
        if (h->compressed && !h->has_form) BRIO_FORWARD(brio_laz_form_read(s, h, bytes, size));
        h->has_form = h->compressed;
    } else if (is_record(header, "LASF_Spec", EXTRA_BYTES, EXTRA_BYTES)) {
        BRIO_FORWARD(las_take_extras(b, h, bytes, size));
    } else if (is_record(header, "LASF_Projection", FIRST_KEYS, LAST_KEYS)) {
        BRIO_FORWARD(keep(b->ctx, &h->keys, header, bytes, size));
    } else if (is_record(header, "LASF_Projection", WKT, WKT) && length_of(bytes, size) &&
               !brio_mesh_metadata(b->mesh, "crs.wkt")) {
        BRIO_FORWARD(brio_mesh_set_metadata(b->mesh, "crs.wkt", bytes, length_of(bytes, size)));
    } else {
        BRIO_FORWARD(keep(b->ctx, &h->others, header, bytes, size));
    }
    return BRIO_OK;
}

/* Names a record that is too large to keep, or whose end is missing. */
static brio_status leave_record_out(brio_builder *b, const char *header, const char *why) {
    char text[64];
    snprintf(text, sizeof text, "record %.16s/%u%s", header + BRIO_RECORD_USER,
             (unsigned)brio_le16(header + BRIO_RECORD_ID), why);
    return brio_builder_leave_out(b, text);
}

/* --- before the points --- */

/* Makes the header of a record that stands before the points one of a record behind them. */
static void lengthen(const char *early, char header[BRIO_RECORD_HEADER]) {
    memcpy(header, early, BRIO_RECORD_SIZE);
    brio_put_le64(header + BRIO_RECORD_SIZE, brio_le16(early + BRIO_RECORD_SIZE));
    memcpy(header + BRIO_RECORD_TEXT, early + BRIO_RECORD_SIZE + 2, BRIO_RECORD_HEADER - BRIO_RECORD_TEXT);
}

/* Reads the records before the points. */
static brio_status las_records_read(brio_stream *s, brio_builder *b, brio_las_header *h, uint32_t count,
                                    uint64_t start) {
    brio_stream_element(s, "record of variable length", count);
    for (; s->row < count && brio_stream_offset(s) - start + BRIO_LAS_RECORD_HEADER <= h->data; s->row++) {
        char header[BRIO_RECORD_HEADER];
        const char *bytes = NULL;
        BRIO_FORWARD(brio_stream_take(s, BRIO_LAS_RECORD_HEADER, &bytes));
        lengthen(bytes, header);
        size_t size = brio_le16(bytes + BRIO_RECORD_SIZE);
        BRIO_FORWARD(brio_stream_take(s, size, &bytes));
        if (dropped(header))
            BRIO_FORWARD(brio_builder_leave_out(b, dropped(header)));
        else
            BRIO_FORWARD(take_record(s, b, h, header, bytes, size));
    }
    return BRIO_OK;
}

/* --- behind the points --- */

/* Returns `size` bytes from a place of the file in *bytes. A pipe's place is never before what was read of it.
 *  memory  for a file that is no pipe: owned by the caller (brio_release). */
static brio_status fetch(brio_stream *s, const brio_las_header *h, uint64_t at, size_t size, char **memory,
                         const char **bytes) {
    if (h->late_pending) {
        BRIO_FORWARD(brio_stream_skip(s, at - brio_stream_offset(s)));
        return brio_stream_take(s, size, bytes);
    }
    BRIO_FORWARD(BRIO_RESIZE(s->ctx, *memory, size + 1));
    BRIO_FORWARD(brio_stream_peek(s, at, *memory, size));
    *bytes = *memory;
    return BRIO_OK;
}

/* Returns whether a file has the bytes. A pipe is taken to have them. */
static bool has(const brio_stream *s, uint64_t at, uint64_t size) {
    return s->size == BRIO_SIZE_UNKNOWN ? at <= UINT64_MAX - size : at <= s->size && size <= s->size - at;
}

/* Reads the record at *at and moves *at behind it.   ended  receives whether the file ends before. */
static brio_status read_late(brio_stream *s, brio_builder *b, brio_las_header *h, uint64_t *at, bool *ended) {
    brio_status status = BRIO_OK;
    char header[BRIO_RECORD_HEADER], *memory = NULL;
    const char *bytes = NULL;
    *ended = !has(s, *at, sizeof header) || (h->late_pending && *at < brio_stream_offset(s));
    if (*ended) return brio_builder_leave_out(b, "records behind the points, which end early");
    BRIO_TRY(fetch(s, h, *at, sizeof header, &memory, &bytes));
    memcpy(header, bytes, sizeof header);
    *at += sizeof header;
    uint64_t size = brio_le64(header + BRIO_RECORD_SIZE);
    if (dropped(header)) BRIO_TRY(brio_builder_leave_out(b, dropped(header)));
    *ended = !has(s, *at, size);
    if (*ended && !dropped(header)) BRIO_TRY(leave_record_out(b, header, ", which ends early"));
    if (*ended || dropped(header)) goto done;
    if (size > MOST_RECORD) {
        BRIO_TRY(leave_record_out(b, header, ""));
    } else if (h->late_pending && is_record(header, "LASF_Spec", EXTRA_BYTES, EXTRA_BYTES)) {
        BRIO_TRY(brio_builder_leave_out(b, "descriptions of extra bytes behind the points of a pipe"));
    } else {
        BRIO_TRY(fetch(s, h, *at, (size_t)size, &memory, &bytes));
        BRIO_TRY(take_record(s, b, h, header, bytes, (size_t)size));
    }
done:
    *at += status == BRIO_OK && !*ended ? brio_le64(header + BRIO_RECORD_SIZE) : 0;
    brio_release(s->ctx, memory);
    return status;
}

brio_status brio_las_late_records_read(brio_stream *s, brio_builder *b, brio_las_header *h) {
    uint64_t at = h->late;
    bool ended = false;
    brio_stream_element(s, "record behind the points", h->num_late);
    for (uint32_t i = 0; i < h->num_late && !ended; i++) BRIO_FORWARD(read_late(s, b, h, &at, &ended));
    return BRIO_OK;
}

/* --- metadata --- */

brio_status brio_las_records_give(brio_builder *b, const brio_las_header *h) {
    brio_mesh *m = b->mesh;
    if (h->keys.size) BRIO_FORWARD(brio_mesh_set_metadata(m, "crs.geokeys", h->keys.bytes, h->keys.size));
    if (h->others.size) BRIO_FORWARD(brio_mesh_set_metadata(m, "las.records", h->others.bytes, h->others.size));
    return brio_crs_describe(m);
}

/* --- formats --- */

enum { LEAST_HEADER = 227, HEADER_1_4 = 375, HEADER_1_5 = 393, MOST_MINOR = 5 };
enum { STANDARD_TIME = 1, SYNTHETIC_RETURNS = 8, SHIFTED_TIME = 64 /* bits of the global encoding */ };

static const uint8_t record_bytes[BRIO_LAS_FORMATS] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

size_t brio_las_record_bytes(unsigned format) {
    return record_bytes[format];
}

/* Returns whether the records of a format have waveforms. */
static bool las_has_waves(unsigned format) {
    return format == 4 || format == 5 || format >= 9;
}

/* --- the header --- */

static brio_status check_header(brio_stream *s, const brio_las_header *h) {
    BRIO_EXPECT(s->ctx, h->format < BRIO_LAS_FORMATS, BRIO_ERR_FORMAT,
                "%s: byte 104: point format %u, expected 0 to 10", s->name, h->format);
    BRIO_EXPECT(s->ctx, h->record >= record_bytes[h->format], BRIO_ERR_FORMAT,
                "%s: byte 105: records of %zu bytes, point format %u has %u", s->name, h->record, h->format,
                record_bytes[h->format]);
    for (int k = 0; k < 3; k++)
        BRIO_EXPECT(s->ctx, isfinite(h->scale[k]) && isfinite(h->offset[k]) && h->scale[k] != 0, BRIO_ERR_FORMAT,
                    "%s: byte %d: %c has scale %g and offset %g", s->name, 131 + 8 * k, "xyz"[k], h -> scale[k],
                    h -> offset[k]);
    return BRIO_OK;
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
    if (h->minor >= 4 && size >= HEADER_1_4) {
        h->late = brio_le64(bytes + 235);
        h->num_late = brio_le32(bytes + 243);
    }
    /* times count from 10^9 s behind the origin of GPS times, or from that many 10^6 s as the header says */
    if (brio_le16(bytes + 6) & SHIFTED_TIME && h->minor >= 5 && size >= HEADER_1_5)
        h->time_shift = ((double)brio_le16(bytes + 391) - 1000) * 1e6;
}

/* --- what the header says of the file --- */

static brio_status give_text(brio_mesh *mesh, const char *name, const char *bytes, const char *standard) {
    char field[33], text[66];
    snprintf(field, sizeof field, "%.32s", bytes);
    brio_utf8_copy(text, sizeof text, field);
    if (!text[0] || !strncmp(text, standard, strlen(standard))) return BRIO_OK;
    return brio_mesh_set_metadata(mesh, name, text, strlen(text));
}

static brio_status give_number(brio_mesh *mesh, const char *name, unsigned number) {
    char text[16];
    if (!number) return BRIO_OK;
    return brio_mesh_set_metadata(mesh, name, text, (size_t)snprintf(text, sizeof text, "%u", number));
}

/* Gives the mesh what the header says, except what brio itself writes where nothing is known. */
static brio_status give_facts(brio_mesh *mesh, const char *bytes) {
    static const char no_project[16];
    unsigned day = brio_le16(bytes + 90), year = brio_le16(bytes + 92), encoding = brio_le16(bytes + 6);
    char text[40];
    size_t used = 0;
    BRIO_FORWARD(give_text(mesh, "las.system", bytes + 26, "OTHER"));
    BRIO_FORWARD(give_text(mesh, "las.software", bytes + 58, "brio "));
    BRIO_FORWARD(give_number(mesh, "las.source", brio_le16(bytes + 4)));
    if (day || year) {
        used = (size_t)snprintf(text, sizeof text, "%u-%03u", year, day);
        BRIO_FORWARD(brio_mesh_set_metadata(mesh, "las.date", text, used));
    }
    used = 0;
    for (int i = 0; i < 16; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%02x", (uint8_t)bytes[8 + i]);
    if (memcmp(bytes + 8, no_project, sizeof no_project))
        BRIO_FORWARD(brio_mesh_set_metadata(mesh, "las.project", text, used));
    if (encoding & STANDARD_TIME) BRIO_FORWARD(brio_mesh_set_metadata(mesh, "las.gps_time", "standard", 8));
    if (encoding & SYNTHETIC_RETURNS) BRIO_FORWARD(brio_mesh_set_metadata(mesh, "las.returns", "synthetic", 9));
    return BRIO_OK;
}

/* Reads the fixed part.   num_records  receives the number of records of variable length. */
static brio_status read_fixed(brio_stream *s, brio_builder *b, brio_las_header *h, uint32_t *num_records) {
    const char *bytes = NULL;
    brio_stream_element(s, "header", 1);
    BRIO_FORWARD(brio_stream_fill(s, LEAST_HEADER));
    bytes = s->buffer + s->begin;
    BRIO_EXPECT(s->ctx, brio_stream_left(s) < 4 || !memcmp(bytes, "LASF", 4), BRIO_ERR_FORMAT,
                "%s: byte 0: expected LASF: not a LAS or LAZ file", s->name);
    if (brio_stream_left(s) < LEAST_HEADER) return brio_stream_truncated(s);
    size_t size = brio_le16(bytes + 94);
    BRIO_EXPECT(s->ctx, bytes[24] == 1 && (uint8_t)bytes[25] <= MOST_MINOR, BRIO_ERR_FORMAT,
                "%s: byte 24: version %u.%u, expected 1.0 to 1.5", s->name, (uint8_t)bytes[24], (uint8_t)bytes[25]);
    BRIO_EXPECT(s->ctx, size >= LEAST_HEADER, BRIO_ERR_FORMAT, "%s: byte 94: a header of %zu bytes, expected %d",
                s->name, size, LEAST_HEADER);
    BRIO_FORWARD(brio_stream_take(s, size, &bytes));
    take_fields(h, bytes, size);
    *num_records = brio_le32(bytes + 100);
    BRIO_EXPECT(s->ctx, h->data >= size, BRIO_ERR_FORMAT,
                "%s: byte 96: the points begin at byte %" PRIu64 ", within the header", s->name, h->data);
    BRIO_FORWARD(give_facts(b->mesh, bytes));
    return check_header(s, h);
}

brio_status brio_las_header_read(brio_stream *s, brio_builder *b, brio_las_header *h) {
    uint32_t num_records = 0;
    uint64_t start = brio_stream_offset(s);
    *h = (brio_las_header){.minor = 0};
    BRIO_FORWARD(read_fixed(s, b, h, &num_records));
    BRIO_FORWARD(las_records_read(s, b, h, num_records, start));
    uint64_t at = brio_stream_offset(s) - start;
    BRIO_EXPECT(s->ctx, at <= h->data, BRIO_ERR_FORMAT,
                "%s: byte 96: the points begin at byte %" PRIu64 ", the records before them end at byte %" PRIu64,
                s->name, h->data, at);
    BRIO_EXPECT(s->ctx, h->has_form || !h->compressed, BRIO_ERR_FORMAT, "%s: compressed, without LASzip's record",
                s->name);
    h->late_pending = s->size == BRIO_SIZE_UNKNOWN && h->num_late;
    if (!h->late_pending) BRIO_FORWARD(brio_las_late_records_read(s, b, h));
    BRIO_FORWARD(las_end_extras(b, h));
    if (las_has_waves(h->format)) BRIO_FORWARD(brio_builder_leave_out(b, "waveforms"));
    BRIO_FORWARD(brio_las_records_give(b, h));
    brio_stream_element(s, "byte before the points", h->data);
    return brio_stream_skip(s, h->data - at);
}

void brio_las_header_free(brio_context *ctx, brio_las_header *h) {
    brio_release(ctx, h->extras);
    brio_release(ctx, h->keys.bytes);
    brio_release(ctx, h->others.bytes);
    h->extras = NULL;
    h->keys.bytes = h->others.bytes = NULL;
}
