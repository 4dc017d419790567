/* Reads VTK's legacy files of polygonal data and of unstructured grids, text and binary, of the versions 1 to 5.1.
 *
 * A file is a sequence of keywords with numbers behind them. Numbers in binary have the most significant byte first. Up
 * to version 4 the cells are one list, each with the number of its corners before them; from version 5 on they are
 * offsets and corners, as in the XML files, whose cells and point data serve here, too.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/number.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include "io/vtk/vtk.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* WORD: bytes of a word: a name of 63 bytes has three characters for each of them that is no letter. PART: numbers read
 * at a time; chosen. */
enum { WORD = 256, PART = 1 << 13 };

/* Types that are passed over. */
enum { BITS = BRIO_VTK_TYPE_END, WORDS, UNKNOWN };

/* Whose arrays follow. */
typedef enum { FILE_DATA, POINT_DATA, CELL_DATA } owner;

typedef struct {
    brio_stream *stream;
    brio_builder *builder;
    bool text, offsets; /* offsets: cells are offsets and corners */
    bool known, has_points;
    owner owner;
    uint64_t rows; /* of its arrays */
    brio_vtk_piece piece;
    brio_vtk_cells cells[BRIO_VTK_SECTION_END];
    brio_vtk_data point_data, cell_data;
    brio_vtk_face_rows rows_of_faces;
    char word[WORD];
} legacy_reader;

static const char mark[] = "# vtk DataFile Version ";

static bool starts(const char *bytes, size_t size) {
    return size >= strlen(mark) && !memcmp(bytes, mark, strlen(mark));
}

/* --- words and lines --- */

static brio_status expected(const legacy_reader *r, const char *what) {
    return brio_fail(r->stream->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected %s, found \"%s\"",
                     r->stream->name, brio_stream_offset(r->stream), what, brio_excerpt_of(r->word).text);
}

/* Reads the next word; at the end of the file it is empty. What stands behind it stays. */
static brio_status next_word(legacy_reader *r) {
    brio_stream *s = r->stream;
    size_t length = 0;
    for (;; s->begin++) {
        if (!brio_stream_left(s)) BRIO_FORWARD(brio_stream_fill(s, 1));
        if (!brio_stream_left(s)) break;
        char c = s->buffer[s->begin];
        if (brio_is_blank(c) && length) break;
        if (brio_is_blank(c)) continue;
        r->word[length] = 0;
        if (length == WORD - 1) return expected(r, "a word of fewer than 256 characters");
        r->word[length++] = c;
    }
    r->word[length] = 0;
    return BRIO_OK;
}

/* Moves behind the end of the line.   blank  NULL, or receives whether it has only blanks. */
static brio_status end_line(legacy_reader *r, bool *blank) {
    brio_stream *s = r->stream;
    if (blank) *blank = true;
    for (bool ended = false; !ended;) {
        if (!brio_stream_left(s)) BRIO_FORWARD(brio_stream_fill(s, 1));
        if (!brio_stream_left(s)) return BRIO_OK;
        char c = s->buffer[s->begin++];
        ended = c == '\n';
        if (blank && !brio_is_blank(c)) *blank = false;
    }
    return BRIO_OK;
}

static brio_status take_count(legacy_reader *r, uint64_t *count) {
    const char *at = r->word;
    BRIO_FORWARD(next_word(r));
    if (!brio_parse_count(&at, count) || *at || *count > UINT64_MAX >> 8) return expected(r, "a number of rows");
    return BRIO_OK;
}

/* Reads a name, in which %20 stands for a blank. */
static brio_status take_name(legacy_reader *r, char name[BRIO_XML_VALUE]) {
    size_t length = 0;
    BRIO_FORWARD(next_word(r));
    for (const char *c = r->word; *c && length < BRIO_XML_VALUE - 1; c++) {
        unsigned code = 0;
        int used = 0;
        bool coded = *c == '%' && c[1] && c[2] && sscanf(c + 1, "%2x%n", &code, &used) == 1 && used == 2 && code;
        name[length++] = coded ? (char)code : *c;
        c += coded ? 2 : 0;
    }
    name[length] = 0;
    return BRIO_OK;
}

