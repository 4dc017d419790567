/* Reads VTU and VTP files: points, point data, and cells, of one piece after the other.
 *
 * Arrays within the tags are read where they stand. Appended arrays are read after all tags, in the order of their
 * offsets. Points become vertices at once. Point data and the arrays of the cells are kept until all have been read.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk.h"
#include "base/memory.h"
#include "base/sort.h"
#include "io/formats.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- lists of cells --- */

/* The cells of a VTU or VTP file as polygons, tetrahedra and edges.
 *
 * A strip of n corners is n - 2 triangles, of which every second one is turned round; a line of n corners is n - 1
 * edges. Of quadratic cells the corners are kept. A polyhedron is its faces, so that a wall between two polyhedra is
 * there twice. Other cells are passed over. */

/* Types of cells of VTK. */
enum {
    VERTEX = 1,
    POLY_VERTEX = 2,
    LINE = 3,
    POLY_LINE = 4,
    TRIANGLE = 5,
    TRIANGLE_STRIP = 6,
    POLYGON = 7,
    PIXEL = 8,
    QUAD = 9,
    TETRAHEDRON = 10,
    QUADRATIC_TRIANGLE = 22,
    QUADRATIC_QUAD = 23,
    QUADRATIC_TETRAHEDRON = 24,
    POLYHEDRON = 42
};

/* Cells between two reports of progress. Chosen. */
enum { BETWEEN_REPORTS = 1 << 20 };

/* The cell that is being added. */
typedef struct {
    brio_builder *builder;
    const brio_vtk_cells *cells;
    uint64_t number, from, count; /* corners from `from` on */
    uint64_t faces_from;          /* where the faces of the next polyhedron begin */
} cell;

/* Returns brio_vtk_number, without a call for the types that indices have. */
static inline double number_of(const brio_vtk_values *values, uint64_t i) {
    int32_t narrow;
    int64_t wide;
    if (values->type == BRIO_SCALAR_INT32) {
        memcpy(&narrow, values->bytes + i * sizeof narrow, sizeof narrow);
        return narrow;
    }
    if (values->type != BRIO_VTK_INT64) return brio_vtk_number(values, i);
    memcpy(&wide, values->bytes + i * sizeof wide, sizeof wide);
    return (double)wide;
}

/* Sets the vertex of the mesh that number i of an array names. */
static brio_status vertex_of(const cell *c, const brio_vtk_values *array, uint64_t i, double *vertex) {
    const brio_vtk_piece *piece = c->cells->piece;
    double index = number_of(array, i);
    BRIO_EXPECT(
        c->builder->ctx, index >= 0 && index < (double)piece->num_points && index == floor(index), BRIO_ERR_FORMAT,
        "%s: cell %" PRIu64 " (counted from 0): point %.17g, expected one of the %" PRIu64 " points, counted from 0",
        c->builder->name, c->number, index, piece->num_points);
    *vertex = index + (double)piece->first_point;
    return BRIO_OK;
}

/* Reads corner i of the cell. */
static brio_status corner(const cell *c, uint64_t i, double *vertex) {
    return vertex_of(c, &c->cells->connectivity, c->from + i, vertex);
}

/* Adds a polygon.   order  the places of its corners in the cell; NULL for all of them, as they come. */
static brio_status add_face(const cell *c, const uint64_t *order, uint64_t count) {
    double vertex = 0;
    for (uint64_t i = 0; i < count; i++) {
        BRIO_FORWARD(corner(c, order ? order[i] : i, &vertex));
        BRIO_FORWARD(brio_builder_corner(c->builder, vertex));
    }
    return brio_builder_face(c->builder);
}

static brio_status add_tetrahedron(const cell *c) {
    double corners[4];
    for (uint64_t i = 0; i < 4; i++) BRIO_FORWARD(corner(c, i, &corners[i]));
    return brio_builder_tetrahedron(c->builder, corners);
}

static brio_status add_strip(const cell *c) {
    for (uint64_t i = 0; i + 2 < c->count; i++)
        BRIO_FORWARD(add_face(c, (const uint64_t[3]){i, i + 1 + i % 2, i + 2 - i % 2}, 3));
    return BRIO_OK;
}

static brio_status add_line(const cell *c) {
    double ends[2] = {0, 0};
    for (uint64_t i = 0; i + 1 < c->count; i++) {
        BRIO_FORWARD(corner(c, i, &ends[0]));
        BRIO_FORWARD(corner(c, i + 1, &ends[1]));
        BRIO_FORWARD(brio_builder_edge(c->builder, ends));
    }
    return BRIO_OK;
}

