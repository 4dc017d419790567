/* The XML of a VTU file, read tag by tag. Text between tags is skipped, because arrays are read only from appended
 * data. */
#include "io/vtk/vtu_header.h"
#include "base/memory.h"
#include "io/number.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <string.h>

/* Most bytes of a tag. Chosen. */
enum { MAX_TAG = 1 << 20 };

static const char *const type_names[BRIO_VTU_TYPE_END] = {"Int8",   "UInt8",   "Int16",   "UInt16", "Int32",
                                                          "UInt32", "Float32", "Float64", "Int64",  "UInt64"};

size_t brio_vtu_type_size(int type) {
    return type < BRIO_SCALAR_END ? brio_scalar_size((brio_scalar)type) : 8;
}

static brio_status bad(brio_stream *s, const char *expected) {
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected %s", s->name, brio_stream_offset(s),
                     expected);
}

/* --- tags --- */

/* Skips to the next `mark`. Fails if there is none. */
static brio_status skip_to(brio_stream *s, char mark, const char *expected) {
    brio_status status = BRIO_OK;
    for (;;) {
        BRIO_TRY(brio_stream_fill(s, 1));
        size_t left = brio_stream_left(s);
        if (!left) return bad(s, expected);
        const char *start = s->buffer + s->begin, *found = memchr(start, mark, left);
        s->begin += found ? (size_t)(found - start) : left;
        if (found) return BRIO_OK;
    }
done:
    return status;
}

/* Finds the length of the tag that begins here, up to its '>'. The tag of a comment ends with "-->". */
static brio_status tag_length(brio_stream *s, size_t *length) {
    brio_status status = BRIO_OK;
    for (size_t n = 1;; n++) {
        if (brio_stream_left(s) <= n) BRIO_TRY(brio_stream_fill(s, n + 1));
        if (brio_stream_left(s) <= n || n > MAX_TAG) return bad(s, "a tag with its end");
        const char *tag = s->buffer + s->begin;
        if (tag[n] != '>') continue;
        bool comment = n >= 3 && !memcmp(tag, "<!--", 4);
        if (comment && (n < 6 || tag[n - 1] != '-' || tag[n - 2] != '-')) continue;
        *length = n;
        return BRIO_OK;
    }
done:
    return status;
}

/* Returns the next tag in *tag, without < and >, with a 0 at its end. */
static brio_status next_tag(brio_stream *s, const char **tag) {
    brio_status status = BRIO_OK;
    size_t length = 0;
    BRIO_TRY(skip_to(s, '<', "a tag AppendedData"));
    BRIO_TRY(tag_length(s, &length));
    char *start = s->buffer + s->begin;
    start[length] = 0;
    *tag = start + 1;
    s->begin += length + 1;
done:
    return status;
}

static bool is_tag(const char *tag, const char *name) {
    size_t length = strlen(name);
    return !strncmp(tag, name, length) && (!tag[length] || brio_is_blank(tag[length]) || tag[length] == '/');
}

static const char *unescape(const char *p, char *out) {
    static const char *const escapes[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
    for (int i = 0; i < 5; i++) {
        size_t length = strlen(escapes[i]);
        if (strncmp(p, escapes[i], length) != 0) continue;
        *out = "&<>\"'"[i];
        return p + length;
    }
    *out = *p;
    return p + 1;
}

/* Copies the value of an attribute of a tag, at most 63 characters. Returns false if the tag has no such attribute. */
static bool attribute(const char *tag, const char *name, char value[64]) {
    size_t length = strlen(name), n = 0;
    for (const char *p = tag; (p = strstr(p, name)) != NULL; p += length) {
        const char *q = p + length;
        if (p == tag || !brio_is_blank(p[-1]) || q[0] != '=' || (q[1] != '"' && q[1] != '\'')) continue;
        char quote = q[1];
        for (q += 2; *q && *q != quote && n < 63; n++) q = unescape(q, &value[n]);
        value[n] = 0;
        return true;
    }
    return false;
}

static bool attribute_is(const char *tag, const char *name, const char *expected) {
    char value[64];
    return attribute(tag, name, value) && !strcmp(value, expected);
}

static brio_status attribute_count(brio_stream *s, const char *tag, const char *name, uint64_t *count) {
    char value[64] = "";
    const char *p = value;
    if (attribute(tag, name, value) && brio_parse_count(&p, count) && !*p) return BRIO_OK;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected a number %s, found \"%s\"", s->name,
                     brio_stream_offset(s), name, brio_excerpt_of(value).text);
}