static brio_status take_type(legacy_reader *r, int *type) {
    static const struct {
        const char *name;
        int type;
    } types[] = {{"unsigned_char", BRIO_SCALAR_UINT8},
                 {"char", BRIO_SCALAR_INT8},
                 {"signed_char", BRIO_SCALAR_INT8},
                 {"unsigned_short", BRIO_SCALAR_UINT16},
                 {"short", BRIO_SCALAR_INT16},
                 {"unsigned_int", BRIO_SCALAR_UINT32},
                 {"int", BRIO_SCALAR_INT32},
                 {"vtkidtype", BRIO_SCALAR_INT32}, /* VTK stores them so */
                 {"float", BRIO_SCALAR_FLOAT32},
                 {"double", BRIO_SCALAR_FLOAT64},
                 {"long", BRIO_VTK_INT64},
                 {"unsigned_long", BRIO_VTK_UINT64},
                 {"vtktypeint64", BRIO_VTK_INT64},
                 {"vtktypeuint64", BRIO_VTK_UINT64},
                 {"bit", BITS},
                 {"string", WORDS},
                 {"utf8_string", WORDS}};
    BRIO_FORWARD(next_word(r));
    *type = UNKNOWN;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcasecmp(r->word, types[i].name)) *type = types[i].type;
    if (*type == UNKNOWN) return expected(r, "a type of numbers, such as float");
    return BRIO_OK;
}

/* --- arrays --- */

static brio_status take_part(legacy_reader *r, int type, size_t count, char *to) {
    size_t size = brio_vtk_type_size(type);
    const char *bytes = NULL;
    if (!r->text) {
        BRIO_FORWARD(brio_stream_take(r->stream, count * size, &bytes));
        brio_scalar_gather(to, bytes, count, size, size, brio_host_is_little());
        return BRIO_OK;
    }
    for (size_t i = 0; i < count; i++) {
        BRIO_FORWARD(next_word(r));
        if (!brio_vtk_parse(r->word, type, to + i * size)) return expected(r, brio_vtk_type_name(type));
    }
    return BRIO_OK;
}

/* Reads `count` numbers behind the end of this line.   out  owned by the caller (brio_release of its bytes), on failure
 * too. */
static brio_status take_values(legacy_reader *r, int type, uint64_t count, brio_vtk_values *out) {
    size_t size = brio_vtk_type_size(type), capacity = 0;
    *out = (brio_vtk_values){.type = type, .count = count};
    BRIO_FORWARD(end_line(r, NULL));
    BRIO_FORWARD(brio_stream_expect(r->stream, count, r->text ? 1 : size, "a line before"));
    BRIO_FORWARD(BRIO_RESERVE(r->stream->ctx, out->bytes, capacity, 1));
    for (uint64_t i = 0; i < count;) {
        size_t part = count - i < PART ? (size_t)(count - i) : PART;
        BRIO_FORWARD(BRIO_RESERVE(r->stream->ctx, out->bytes, capacity, (size_t)(i + part) * size));
        BRIO_FORWARD(take_part(r, type, part, out->bytes + i * size));
        i += part;
    }
    return BRIO_OK;
}

/* Passes over a text with its length before it: the first two bits say how many bytes the length has. */
static brio_status skip_text(legacy_reader *r) {
    const char *bytes = NULL;
    BRIO_FORWARD(brio_stream_take(r->stream, 1, &bytes));
    unsigned first = (uint8_t)bytes[0], more = (unsigned[]){7, 3, 1, 0}[first >> 6];
    uint64_t length = first & 63;
    BRIO_FORWARD(brio_stream_take(r->stream, more, &bytes));
    for (unsigned i = 0; i < more; i++) length = length << 8 | (uint8_t)bytes[i];
    return brio_stream_skip(r->stream, length);
}