/* Reads number *at of the array of faces, which says how many numbers follow; `end` is that of the polyhedron. */
static brio_status faces_count(const cell *c, uint64_t *at, uint64_t end, uint64_t *count) {
    double value = *at < end ? number_of(&c->cells->faces, *at) : -1;
    *at += 1;
    BRIO_EXPECT(c->builder->ctx, value >= 0 && value <= (double)end - (double)*at && value == floor(value),
                BRIO_ERR_FORMAT,
                "%s: cell %" PRIu64 " (counted from 0): its numbers in the array faces do not end with it",
                c->builder->name, c->number);
    *count = (uint64_t)value;
    return BRIO_OK;
}

/* Adds the faces of a polyhedron. The array `faces` has for each polyhedron the number of its faces, and for each of
 * these that of its corners, then them; `faceoffsets` has where it ends. */
static brio_status add_polyhedron(cell *c) {
    const brio_vtk_cells *cells = c->cells;
    if (!cells->faces.bytes || !cells->face_offsets.bytes)
        return brio_builder_leave_out(c->builder, "polyhedra without an array of faces");
    double to = number_of(&cells->face_offsets, c->number), vertex = 0;
    BRIO_EXPECT(c->builder->ctx, to >= (double)c->faces_from && to <= (double)cells->faces.count, BRIO_ERR_FORMAT,
                "%s: cell %" PRIu64 " (counted from 0): face offset %.17g, expected %" PRIu64 " to %" PRIu64,
                c->builder->name, c->number, to, c->faces_from, cells->faces.count);
    uint64_t at = c->faces_from, end = (uint64_t)to, faces = 0, corners = 0;
    BRIO_FORWARD(faces_count(c, &at, end, &faces));
    for (; faces; faces--) {
        BRIO_FORWARD(faces_count(c, &at, end, &corners));
        for (; corners; corners--) {
            BRIO_FORWARD(vertex_of(c, &cells->faces, at++, &vertex));
            BRIO_FORWARD(brio_builder_corner(c->builder, vertex));
        }
        BRIO_FORWARD(brio_builder_face(c->builder));
    }
    c->faces_from = end;
    return BRIO_OK;
}

/* Returns the corners that a cell of this type has at least. */
static uint64_t least_corners(int type) {
    switch (type) {
    case PIXEL:
    case QUAD:
    case TETRAHEDRON:
        return 4;
    case TRIANGLE:
        return 3;
    case QUADRATIC_TRIANGLE:
        return 6;
    case QUADRATIC_QUAD:
        return 8;
    case QUADRATIC_TETRAHEDRON:
        return 10;
    default:
        return 0;
    }
}

static brio_status add_typed(cell *c, int type) {
    BRIO_EXPECT(c->builder->ctx, c->count >= least_corners(type), BRIO_ERR_FORMAT,
                "%s: cell %" PRIu64 " (counted from 0): %" PRIu64 " corners, expected %" PRIu64 " of a cell of type %d",
                c->builder->name, c->number, c->count, least_corners(type), type);
    switch (type) {
    case LINE:
    case POLY_LINE:
        return add_line(c);
    case TRIANGLE_STRIP:
        return add_strip(c);
    case PIXEL:
        return add_face(c, (const uint64_t[4]){0, 1, 3, 2}, 4);
    case TRIANGLE:
    case POLYGON:
    case QUAD:
        return add_face(c, NULL, c->count);
    case QUADRATIC_TRIANGLE:
        BRIO_FORWARD(brio_builder_leave_out(c->builder, "curved sides of cells"));
        return add_face(c, NULL, 3);
    case QUADRATIC_QUAD:
        BRIO_FORWARD(brio_builder_leave_out(c->builder, "curved sides of cells"));
        return add_face(c, NULL, 4);
    case QUADRATIC_TETRAHEDRON:
        BRIO_FORWARD(brio_builder_leave_out(c->builder, "curved sides of cells"));
        return add_tetrahedron(c);
    case TETRAHEDRON:
        return add_tetrahedron(c);
    case POLYHEDRON:
        return add_polyhedron(c);
    case VERTEX:
    case POLY_VERTEX:
        break; /* points are there without */
    default:
        return brio_builder_leave_out(c->builder, "cells of other types");
    }
    return BRIO_OK;
}