/* --- what the tags say --- */

static brio_status read_file_tag(brio_stream *s, brio_vtu_header *h, const char *tag) {
    char value[64];
    if (!attribute_is(tag, "type", "UnstructuredGrid")) return bad(s, "a VTKFile of type UnstructuredGrid");
    if (attribute(tag, "compressor", value)) return bad(s, "arrays that are not compressed");
    bool little = attribute_is(tag, "byte_order", "LittleEndian");
    if (!little && !attribute_is(tag, "byte_order", "BigEndian")) return bad(s, "byte_order LittleEndian or BigEndian");
    h->swap = little != brio_host_is_little();
    h->word = attribute_is(tag, "header_type", "UInt64") ? 8 : 4;
    return BRIO_OK;
}

static brio_status read_piece(brio_stream *s, brio_vtu_header *h, const char *tag) {
    brio_status status = BRIO_OK;
    if (h->piece) return bad(s, "one Piece only");
    h->piece = true;
    BRIO_TRY(attribute_count(s, tag, "NumberOfPoints", &h->num_points));
    BRIO_TRY(attribute_count(s, tag, "NumberOfCells", &h->num_cells));
done:
    return status;
}

static brio_status read_array(brio_stream *s, brio_vtu_header *h, const char *tag) {
    brio_status status = BRIO_OK;
    char value[64];
    brio_vtu_array array = {.section = h->section, .components = 1};
    if (h->section == BRIO_VTU_OTHER) return BRIO_OK;
    if (!attribute_is(tag, "format", "appended")) return bad(s, "a DataArray of format appended");
    while (array.type < BRIO_VTU_TYPE_END && !attribute_is(tag, "type", type_names[array.type])) array.type++;
    if (array.type == BRIO_VTU_TYPE_END) return bad(s, "a DataArray of type Int8 to UInt64, Float32 or Float64");
    attribute(tag, "Name", array.name);
    if (attribute(tag, "NumberOfComponents", value))
        BRIO_TRY(attribute_count(s, tag, "NumberOfComponents", &array.components));
    BRIO_TRY(attribute_count(s, tag, "offset", &array.offset));
    if (h->num_arrays && array.offset < h->arrays[h->num_arrays - 1].offset) return bad(s, "arrays in order of offset");
    BRIO_TRY(BRIO_RESERVE(s->ctx, h->arrays, h->array_capacity, h->num_arrays + 1));
    h->arrays[h->num_arrays++] = array;
done:
    return status;
}

static brio_status read_tag(brio_stream *s, brio_vtu_header *h, const char *tag) {
    static const struct {
        const char *name;
        brio_vtu_section section;
    } sections[] = {{"Points", BRIO_VTU_POINTS},
                    {"PointData", BRIO_VTU_POINT_DATA},
                    {"Cells", BRIO_VTU_CELLS},
                    {"CellData", BRIO_VTU_OTHER},
                    {"FieldData", BRIO_VTU_OTHER}};
    if (is_tag(tag, "VTKFile")) return read_file_tag(s, h, tag);
    if (is_tag(tag, "Piece")) return read_piece(s, h, tag);
    if (is_tag(tag, "DataArray")) return read_array(s, h, tag);
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++)
        if (is_tag(tag, sections[i].name)) h->section = sections[i].section;
    return BRIO_OK;
}

brio_status brio_vtu_header_read(brio_stream *s, brio_vtu_header *header) {
    brio_status status = BRIO_OK;
    const char *tag;
    *header = (brio_vtu_header){.word = 0};
    for (;;) {
        BRIO_TRY(next_tag(s, &tag));
        if (is_tag(tag, "AppendedData")) break;
        BRIO_TRY(read_tag(s, header, tag));
    }
    if (!attribute_is(tag, "encoding", "raw")) return bad(s, "appended data of encoding raw");
    if (!header->word || !header->piece) return bad(s, "VTKFile and Piece before the appended data");
    BRIO_TRY(skip_to(s, '_', "_ before the appended data"));
    s->begin++;
    header->base = brio_stream_offset(s);
done:
    return status;
}

void brio_vtu_header_free(brio_context *ctx, brio_vtu_header *header) {
    brio_release(ctx, header->arrays);
    header->arrays = NULL;
}