/* Passes over an array of bits or texts. */
static brio_status skip_others(legacy_reader *r, int type, uint64_t count) {
    BRIO_FORWARD(end_line(r, NULL));
    if (type == BITS && !r->text) return brio_stream_skip(r->stream, count / 8 + (count % 8 > 0));
    for (uint64_t i = 0; i < count; i++) {
        if (!brio_stream_left(r->stream)) BRIO_FORWARD(brio_stream_fill(r->stream, 1));
        if (!brio_stream_left(r->stream)) return brio_stream_truncated(r->stream);
        BRIO_FORWARD(type == BITS ? next_word(r) : r->text ? end_line(r, NULL) : skip_text(r));
    }
    return BRIO_OK;
}

/* Takes an array of rows: it becomes properties, or is named as left out. */
static brio_status take_array(legacy_reader *r, const char *name, uint64_t components, uint64_t rows, int type) {
    static const char *const whose[] = {" of the file", "", " of cells"};
    brio_status status = BRIO_OK;
    brio_vtk_values values = {.bytes = NULL};
    uint64_t count;
    char full[BRIO_XML_VALUE + 16];
    if (__builtin_mul_overflow(components, rows, &count)) return expected(r, "fewer numbers before here");
    brio_vtk_array array = {.components = components, .type = type};
    snprintf(array.name, sizeof array.name, "%s", name);
    if (type < BRIO_VTK_TYPE_END)
        BRIO_TRY(take_values(r, type, count, &values));
    else
        BRIO_TRY(skip_others(r, type, count));
    if (r->owner == POINT_DATA && brio_vtk_is_kept(&array) && rows == r->piece.num_points) {
        BRIO_TRY(brio_vtk_keep_array(&r->point_data, r->stream, &array, &values));
    } else if (r->owner == CELL_DATA && brio_vtk_is_kept(&array) && rows == brio_vtk_cells_of(&r->piece)) {
        BRIO_TRY(brio_vtk_keep_array(&r->cell_data, r->stream, &array, &values));
    } else {
        snprintf(full, sizeof full, "%s%s", *name ? name : "array without a name", whose[r->owner]);
        BRIO_TRY(brio_builder_leave_out(r->builder, full));
    }
done:
    brio_release(r->stream->ctx, values.bytes);
    return status;
}

/* --- points and cells --- */

static brio_status take_points(legacy_reader *r) {
    brio_status status = BRIO_OK;
    brio_vtk_values values = {.bytes = NULL};
    int type = 0;
    if (r->has_points) return expected(r, "one list of points");
    r->has_points = true;
    BRIO_TRY(take_count(r, &r->piece.num_points));
    BRIO_TRY(take_type(r, &type));
    if (type >= BRIO_VTK_TYPE_END) return expected(r, "points of numbers");
    BRIO_REQUIRE(r->stream->ctx, r->piece.num_points <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE,
                 "%s: %" PRIu64 " points, the most are %" PRIu64, r->stream->name, r->piece.num_points,
                 BRIO_MAX_VERTICES);
    BRIO_TRY(take_values(r, type, 3 * r->piece.num_points, &values));
    BRIO_TRY(brio_builder_expect_vertices(r->builder, r->piece.num_points));
    BRIO_TRY(brio_builder_add_vertices(r->builder, (size_t)r->piece.num_points));
    for (uint64_t i = 0; i < values.count; i++) r->builder->mesh->vertices[i] = brio_vtk_number(&values, i);
done:
    brio_release(r->stream->ctx, values.bytes);
    return status;
}