static brio_status add_cell(cell *c) {
    switch (c->cells->section) {
    case BRIO_VTK_LINES:
        return add_line(c);
    case BRIO_VTK_STRIPS:
        return add_strip(c);
    case BRIO_VTK_POLYS:
        return add_face(c, NULL, c->count);
    default:
        return add_typed(c, (int)brio_vtk_number(&c->cells->types, c->number));
    }
}

brio_status brio_vtk_add_cells(brio_builder *b, const brio_vtk_cells *cells, brio_vtk_face_rows *rows) {
    cell c = {.builder = b, .cells = cells};
    uint64_t first_row = brio_vtk_first_row(cells->piece, cells->section);
    for (; c.number < cells->piece->num_cells[cells->section]; c.number++) {
        double to = number_of(&cells->offsets, c.number);
        if (c.number % BETWEEN_REPORTS == 0) BRIO_FORWARD(brio_progress(b->ctx, "read", 1));
        BRIO_EXPECT(b->ctx, to >= (double)c.from && to <= (double)cells->connectivity.count, BRIO_ERR_FORMAT,
                    "%s: cell %" PRIu64 " (counted from 0): offset %.17g, expected %" PRIu64 " to %" PRIu64, b->name,
                    c.number, to, c.from, cells->connectivity.count);
        c.count = (uint64_t)to - c.from;
        BRIO_FORWARD(add_cell(&c));
        c.from += c.count;
        while (rows && rows->count < b->mesh->num_faces) {
            BRIO_FORWARD(BRIO_RESERVE(b->ctx, rows->row, rows->capacity, rows->count + 1));
            rows->row[rows->count++] = first_row + c.number;
        }
    }
    return BRIO_OK;
}

/* --- the reader --- */

/* Rows of points decoded at a time. Chosen. */
enum { ROWS = 1 << 12 };

typedef struct {
    brio_stream *stream;
    brio_builder *builder;
    brio_vtk_header header;
    brio_vtk_decoder decoder;
    brio_vtk_data point_data, cell_data;
    brio_vtk_face_rows rows_of_faces;
    brio_vtk_cells *cells; /* the sections of the pieces */
    size_t num_cells, cells_capacity;
    brio_vtk_array *appended;
    size_t num_appended, appended_capacity;
    uint32_t *order; /* of the appended arrays */
    char *rows;      /* of points */
} vtk_reader;

/* Returns the first place of a word in bytes, or NULL. */
static const char *find_word(const char *bytes, size_t size, const char *word) {
    size_t length = strlen(word);
    for (const char *end = bytes + size; bytes && (size_t)(end - bytes) >= length; bytes++) {
        bytes = memchr(bytes, word[0], (size_t)(end - bytes) - length + 1);
        if (!bytes || !memcmp(bytes, word, length)) return bytes;
    }
    return NULL;
}

/* Returns the tag VTKFile of a file that begins with it, or with the line that all XML may begin with; or NULL. */
static const char *root_of(const char *bytes, size_t size) {
    static const char xml[] = "<?xml", file[] = "<VTKFile";
    if (size >= strlen(xml) && !memcmp(bytes, xml, strlen(xml))) return find_word(bytes, size, file);
    return size >= strlen(file) && !memcmp(bytes, file, strlen(file)) ? bytes : NULL;
}

static bool vtu_starts(const char *bytes, size_t size) {
    return root_of(bytes, size) != NULL;
}

static bool vtp_starts(const char *bytes, size_t size) {
    static const char kind[] = "PolyData";
    const char *root = root_of(bytes, size);
    const char *end = root ? memchr(root, '>', size - (size_t)(root - bytes)) : NULL;
    return end && find_word(root, (size_t)(end - root), kind);
}

/* --- points --- */

static void convert_points(const vtk_reader *r, double *to, size_t rows) {
    const brio_vtk_decoder *d = &r->decoder;
    if (d->array->type < BRIO_SCALAR_END) {
        size_t row = 3 * brio_vtk_type_size(d->array->type);
        brio_scalar_convert_triples(to, r->rows, rows, row, (brio_scalar)d->array->type, d->swap);
        return;
    }
    const brio_vtk_values wide = {.bytes = r->rows, .type = d->array->type};
    if (d->swap) brio_scalar_gather(r->rows, r->rows, 3 * rows, sizeof(int64_t), sizeof(int64_t), true);
    for (size_t i = 0; i < 3 * rows; i++) to[i] = brio_vtk_number(&wide, i);
}

