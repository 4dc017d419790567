/* Records of variable length of LAS files, before the points or behind them: what each is for.
 *
 * Two say how to read the points: LASzip's, and the descriptions of extra bytes. Coordinate systems and all that is true of
 * the file without its points become metadata of the mesh. Indices of the points and descriptions of waveforms are left out
 * and named: they are wrong for a file that brio writes.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. Hobu. COPC specification 1.0. 2021. */
#include "base/memory.h"
#include "io/crs.h"
#include "io/las/las_header.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { LASZIP = 22204, EXTRA_BYTES = 4, WKT = 2112, FIRST_KEYS = 34735, LAST_KEYS = 34737 };
enum { FIRST_WAVE = 100, LAST_WAVE = 354, WAVES = 65535, TREE = 30, MOST_RECORD = 1 << 28 /* bytes; chosen */ };

static bool is_record(const char *header, const char *user, unsigned first, unsigned last) {
    unsigned id = brio_le16(header + BRIO_RECORD_ID);
    return !strncmp(header + BRIO_RECORD_USER, user, 16) && id >= first && id <= last;
}

static brio_status keep(brio_context *ctx, brio_las_records *records, const char *header, const char *bytes,
                        size_t size) {
    brio_status status = BRIO_OK;
    size_t need = records->size + BRIO_RECORD_HEADER + size;
    BRIO_TRY(BRIO_RESERVE(ctx, records->bytes, records->capacity, need));
    memcpy(records->bytes + records->size, header, BRIO_RECORD_HEADER);
    memcpy(records->bytes + records->size + BRIO_RECORD_HEADER, bytes, size);
    records->size = need;
done:
    return status;
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
    brio_status status = BRIO_OK;
    if (is_record(header, "laszip encoded", LASZIP, LASZIP)) {
        if (h->compressed && !h->has_form) BRIO_TRY(brio_laz_form_read(s, h, bytes, size));
        h->has_form = h->compressed;
    } else if (is_record(header, "LASF_Spec", EXTRA_BYTES, EXTRA_BYTES)) {
        BRIO_TRY(brio_las_take_extras(b, h, bytes, size));
    } else if (is_record(header, "LASF_Projection", FIRST_KEYS, LAST_KEYS)) {
        BRIO_TRY(keep(b->ctx, &h->keys, header, bytes, size));
    } else if (is_record(header, "LASF_Projection", WKT, WKT) && length_of(bytes, size) &&
               !brio_mesh_metadata(b->mesh, "crs.wkt")) {
        BRIO_TRY(brio_mesh_set_metadata(b->mesh, "crs.wkt", bytes, length_of(bytes, size)));
    } else {
        BRIO_TRY(keep(b->ctx, &h->others, header, bytes, size));
    }
done:
    return status;
}

/* Names a record that is too large to keep, or whose end is missing. */
static brio_status leave_out(brio_builder *b, const char *header, const char *why) {
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

brio_status brio_las_records_read(brio_stream *s, brio_builder *b, brio_las_header *h, uint32_t count, uint64_t start) {
    brio_status status = BRIO_OK;
    brio_stream_element(s, "record of variable length", count);
    for (; s->row < count && brio_stream_offset(s) - start + BRIO_LAS_RECORD_HEADER <= h->data; s->row++) {
        char header[BRIO_RECORD_HEADER];
        const char *bytes = NULL;
        BRIO_TRY(brio_stream_take(s, BRIO_LAS_RECORD_HEADER, &bytes));
        lengthen(bytes, header);
        size_t size = brio_le16(bytes + BRIO_RECORD_SIZE);
        BRIO_TRY(brio_stream_take(s, size, &bytes));
        if (dropped(header))
            BRIO_TRY(brio_builder_leave_out(b, dropped(header)));
        else
            BRIO_TRY(take_record(s, b, h, header, bytes, size));
    }
done:
    return status;
}

/* --- behind the points --- */

/* Returns `size` bytes from a place of the file in *bytes. A pipe's place is never before what was read of it.
 *  memory  for a file that is no pipe: owned by the caller (brio_release). */
static brio_status fetch(brio_stream *s, const brio_las_header *h, uint64_t at, size_t size, char **memory,
                         const char **bytes) {
    brio_status status = BRIO_OK;
    if (h->late_pending) {
        BRIO_TRY(brio_stream_skip(s, at - brio_stream_offset(s)));
        return brio_stream_take(s, size, bytes);
    }
    BRIO_TRY(BRIO_RESIZE(s->ctx, *memory, size + 1));
    BRIO_TRY(brio_stream_peek(s, at, *memory, size));
    *bytes = *memory;
done:
    return status;
}

/* Whether a file has the bytes. A pipe is taken to have them. */
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
    if (*ended && !dropped(header)) BRIO_TRY(leave_out(b, header, ", which ends early"));
    if (*ended || dropped(header)) goto done;
    if (size > MOST_RECORD) {
        BRIO_TRY(leave_out(b, header, ""));
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
    brio_status status = BRIO_OK;
    uint64_t at = h->late;
    bool ended = false;
    brio_stream_element(s, "record behind the points", h->num_late);
    for (uint32_t i = 0; i < h->num_late && !ended; i++) BRIO_TRY(read_late(s, b, h, &at, &ended));
done:
    return status;
}

/* --- metadata --- */

brio_status brio_las_records_give(brio_builder *b, const brio_las_header *h) {
    brio_status status = BRIO_OK;
    brio_mesh *m = b->mesh;
    if (h->keys.size) BRIO_TRY(brio_mesh_set_metadata(m, "crs.geokeys", h->keys.bytes, h->keys.size));
    if (h->others.size) BRIO_TRY(brio_mesh_set_metadata(m, "las.records", h->others.bytes, h->others.size));
    BRIO_TRY(brio_crs_describe(m));
done:
    return status;
}