/* Turns a list of cells with the number of corners before each into corners and offsets. */
static brio_status split(legacy_reader *r, brio_vtk_cells *cells, uint64_t num_cells) {
    int32_t *list = (int32_t *)(void *)cells->connectivity.bytes;
    uint64_t at = 0, to = 0, count = cells->connectivity.count;
    int64_t *ends = NULL;
    BRIO_FORWARD(BRIO_ALLOC(r->stream->ctx, ends, num_cells));
    cells->offsets = (brio_vtk_values){(char *)ends, num_cells, BRIO_VTK_INT64};
    for (uint64_t i = 0; i < num_cells; i++) {
        uint64_t corners = at < count && list[at] >= 0 ? (uint64_t)list[at] : UINT64_MAX;
        BRIO_EXPECT(r->stream->ctx, at < count && corners <= count - at - 1, BRIO_ERR_FORMAT,
                    "%s: cell %" PRIu64 " (counted from 0) does not end within the list of cells", r->stream->name, i);
        memmove(list + to, list + at + 1, corners * sizeof *list);
        at += corners + 1;
        to += corners;
        ends[i] = (int64_t)to;
    }
    BRIO_EXPECT(r->stream->ctx, at == count, BRIO_ERR_FORMAT,
                "%s: %" PRIu64 " cells of %" PRIu64 " numbers, the list has %" PRIu64, r->stream->name, num_cells, at,
                count);
    cells->connectivity.count = to;
    return BRIO_OK;
}

/* Reads OFFSETS or CONNECTIVITY with its type and numbers. */
static brio_status take_named(legacy_reader *r, const char *name, uint64_t count, brio_vtk_values *values) {
    int type = 0;
    BRIO_FORWARD(next_word(r));
    if (strcasecmp(r->word, name) != 0) return expected(r, name);
    BRIO_FORWARD(take_type(r, &type));
    if (type >= BRIO_VTK_TYPE_END) return expected(r, "numbers of cells");
    return take_values(r, type, count, values);
}

static brio_status take_cells(legacy_reader *r, brio_vtk_section section) {
    brio_vtk_cells *cells = &r->cells[section];
    uint64_t first, second;
    BRIO_FORWARD(take_count(r, &first));
    BRIO_FORWARD(take_count(r, &second));
    if (cells->connectivity.bytes) return expected(r, "each kind of cells once");
    cells->section = section;
    cells->piece = &r->piece;
    if (!r->offsets) {
        if (first > second) return expected(r, "at least one number for each cell");
        BRIO_FORWARD(take_values(r, BRIO_SCALAR_INT32, second, &cells->connectivity));
        BRIO_FORWARD(split(r, cells, first));
        r->piece.num_cells[section] = first;
    } else if (first) {
        size_t size = 0;
        BRIO_FORWARD(take_named(r, "OFFSETS", first, &cells->offsets));
        BRIO_FORWARD(take_named(r, "CONNECTIVITY", second, &cells->connectivity));
        size = brio_vtk_type_size(cells->offsets.type);
        memmove(cells->offsets.bytes, cells->offsets.bytes + size, (size_t)(first - 1) * size); /* the first one is 0 */
        r->piece.num_cells[section] = cells->offsets.count = first - 1;
    }
    return BRIO_OK;
}

static brio_status take_cell_types(legacy_reader *r) {
    uint64_t count;
    BRIO_FORWARD(take_count(r, &count));
    if (r->cells[BRIO_VTK_CELLS].types.bytes || count != r->piece.num_cells[BRIO_VTK_CELLS])
        return expected(r, "one type for each cell");
    return take_values(r, BRIO_SCALAR_INT32, count, &r->cells[BRIO_VTK_CELLS].types);
}

static brio_status add_cells(legacy_reader *r) {
    for (int k = BRIO_VTK_CELLS; k < BRIO_VTK_SECTION_END; k++) {
        if (!r->piece.num_cells[k]) continue;
        BRIO_EXPECT(r->stream->ctx, k != BRIO_VTK_CELLS || r->cells[k].types.bytes, BRIO_ERR_FORMAT,
                    "%s: cells without CELL_TYPES", r->stream->name);
        BRIO_FORWARD(brio_vtk_add_cells(r->builder, &r->cells[k], &r->rows_of_faces));
    }
    return BRIO_OK;
}

/* --- keywords --- */

/* Passes over a block that ends with an empty line. */
static brio_status skip_metadata(legacy_reader *r) {
    bool blank = false;
    BRIO_FORWARD(end_line(r, NULL));
    while (!blank) BRIO_FORWARD(end_line(r, &blank));
    return BRIO_OK;
}

