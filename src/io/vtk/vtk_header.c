/* What the tags of a VTU or VTP file say.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk_header.h"
#include "base/memory.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <string.h>

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
    brio_status status = BRIO_OK;
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
    BRIO_TRY(brio_xml_count(s, tag, "NumberOfPoints", &piece.num_points));
    for (int k = 0; k < BRIO_VTK_SECTION_END; k++) {
        if (!counts[k]) continue;
        bool needed = k == BRIO_VTK_CELLS && !h->polygonal;
        if (needed || (h->polygonal && brio_xml_attribute(tag, counts[k], value)))
            BRIO_TRY(brio_xml_count(s, tag, counts[k], &piece.num_cells[k]));
        if (__builtin_add_overflow(cells, piece.num_cells[k], &cells)) return brio_xml_bad(s, "fewer than 2^64 cells");
    }
    BRIO_TRY(BRIO_RESERVE(s->ctx, h->pieces, h->piece_capacity, h->num_pieces + 1));
    h->pieces[h->num_pieces++] = piece;
    h->section = BRIO_VTK_OTHER;
done:
    return status;
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
            h->section = ends || brio_xml_is_empty(tag) ? BRIO_VTK_OTHER : sections[i].section;
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
    if (a->appended) return brio_xml_count(s, tag, "offset", &a->offset);
    if (a->encoding == BRIO_VTK_BASE64 || brio_xml_attribute_is(tag, "format", "ascii")) return BRIO_OK;
    return brio_xml_bad(s, "a DataArray of format appended, binary or ascii");
}

brio_status brio_vtk_header_array(brio_stream *s, const brio_vtk_header *h, const char *tag, brio_vtk_array *a) {
    brio_status status = BRIO_OK;
    char value[BRIO_XML_VALUE];
    *a = (brio_vtk_array){.section = h->section, .components = 1, .empty = brio_xml_is_empty(tag)};
    if (!brio_xml_attribute(tag, "Name", a->name)) a->name[0] = 0;
    if (h->section < BRIO_VTK_POINTS) return BRIO_OK;
    if (!h->num_pieces) return brio_xml_bad(s, "Piece before DataArray");
    a->piece = h->num_pieces - 1;
    while (a->type < BRIO_VTK_TYPE_END && !brio_xml_attribute_is(tag, "type", type_names[a->type])) a->type++;
    if (a->type == BRIO_VTK_TYPE_END && (h->section == BRIO_VTK_POINT_DATA || h->section == BRIO_VTK_CELL_DATA))
        return BRIO_OK; /* words, or bits */
    if (a->type == BRIO_VTK_TYPE_END) return brio_xml_bad(s, "a DataArray of type Int8 to UInt64, Float32 or Float64");
    if (brio_xml_attribute(tag, "NumberOfComponents", value))
        BRIO_TRY(brio_xml_count(s, tag, "NumberOfComponents", &a->components));
    BRIO_TRY(read_encoding(s, tag, a));
done:
    return status;
}

void brio_vtk_header_free(brio_context *ctx, brio_vtk_header *header) {
    brio_release(ctx, header->pieces);
    header->pieces = NULL;
}