static brio_status read_points(vtk_reader *r, uint64_t bytes, const brio_vtk_piece *piece) {
    brio_vtk_decoder *d = &r->decoder;
    brio_mesh *m = r->builder->mesh;
    size_t row = 3 * brio_vtk_type_size(d->array->type), got;
    BRIO_EXPECT(d->stream->ctx, d->array->components == 3 && m->num_vertices == piece->first_point, BRIO_ERR_FORMAT,
                "%s: byte %" PRIu64 ": expected one array of points with 3 components for each piece, in their order",
                d->stream->name, brio_stream_offset(d->stream));
    BRIO_FORWARD(brio_vtk_expect_rows(d, bytes, piece->num_points, row));
    /* the array's size was held against that of the file */
    if (bytes != UINT64_MAX && d->stream->size != BRIO_SIZE_UNKNOWN && !piece->first_point)
        BRIO_FORWARD(brio_builder_expect_vertices(r->builder, piece->num_points));
    if (!r->rows) BRIO_FORWARD(BRIO_ALLOC(d->stream->ctx, r->rows, ROWS * 3 * sizeof(double)));
    for (;;) {
        uint64_t found = m->num_vertices - piece->first_point;
        BRIO_FORWARD(brio_vtk_decoder_take(d, r->rows, ROWS * row, &got));
        if (!got) break;
        if (got % row || found + got / row > piece->num_points)
            return brio_vtk_bad_rows(d, found + got / row, piece->num_points);
        BRIO_FORWARD(brio_builder_add_vertices(r->builder, got / row));
        convert_points(r, m->vertices + 3 * (m->num_vertices - got / row), got / row);
        d->stream->row = found + got / row;
    }
    uint64_t found = m->num_vertices - piece->first_point;
    if (found != piece->num_points) return brio_vtk_bad_rows(d, found, piece->num_points);
    return BRIO_OK;
}

/* --- cells --- */

/* Finds the arrays of a section of a piece, or makes them. The last sections are the likely ones. */
static brio_status find_cells(vtk_reader *r, const brio_vtk_array *a, brio_vtk_cells **out) {
    size_t first = a->piece * BRIO_VTK_SECTION_END, need = first + BRIO_VTK_SECTION_END;
    if (need > r->num_cells) {
        BRIO_FORWARD(BRIO_RESERVE(r->stream->ctx, r->cells, r->cells_capacity, need));
        memset(r->cells + r->num_cells, 0, (need - r->num_cells) * sizeof *r->cells);
        r->num_cells = need;
    }
    *out = &r->cells[first + a->section];
    (*out)->section = a->section;
    return BRIO_OK;
}

/* Returns where an array of cells goes to, or NULL if it is none that is read. */
static brio_vtk_values *cells_array(brio_vtk_cells *cells, brio_vtk_section section, const char *name) {
    bool typed = section == BRIO_VTK_CELLS;
    if (!strcmp(name, "connectivity")) return &cells->connectivity;
    if (!strcmp(name, "offsets")) return &cells->offsets;
    if (typed && !strcmp(name, "types")) return &cells->types;
    if (typed && !strcmp(name, "faces")) return &cells->faces;
    return typed && !strcmp(name, "faceoffsets") ? &cells->face_offsets : NULL;
}

static brio_status read_cells(vtk_reader *r, uint64_t bytes, const brio_vtk_array *a) {
    brio_vtk_cells *cells = NULL;
    BRIO_FORWARD(find_cells(r, a, &cells));
    brio_vtk_values *target = cells_array(cells, a->section, a->name);
    BRIO_EXPECT(r->stream->ctx, !target->bytes, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": two arrays %s", r->stream->name,
                brio_stream_offset(r->stream), a->name);
    bool any_count = target == &cells->connectivity || target == &cells->faces;
    uint64_t count = any_count ? UINT64_MAX : r->header.pieces[a->piece].num_cells[a->section];
    return brio_vtk_read_values(&r->decoder, bytes, count, target);
}