static brio_status take_field(legacy_reader *r) {
    char name[BRIO_XML_VALUE];
    uint64_t arrays, components, rows;
    int type = 0;
    BRIO_FORWARD(next_word(r));
    BRIO_FORWARD(take_count(r, &arrays));
    while (arrays--) {
        BRIO_FORWARD(take_name(r, name));
        while (!strcmp(name, "METADATA")) {
            BRIO_FORWARD(skip_metadata(r));
            BRIO_FORWARD(take_name(r, name));
        }
        BRIO_FORWARD(take_count(r, &components));
        BRIO_FORWARD(take_count(r, &rows));
        BRIO_FORWARD(take_type(r, &type));
        BRIO_FORWARD(take_array(r, name, components, rows, type));
    }
    return BRIO_OK;
}

/* Reads what stands behind SCALARS: its number of components may be missing; a line with a table of colours follows. */
static brio_status take_scalars(legacy_reader *r) {
    char name[BRIO_XML_VALUE];
    const char *at = r->word;
    uint64_t components = 1;
    int type = 0;
    BRIO_FORWARD(take_name(r, name));
    BRIO_FORWARD(take_type(r, &type));
    BRIO_FORWARD(next_word(r));
    if (brio_parse_count(&at, &components) && !*at) BRIO_FORWARD(next_word(r));
    if (strcasecmp(r->word, "LOOKUP_TABLE") != 0) return expected(r, "LOOKUP_TABLE");
    BRIO_FORWARD(next_word(r));
    return take_array(r, name, components, r->rows, type);
}

/* Takes colours: bytes, or numbers from 0 to 1 in a text. */
static brio_status take_colours(legacy_reader *r) {
    char name[BRIO_XML_VALUE];
    uint64_t components;
    BRIO_FORWARD(take_name(r, name));
    BRIO_FORWARD(take_count(r, &components));
    if (components == 3 || components == 4) strcpy(name, components == 3 ? "RGB" : "RGBA");
    return take_array(r, name, components, r->rows, r->text ? BRIO_SCALAR_FLOAT32 : BRIO_SCALAR_UINT8);
}

static brio_status take_table(legacy_reader *r) {
    brio_status status = BRIO_OK;
    brio_vtk_values values = {.bytes = NULL};
    uint64_t size;
    BRIO_TRY(next_word(r));
    BRIO_TRY(take_count(r, &size));
    BRIO_TRY(take_values(r, r->text ? BRIO_SCALAR_FLOAT32 : BRIO_SCALAR_UINT8, 4 * size, &values));
    BRIO_TRY(brio_builder_leave_out(r->builder, "tables of colours"));
done:
    brio_release(r->stream->ctx, values.bytes);
    return status;
}

/* Reads an array of a kind that has always the same number of components.   components  0: they stand before the
 * type. */
static brio_status take_attribute(legacy_reader *r, uint64_t components) {
    bool normals = !strcasecmp(r->word, "NORMALS");
    char name[BRIO_XML_VALUE];
    int type = 0;
    BRIO_FORWARD(take_name(r, name));
    if (!components) BRIO_FORWARD(take_count(r, &components));
    BRIO_FORWARD(take_type(r, &type));
    return take_array(r, normals ? "Normals" : name, components, r->rows, type);
}

static brio_status take_dataset(legacy_reader *r) {
    BRIO_FORWARD(next_word(r));
    r->known = !strcasecmp(r->word, "POLYDATA") || !strcasecmp(r->word, "UNSTRUCTURED_GRID");
    if (!r->known) return expected(r, "a data set POLYDATA or UNSTRUCTURED_GRID");
    return BRIO_OK;
}

static brio_status take_owner(legacy_reader *r, owner whose) {
    r->owner = whose;
    return take_count(r, &r->rows);
}

static brio_status take_vertices(legacy_reader *r) {
    brio_vtk_cells *cells = &r->cells[BRIO_VTK_OTHER];
    brio_status status = take_cells(r, BRIO_VTK_OTHER); /* passed over: points are there without */
    brio_release(r->stream->ctx, cells->connectivity.bytes);
    brio_release(r->stream->ctx, cells->offsets.bytes);
    *cells = (brio_vtk_cells){.piece = NULL};
    return status;
}

