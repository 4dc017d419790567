/* Reads the header of a LAS file of version 1.0 to 1.5.
 *
 * Version 1.5 may count times from an own origin: they become adjusted standard GPS times, which all versions know.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. ASPRS. LAS specification 1.5. 2025. */
#include "io/las/las_header.h"
#include "base/memory.h"
#include "base/utf8.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LEAST_HEADER = 227, HEADER_1_4 = 375, HEADER_1_5 = 393, MOST_MINOR = 5 };
enum { STANDARD_TIME = 1, SYNTHETIC_RETURNS = 8, SHIFTED_TIME = 64 /* bits of the global encoding */ };

static const uint8_t record_bytes[BRIO_LAS_FORMATS] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

size_t brio_las_record_bytes(unsigned format) {
    return record_bytes[format];
}

bool brio_las_has_waves(unsigned format) {
    return format == 4 || format == 5 || format >= 9;
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
    brio_status status = BRIO_OK;
    static const char no_project[16];
    unsigned day = brio_le16(bytes + 90), year = brio_le16(bytes + 92), encoding = brio_le16(bytes + 6);
    char text[40];
    size_t used = 0;
    BRIO_TRY(give_text(mesh, "las.system", bytes + 26, "OTHER"));
    BRIO_TRY(give_text(mesh, "las.software", bytes + 58, "brio "));
    BRIO_TRY(give_number(mesh, "las.source", brio_le16(bytes + 4)));
    if (day || year) {
        used = (size_t)snprintf(text, sizeof text, "%u-%03u", year, day);
        BRIO_TRY(brio_mesh_set_metadata(mesh, "las.date", text, used));
    }
    used = 0;
    for (int i = 0; i < 16; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%02x", (uint8_t)bytes[8 + i]);
    if (memcmp(bytes + 8, no_project, sizeof no_project))
        BRIO_TRY(brio_mesh_set_metadata(mesh, "las.project", text, used));
    if (encoding & STANDARD_TIME) BRIO_TRY(brio_mesh_set_metadata(mesh, "las.gps_time", "standard", 8));
    if (encoding & SYNTHETIC_RETURNS) BRIO_TRY(brio_mesh_set_metadata(mesh, "las.returns", "synthetic", 9));
done:
    return status;
}

/* Reads the fixed part.   num_records  receives the number of records of variable length. */
static brio_status read_fixed(brio_stream *s, brio_builder *b, brio_las_header *h, uint32_t *num_records) {
    brio_status status = BRIO_OK;
    const char *bytes = NULL;
    brio_stream_element(s, "header", 1);
    BRIO_TRY(brio_stream_fill(s, LEAST_HEADER));
    bytes = s->buffer + s->begin;
    BRIO_REQUIRE(s->ctx, brio_stream_left(s) < 4 || !memcmp(bytes, "LASF", 4), BRIO_ERR_FORMAT,
                 "%s: byte 0: expected LASF: not a LAS or LAZ file", s->name);
    if (brio_stream_left(s) < LEAST_HEADER) return brio_stream_truncated(s);
    size_t size = brio_le16(bytes + 94);
    BRIO_REQUIRE(s->ctx, bytes[24] == 1 && (uint8_t)bytes[25] <= MOST_MINOR, BRIO_ERR_FORMAT,
                 "%s: byte 24: version %u.%u, expected 1.0 to 1.5", s->name, (uint8_t)bytes[24], (uint8_t)bytes[25]);
    BRIO_REQUIRE(s->ctx, size >= LEAST_HEADER, BRIO_ERR_FORMAT, "%s: byte 94: a header of %zu bytes, expected %d",
                 s->name, size, LEAST_HEADER);
    BRIO_TRY(brio_stream_take(s, size, &bytes));
    take_fields(h, bytes, size);
    *num_records = brio_le32(bytes + 100);
    BRIO_REQUIRE(s->ctx, h->data >= size, BRIO_ERR_FORMAT,
                 "%s: byte 96: the points begin at byte %" PRIu64 ", within the header", s->name, h->data);
    BRIO_TRY(give_facts(b->mesh, bytes));
    BRIO_TRY(check_header(s, h));
done:
    return status;
}

brio_status brio_las_header_read(brio_stream *s, brio_builder *b, brio_las_header *h) {
    brio_status status = BRIO_OK;
    uint32_t num_records = 0;
    uint64_t start = brio_stream_offset(s);
    *h = (brio_las_header){.minor = 0};
    BRIO_TRY(read_fixed(s, b, h, &num_records));
    BRIO_TRY(brio_las_records_read(s, b, h, num_records, start));
    uint64_t at = brio_stream_offset(s) - start;
    BRIO_REQUIRE(s->ctx, at <= h->data, BRIO_ERR_FORMAT,
                 "%s: byte 96: the points begin at byte %" PRIu64 ", the records before them end at byte %" PRIu64,
                 s->name, h->data, at);
    BRIO_REQUIRE(s->ctx, h->has_form || !h->compressed, BRIO_ERR_FORMAT, "%s: compressed, without LASzip's record",
                 s->name);
    h->late_pending = s->size == BRIO_SIZE_UNKNOWN && h->num_late;
    if (!h->late_pending) BRIO_TRY(brio_las_late_records_read(s, b, h));
    BRIO_TRY(brio_las_end_extras(b, h));
    if (brio_las_has_waves(h->format)) BRIO_TRY(brio_builder_leave_out(b, "waveforms"));
    BRIO_TRY(brio_las_records_give(b, h));
    brio_stream_element(s, "byte before the points", h->data);
    BRIO_TRY(brio_stream_skip(s, h->data - at));
done:
    return status;
}

void brio_las_header_free(brio_context *ctx, brio_las_header *h) {
    brio_release(ctx, h->extras);
    brio_release(ctx, h->keys.bytes);
    brio_release(ctx, h->others.bytes);
    h->extras = NULL;
    h->keys.bytes = h->others.bytes = NULL;
}