static brio_status add_cells(vtk_reader *r) {
    for (size_t p = 0; p < r->header.num_pieces; p++)
        for (int k = BRIO_VTK_CELLS; k < BRIO_VTK_SECTION_END; k++) {
            size_t i = p * BRIO_VTK_SECTION_END + (size_t)k;
            if (!r->header.pieces[p].num_cells[k]) continue;
            BRIO_EXPECT(r->stream->ctx,
                        i < r->num_cells && r->cells[i].connectivity.bytes && r->cells[i].offsets.bytes &&
                            (k != BRIO_VTK_CELLS || r->cells[i].types.bytes),
                        BRIO_ERR_FORMAT, "%s: expected arrays connectivity and offsets of the cells%s", r->stream->name,
                        k == BRIO_VTK_CELLS ? ", and types" : "");
            r->cells[i].piece = &r->header.pieces[p];
            BRIO_FORWARD(
                brio_vtk_add_cells(r->builder, &r->cells[i], r->cell_data.num_columns ? &r->rows_of_faces : NULL));
        }
    return BRIO_OK;
}

/* --- arrays --- */

static bool is_kept(const brio_vtk_array *a) {
    if (a->section < BRIO_VTK_POINTS) return false;
    if (a->section == BRIO_VTK_POINTS) return true;
    if (a->section == BRIO_VTK_POINT_DATA || a->section == BRIO_VTK_CELL_DATA) return brio_vtk_is_kept(a);
    return a->components == 1 && cells_array(&(brio_vtk_cells){.section = a->section}, a->section, a->name);
}

/* Reads the array whose first byte is the next one. */
static brio_status read_array(vtk_reader *r, const brio_vtk_array *a, brio_vtk_encoding encoding) {
    brio_status status = BRIO_OK;
    uint64_t bytes = 0;
    const brio_vtk_piece *piece = &r->header.pieces[a->piece];
    uint64_t cells = brio_vtk_cells_of(piece);
    brio_stream_element(r->stream, a->name[0] ? a->name : "array",
                        a->section == BRIO_VTK_CELL_DATA ? cells : piece->num_points);
    BRIO_TRY(brio_vtk_decoder_open(&r->decoder, a, encoding, &bytes));
    if (a->section == BRIO_VTK_POINTS)
        BRIO_TRY(read_points(r, bytes, piece));
    else if (a->section == BRIO_VTK_POINT_DATA)
        BRIO_TRY(
            brio_vtk_read_data(&r->point_data, r->builder, &r->decoder, bytes, piece->first_point, piece->num_points));
    else if (a->section == BRIO_VTK_CELL_DATA)
        BRIO_TRY(brio_vtk_read_data(&r->cell_data, r->builder, &r->decoder, bytes, piece->first_cell, cells));
    else
        BRIO_TRY(read_cells(r, bytes, a));
done:
    r->stream->element = NULL;
    return status;
}

/* Notes an array that becomes nothing. */
static brio_status note_left_out(vtk_reader *r, const brio_vtk_array *a) {
    static const char *const whose[BRIO_VTK_SECTION_END] = {
        [BRIO_VTK_CELL_DATA] = " of cells", [BRIO_VTK_FIELD_DATA] = " of the file", [BRIO_VTK_POINT_DATA] = ""};
    char name[BRIO_XML_VALUE + 16];
    if (!whose[a->section]) return BRIO_OK;
    snprintf(name, sizeof name, "%s%s", a->name[0] ? a->name : "array without a name", whose[a->section]);
    return brio_builder_leave_out(r->builder, name);
}

static brio_status take_array(vtk_reader *r, const char *tag) {
    brio_vtk_array a;
    BRIO_FORWARD(brio_vtk_header_array(r->stream, &r->header, tag, &a));
    if (!is_kept(&a)) return note_left_out(r, &a);
    if (!a.appended) return read_array(r, &a, a.encoding);
    BRIO_FORWARD(BRIO_RESERVE(r->stream->ctx, r->appended, r->appended_capacity, r->num_appended + 1));
    r->appended[r->num_appended++] = a;
    return BRIO_OK;
}

static int compare_offsets(uint32_t i, uint32_t j, const void *user) {
    const brio_vtk_array *a = user;
    if (a[i].offset != a[j].offset) return a[i].offset < a[j].offset ? -1 : 1;
    return i < j ? -1 : i > j;
}