/* Takes what follows a keyword. */
static brio_status take_keyword(legacy_reader *r) {
    static const struct {
        const char *name;
        brio_status (*take)(legacy_reader *r);
    } keywords[] = {{"DATASET", take_dataset},       {"POINTS", take_points},         {"VERTICES", take_vertices},
                    {"CELL_TYPES", take_cell_types}, {"FIELD", take_field},           {"SCALARS", take_scalars},
                    {"METADATA", skip_metadata},     {"COLOR_SCALARS", take_colours}, {"LOOKUP_TABLE", take_table}};
    static const struct {
        const char *name;
        brio_vtk_section section;
    } sections[] = {{"LINES", BRIO_VTK_LINES},
                    {"POLYGONS", BRIO_VTK_POLYS},
                    {"TRIANGLE_STRIPS", BRIO_VTK_STRIPS},
                    {"CELLS", BRIO_VTK_CELLS}};
    static const struct {
        const char *name;
        uint64_t components;
    } attributes[] = {
        {"VECTORS", 3},    {"NORMALS", 3},      {"TENSORS", 9},   {"TENSORS6", 6}, {"TEXTURE_COORDINATES", 0},
        {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1}};
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
        if (!strcasecmp(r->word, keywords[i].name)) return keywords[i].take(r);
    if (!r->known) return expected(r, "DATASET");
    if (!strcasecmp(r->word, "POINT_DATA")) return take_owner(r, POINT_DATA);
    if (!strcasecmp(r->word, "CELL_DATA")) return take_owner(r, CELL_DATA);
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++)
        if (!strcasecmp(r->word, sections[i].name)) return take_cells(r, sections[i].section);
    for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++)
        if (!strcasecmp(r->word, attributes[i].name)) return take_attribute(r, attributes[i].components);
    return expected(r, "a keyword of VTK's legacy files");
}

static brio_status take_header(legacy_reader *r) {
    for (int i = 0; i < 5; i++) BRIO_FORWARD(next_word(r)); /* # vtk DataFile Version 3.0 */
    const char *at = r->word;
    uint64_t version;
    if (!brio_parse_count(&at, &version) || version < 1 || version > 5) return expected(r, "a version from 1.0 to 5.1");
    r->offsets = version == 5;
    snprintf(r->builder->version, sizeof r->builder->version, "%.8s", r->word);
    BRIO_FORWARD(end_line(r, NULL));
    BRIO_FORWARD(end_line(r, NULL)); /* the title */
    BRIO_FORWARD(next_word(r));
    r->text = !strcasecmp(r->word, "ASCII");
    if (!r->text && strcasecmp(r->word, "BINARY") != 0) return expected(r, "ASCII or BINARY");
    return BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    legacy_reader r = {.stream = s, .builder = b, .cell_data.of_cells = true};
    BRIO_TRY(take_header(&r));
    for (;;) {
        BRIO_TRY(next_word(&r));
        if (!r.word[0]) break;
        BRIO_TRY(take_keyword(&r));
    }
    if (!r.has_points) BRIO_TRY(expected(&r, "POINTS"));
    BRIO_TRY(brio_vtk_finish_point_data(&r.point_data, b));
    BRIO_TRY(add_cells(&r));
    BRIO_TRY(brio_vtk_finish_cell_data(&r.cell_data, b, &r.rows_of_faces, brio_vtk_cells_of(&r.piece)));
done:
    for (int k = 0; k < BRIO_VTK_SECTION_END; k++) {
        brio_release(s->ctx, r.cells[k].connectivity.bytes);
        brio_release(s->ctx, r.cells[k].offsets.bytes);
        brio_release(s->ctx, r.cells[k].types.bytes);
    }
    brio_release(s->ctx, r.rows_of_faces.row);
    brio_vtk_data_free(s->ctx, &r.point_data);
    brio_vtk_data_free(s->ctx, &r.cell_data);
    return status;
}

const brio_codec brio_vtk_codec = {.starts = starts, .read = read_file, .write = brio_vtk_legacy_write};
