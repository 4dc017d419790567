/* What the tags of a VTU or VTP file say.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "base/memory.h"
#include "io/number.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include "io/vtk/vtk.h"
#include <inttypes.h>
#include <string.h>

/* --- tags --- */

/* Tags of an XML file. No parser of XML can read a file of VTK, because the bytes behind its tags are no XML.
 *
 * Based on: Bray, Paoli, Sperberg-McQueen, Maler, Yergeau. Extensible markup language (XML) 1.0. W3C 2008. */

/* Most bytes of a tag. Chosen. */
enum { MAX_TAG = 1 << 20 };

brio_status brio_xml_bad(brio_stream *s, const char *expected) {
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected %s", s->name, brio_stream_offset(s),
                     expected);
}

brio_status brio_xml_skip_to(brio_stream *s, char mark, const char *expected) {
    for (;;) {
        BRIO_FORWARD(brio_stream_fill(s, 1));
        size_t left = brio_stream_left(s);
        if (!left) return brio_xml_bad(s, expected);
        const char *start = s->buffer + s->begin, *found = memchr(start, mark, left);
        s->begin += found ? (size_t)(found - start) : left;
        if (found) return BRIO_OK;
    }
    return BRIO_OK;
}

/* Finds the length of the tag that begins here, up to its '>', which does not count between quotes. The tag of a
 * comment ends with "-->". */
static brio_status tag_length(brio_stream *s, size_t *length) {
    char quote = 0;
    for (size_t n = 1;; n++) {
        if (brio_stream_left(s) <= n) BRIO_FORWARD(brio_stream_fill(s, n + 1));
        if (brio_stream_left(s) <= n || n > MAX_TAG) return brio_xml_bad(s, "a tag with its end");
        const char *tag = s->buffer + s->begin;
        bool comment = n >= 3 && !memcmp(tag, "<!--", 4);
        if (!comment && quote && tag[n] == quote)
            quote = 0;
        else if (!comment && !quote && (tag[n] == '"' || tag[n] == '\''))
            quote = tag[n];
        if (tag[n] != '>' || (quote && !comment)) continue;
        if (comment && (n < 6 || tag[n - 1] != '-' || tag[n - 2] != '-')) continue;
        *length = n;
        return BRIO_OK;
    }
    return BRIO_OK;
}

brio_status brio_xml_next_tag(brio_stream *s, const char *expected, const char **tag) {
    size_t length = 0;
    BRIO_FORWARD(brio_xml_skip_to(s, '<', expected));
    BRIO_FORWARD(tag_length(s, &length));
    char *start = s->buffer + s->begin;
    start[length] = 0;
    *tag = start + 1;
    s->begin += length + 1;
    return BRIO_OK;
}

bool brio_xml_is(const char *tag, const char *name) {
    size_t length = strlen(name);
    return !strncmp(tag, name, length) && (!tag[length] || brio_is_blank(tag[length]) || tag[length] == '/');
}

/* Returns whether the tag ends its element: <name/>. */
static bool xml_is_empty(const char *tag) {
    size_t length = strlen(tag);
    return length && tag[length - 1] == '/';
}

/* Copies one character of a value, which may be written as an entity, and returns the place behind it. */
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

bool brio_xml_attribute(const char *tag, const char *name, char value[BRIO_XML_VALUE]) {
    size_t length = strlen(name), n = 0;
    const char *p = tag + strcspn(tag, " \t\r\n");
    for (;;) {
        while (brio_is_blank(*p)) p++;
        const char *found = p;
        p += strcspn(p, "= \t\r\n");
        size_t found_length = (size_t)(p - found);
        if (p[0] != '=' || (p[1] != '"' && p[1] != '\'')) return false;
        const char *end = strchr(p + 2, p[1]);
        if (!end) return false;
        if (found_length == length && !memcmp(found, name, length)) {
            for (p += 2; p < end && n < BRIO_XML_VALUE - 1; n++) p = unescape(p, &value[n]);
            value[n] = 0;
            return true;
        }
        p = end + 1;
    }
}

bool brio_xml_attribute_is(const char *tag, const char *name, const char *expected) {
    char value[BRIO_XML_VALUE];
    return brio_xml_attribute(tag, name, value) && !strcmp(value, expected);
}