static brio_status read_appended(vtk_reader *r, brio_vtk_encoding encoding) {
    brio_stream *s = r->stream;
    uint64_t start, base = brio_stream_offset(s);
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, r->order, r->num_appended));
    for (size_t i = 0; i < r->num_appended; i++) r->order[i] = (uint32_t)i;
    brio_sort_indices(r->order, r->num_appended, compare_offsets, r->appended);
    for (size_t i = 0; i < r->num_appended; i++) {
        const brio_vtk_array *a = &r->appended[r->order[i]];
        uint64_t at = brio_stream_offset(s);
        BRIO_EXPECT(s->ctx, !__builtin_add_overflow(base, a->offset, &start) && start >= at, BRIO_ERR_FORMAT,
                    "%s: array %s has the offset %" PRIu64 ", where another one is", s->name, a->name, a->offset);
        BRIO_EXPECT(s->ctx, start <= s->size, BRIO_ERR_FORMAT,
                    "%s: array %s has the offset %" PRIu64 ", beyond the end of the file at byte %" PRIu64, s->name,
                    a->name, a->offset, s->size);
        brio_stream_element(s, a->name[0] ? a->name : "array", 0);
        BRIO_FORWARD(brio_stream_skip(s, start - at));
        BRIO_FORWARD(read_array(r, a, encoding));
    }
    return BRIO_OK;
}

/* --- the file --- */

static brio_status begin_appended(vtk_reader *r, const char *tag) {
    bool base64 = brio_xml_attribute_is(tag, "encoding", "base64");
    if (!base64 && !brio_xml_attribute_is(tag, "encoding", "raw"))
        return brio_xml_bad(r->stream, "appended data of encoding raw or base64");
    BRIO_FORWARD(brio_xml_skip_to(r->stream, '_', "_ before the appended data"));
    r->stream->begin++;
    return read_appended(r, base64 ? BRIO_VTK_BASE64 : BRIO_VTK_RAW);
}

static brio_status read_file(vtk_reader *r) {
    const char *tag;
    for (;;) {
        BRIO_FORWARD(brio_xml_next_tag(r->stream, r->header.known ? "a tag /VTKFile" : "a tag VTKFile", &tag));
        if (brio_xml_is(tag, "DataArray") || brio_xml_is(tag, "Array")) { /* Array: of words */
            BRIO_FORWARD(take_array(r, tag));
        } else if (brio_xml_is(tag, "AppendedData")) {
            if (r->num_appended) return begin_appended(r, tag);
            return BRIO_OK;
        } else if (brio_xml_is(tag, "/VTKFile")) {
            return r->num_appended ? brio_xml_bad(r->stream, "a tag AppendedData") : BRIO_OK;
        } else {
            BRIO_FORWARD(brio_vtk_header_tag(r->stream, &r->header, tag));
        }
    }
    return BRIO_OK;
}

static void free_reader(vtk_reader *r) {
    brio_context *ctx = r->stream->ctx;
    for (size_t i = 0; i < r->num_cells; i++) {
        brio_release(ctx, r->cells[i].connectivity.bytes);
        brio_release(ctx, r->cells[i].offsets.bytes);
        brio_release(ctx, r->cells[i].types.bytes);
        brio_release(ctx, r->cells[i].faces.bytes);
        brio_release(ctx, r->cells[i].face_offsets.bytes);
    }
    brio_release(ctx, r->cells);
    brio_release(ctx, r->appended);
    brio_release(ctx, r->order);
    brio_release(ctx, r->rows);
    brio_release(ctx, r->rows_of_faces.row);
    brio_vtk_data_free(ctx, &r->point_data);
    brio_vtk_data_free(ctx, &r->cell_data);
    brio_vtk_decoder_free(&r->decoder);
    brio_vtk_header_free(ctx, &r->header);
}

static brio_status read_vtk(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    vtk_reader r = {.stream = s, .builder = b, .decoder.stream = s, .cell_data.of_cells = true};
    r.decoder.header = &r.header;
    BRIO_TRY(read_file(&r));
    BRIO_REQUIRE(s->ctx, r.header.num_pieces, BRIO_ERR_FORMAT, "%s: no Piece", s->name);
    const brio_vtk_piece *last = &r.header.pieces[r.header.num_pieces - 1];
    BRIO_REQUIRE(s->ctx, b->mesh->num_vertices == last->first_point + last->num_points, BRIO_ERR_FORMAT,
                 "%s: no array of points", s->name);
    BRIO_TRY(brio_vtk_finish_point_data(&r.point_data, b));
    BRIO_TRY(add_cells(&r));
    BRIO_TRY(brio_vtk_finish_cell_data(&r.cell_data, b, &r.rows_of_faces, last->first_cell + brio_vtk_cells_of(last)));
done:
    free_reader(&r);
    return status;
}

const brio_codec brio_vtu_codec = {.starts = vtu_starts, .read = read_vtk, .write = brio_vtu_write};
const brio_codec brio_vtp_codec = {.starts = vtp_starts, .read = read_vtk, .write = brio_vtp_write};