/* Reads an attribute that is a number. Fails if the tag has no such attribute, or one of 2^63 or more, which
 *  no file has, so that sums of two have room. */
static brio_status xml_count(brio_stream *s, const char *tag, const char *name, uint64_t *count) {
    char value[BRIO_XML_VALUE] = "";
    const char *p = value;
    if (brio_xml_attribute(tag, name, value) && brio_parse_count(&p, count) && !*p && *count <= UINT64_MAX >> 1)
        return BRIO_OK;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected a number %s, found \"%s\"", s->name,
                     brio_stream_offset(s), name, brio_excerpt_of(value).text);
}

/* --- what the tags say --- */

static const char *const type_names[BRIO_VTK_TYPE_END] = {"Int8",   "UInt8",   "Int16",   "UInt16", "Int32",
                                                          "UInt32", "Float32", "Float64", "Int64",  "UInt64"};

size_t brio_vtk_type_size(int type) {
    return type < BRIO_SCALAR_END ? brio_scalar_size((brio_scalar)type) : 8;
}

const char *brio_vtk_type_name(int type) {
    return type_names[type];
}

static brio_status read_file_tag(brio_stream *s, brio_vtk_header *h, const char *tag) {
    h->polygonal = brio_xml_attribute_is(tag, "type", "PolyData");
    if (!h->polygonal && !brio_xml_attribute_is(tag, "type", "UnstructuredGrid"))
        return brio_xml_bad(s, "a VTKFile of type UnstructuredGrid or PolyData");
    char order[BRIO_XML_VALUE];
    bool told = brio_xml_attribute(tag, "byte_order", order); /* programs that write text leave it out */
    bool little = !told || !strcmp(order, "LittleEndian");
    if (!little && strcmp(order, "BigEndian") != 0) return brio_xml_bad(s, "byte_order LittleEndian or BigEndian");
    h->known = true;
    h->swap = little != brio_host_is_little();
    h->word = brio_xml_attribute_is(tag, "header_type", "UInt64") ? 8 : 4;
    h->compressed = brio_xml_attribute(tag, "compressor", h->compressor) && h->compressor[0];
    return BRIO_OK;
}

uint64_t brio_vtk_cells_of(const brio_vtk_piece *piece) {
    uint64_t cells = 0;
    for (int k = 0; k < BRIO_VTK_SECTION_END; k++) cells += piece->num_cells[k];
    return cells;
}

uint64_t brio_vtk_first_row(const brio_vtk_piece *piece, brio_vtk_section section) {
    static const brio_vtk_section order[] = {BRIO_VTK_OTHER, BRIO_VTK_CELLS, BRIO_VTK_LINES, BRIO_VTK_POLYS,
                                             BRIO_VTK_STRIPS};
    uint64_t row = piece->first_cell;
    for (size_t k = 0; order[k] != section; k++) row += piece->num_cells[order[k]];
    return row;
}

static brio_status read_piece(brio_stream *s, brio_vtk_header *h, const char *tag) {
    static const char *const counts[BRIO_VTK_SECTION_END] = {[BRIO_VTK_OTHER] = "NumberOfVerts",
                                                             [BRIO_VTK_CELLS] = "NumberOfCells",
                                                             [BRIO_VTK_LINES] = "NumberOfLines",
                                                             [BRIO_VTK_STRIPS] = "NumberOfStrips",
                                                             [BRIO_VTK_POLYS] = "NumberOfPolys"};
    char value[BRIO_XML_VALUE];
    brio_vtk_piece piece = {.first_point = 0};
    uint64_t cells = 0;
    if (!h->known) return brio_xml_bad(s, "VTKFile before Piece");
    if (h->num_pieces) {
        const brio_vtk_piece *last = &h->pieces[h->num_pieces - 1];
        if (__builtin_add_overflow(last->first_point, last->num_points, &piece.first_point))
            return brio_xml_bad(s, "fewer than 2^64 points");
        cells = piece.first_cell = last->first_cell + brio_vtk_cells_of(last);
    }
    BRIO_FORWARD(xml_count(s, tag, "NumberOfPoints", &piece.num_points));
    for (int k = 0; k < BRIO_VTK_SECTION_END; k++) {
        if (!counts[k]) continue;
        bool needed = k == BRIO_VTK_CELLS && !h->polygonal;
        if (needed || (h->polygonal && brio_xml_attribute(tag, counts[k], value)))
            BRIO_FORWARD(xml_count(s, tag, counts[k], &piece.num_cells[k]));
        if (__builtin_add_overflow(cells, piece.num_cells[k], &cells)) return brio_xml_bad(s, "fewer than 2^64 cells");
    }
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, h->pieces, h->piece_capacity, h->num_pieces + 1));
    h->pieces[h->num_pieces++] = piece;
    h->section = BRIO_VTK_OTHER;
    return BRIO_OK;
}

/* Sets the section of the arrays that follow, if the tag begins or ends one. */
static void set_section(brio_vtk_header *h, const char *tag) {
    static const struct {
        const char *name;
        brio_vtk_section section;
    } sections[] = {
        {"Points", BRIO_VTK_POINTS}, {"PointData", BRIO_VTK_POINT_DATA}, {"Cells", BRIO_VTK_CELLS},
        {"Lines", BRIO_VTK_LINES},   {"Strips", BRIO_VTK_STRIPS},        {"Polys", BRIO_VTK_POLYS},
        {"Verts", BRIO_VTK_OTHER},   {"CellData", BRIO_VTK_CELL_DATA},   {"FieldData", BRIO_VTK_FIELD_DATA}};
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++) {
        bool ends = tag[0] == '/' && brio_xml_is(tag + 1, sections[i].name);
        if (ends || brio_xml_is(tag, sections[i].name))
            h->section = ends || xml_is_empty(tag) ? BRIO_VTK_OTHER : sections[i].section;
    }
}

brio_status brio_vtk_header_tag(brio_stream *s, brio_vtk_header *h, const char *tag) {
    if (brio_xml_is(tag, "VTKFile")) return h->known ? brio_xml_bad(s, "one VTKFile only") : read_file_tag(s, h, tag);
    if (brio_xml_is(tag, "Piece")) return read_piece(s, h, tag);
    set_section(h, tag);
    return BRIO_OK;
}

static brio_status read_encoding(brio_stream *s, const char *tag, brio_vtk_array *a) {
    a->appended = brio_xml_attribute_is(tag, "format", "appended");
    a->encoding = brio_xml_attribute_is(tag, "format", "binary") ? BRIO_VTK_BASE64 : BRIO_VTK_TEXT;
    if (a->appended) return xml_count(s, tag, "offset", &a->offset);
    if (a->encoding == BRIO_VTK_BASE64 || brio_xml_attribute_is(tag, "format", "ascii")) return BRIO_OK;
    return brio_xml_bad(s, "a DataArray of format appended, binary or ascii");
}

brio_status brio_vtk_header_array(brio_stream *s, const brio_vtk_header *h, const char *tag, brio_vtk_array *a) {
    char value[BRIO_XML_VALUE];
    *a = (brio_vtk_array){.section = h->section, .components = 1, .empty = xml_is_empty(tag)};
    if (!brio_xml_attribute(tag, "Name", a->name)) a->name[0] = 0;
    if (h->section < BRIO_VTK_POINTS) return BRIO_OK;
    if (!h->num_pieces) return brio_xml_bad(s, "Piece before DataArray");
    a->piece = h->num_pieces - 1;
    while (a->type < BRIO_VTK_TYPE_END && !brio_xml_attribute_is(tag, "type", type_names[a->type])) a->type++;
    if (a->type == BRIO_VTK_TYPE_END && (h->section == BRIO_VTK_POINT_DATA || h->section == BRIO_VTK_CELL_DATA))
        return BRIO_OK; /* words, or bits */
    if (a->type == BRIO_VTK_TYPE_END) return brio_xml_bad(s, "a DataArray of type Int8 to UInt64, Float32 or Float64");
    if (brio_xml_attribute(tag, "NumberOfComponents", value))
        BRIO_FORWARD(xml_count(s, tag, "NumberOfComponents", &a->components));
    return read_encoding(s, tag, a);
}

void brio_vtk_header_free(brio_context *ctx, brio_vtk_header *header) {
    brio_release(ctx, header->pieces);
    header->pieces = NULL;
}
