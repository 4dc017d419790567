/* Arrays of VTK files that become properties: data of points, and data of cells. */
#include "base/memory.h"
#include "base/utf8.h"
#include "io/scalar.h"
#include "io/vtk/vtk.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* --- values --- */

/* Arrays that are kept as the file has them. */

enum { PART = 1 << 16 }; /* bytes decoded at a time; chosen */

double brio_vtk_number(const brio_vtk_values *values, uint64_t i) {
    const char *p = values->bytes + i * brio_vtk_type_size(values->type);
    uint64_t raw;
    if (values->type < BRIO_SCALAR_END) return brio_scalar_load(p, (brio_scalar)values->type, false);
    memcpy(&raw, p, sizeof raw);
    return values->type == BRIO_VTK_INT64 ? (double)(int64_t)raw : (double)raw;
}

brio_status brio_vtk_bad_rows(const brio_vtk_decoder *d, uint64_t found, uint64_t rows) {
    return brio_fail(d->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": array %s has %" PRIu64 "%s rows, not %" PRIu64, d->stream->name,
                     brio_stream_offset(d->stream), d->array->name, found,
                     found > rows && d->encoding == BRIO_VTK_TEXT ? " or more" : "", rows);
}

brio_status brio_vtk_expect_rows(const brio_vtk_decoder *d, uint64_t bytes, uint64_t rows, size_t row) {
    if (bytes == UINT64_MAX) return BRIO_OK;
    if (bytes % row == 0 && (rows == UINT64_MAX || bytes / row == rows)) return BRIO_OK;
    return brio_fail(d->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": array %s has %" PRIu64 " bytes, which is not %s rows of %zu bytes",
                     d->stream->name, brio_stream_offset(d->stream), d->array->name, bytes,
                     rows == UINT64_MAX ? "a number of" : "the number of", row);
}

brio_status brio_vtk_read_values(brio_vtk_decoder *d, uint64_t bytes, uint64_t count, brio_vtk_values *out) {
    brio_stream *s = d->stream;
    size_t size = brio_vtk_type_size(d->array->type), capacity = 0, used = 0, got = 0;
    *out = (brio_vtk_values){.type = d->array->type};
    BRIO_FORWARD(brio_vtk_expect_rows(d, bytes, count, size));
    if (s->size != BRIO_SIZE_UNKNOWN && bytes != UINT64_MAX) capacity = (size_t)bytes;
    if (!capacity) capacity = 1; /* a place for no values, too */
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, out->bytes, capacity));
    do {
        BRIO_FORWARD(BRIO_RESERVE(s->ctx, out->bytes, capacity, bytes == used ? used : used + PART));
        BRIO_FORWARD(
            brio_vtk_decoder_take(d, out->bytes + used, capacity - used < PART ? capacity - used : PART, &got));
        if (d->swap) brio_scalar_gather(out->bytes + used, out->bytes + used, got / size, size, size, true);
        used += got;
        s->row = used / size;
        if (count != UINT64_MAX && used / size > count) break;
    } while (got);
    out->count = used / size;
    if (count != UINT64_MAX && out->count != count) return brio_vtk_bad_rows(d, out->count, count);
    return BRIO_OK;
}

/* --- data of points --- */

/* Point data of VTU, VTP and VTK files as properties, and what cell data have in common with them.
 *
 * A column is a component of an array, and grows from piece to piece. An array of one component is a property of its
 * name, one of several components is name_0, name_1, ... Normals become nx, ny, nz, and colours of bytes red, green,
 * blue, alpha, which other formats have, too. Integers of 64 bits become doubles. */

/* CHUNK: bytes decoded at a time. All chosen. */
enum { CHUNK = 1 << 16, MOST_COMPONENTS = 16 };

bool brio_vtk_is_kept(const brio_vtk_array *array) {
    return array->type < BRIO_VTK_TYPE_END && array->name[0] && array->components > 0 &&
           array->components <= MOST_COMPONENTS;
}

/* --- columns --- */

/* Returns the first column of an array, or NULL. The others follow it. */
static brio_vtk_column *find(const brio_vtk_data *data, const brio_vtk_array *a) {
    for (size_t i = 0; i < data->num_columns; i += (size_t)data->columns[i].components)
        if (!strcmp(data->columns[i].source, a->name)) return &data->columns[i];
    return NULL;
}

static brio_status add_columns(brio_vtk_data *data, const brio_vtk_decoder *d) {
    const brio_vtk_array *a = d->array;
    BRIO_EXPECT(d->stream->ctx, data->num_columns + a->components <= BRIO_MOST_NUMBERS, BRIO_ERR_FORMAT,
                "%s: more than %d numbers a point", d->stream->name, BRIO_MOST_NUMBERS);
    BRIO_FORWARD(BRIO_RESERVE(d->stream->ctx, data->columns, data->capacity, data->num_columns + a->components));
    for (uint64_t k = 0; k < a->components; k++) {
        brio_vtk_column *c = &data->columns[data->num_columns++];
        *c = (brio_vtk_column){.component = k, .components = a->components, .file_type = a->type};
        memcpy(c->source, a->name, sizeof c->source);
        c->type = a->type < BRIO_SCALAR_END ? (brio_scalar)a->type : BRIO_SCALAR_FLOAT64;
    }
    return BRIO_OK;
}

/* Names an array that becomes nothing. */
static brio_status vtk_leave_out(const brio_vtk_data *data, brio_builder *b, const char *array) {
    char name[BRIO_XML_VALUE + 16];
    snprintf(name, sizeof name, "%s%s", *array ? array : "array without a name", data->of_cells ? " of cells" : "");
    return brio_builder_leave_out(b, name);
}

/* --- reading --- */

/* Returns whether no double has an integer. */
static bool is_rounded(uint64_t raw, bool is_signed) {
    uint64_t size = is_signed && raw >> 63 ? 0 - raw : raw;
    double value = (double)size;
    return value >= 0x1p64 || (uint64_t)value != size;
}

/* Converts integers of 64 bits. Returns whether one of them was rounded. */
static bool convert_wide(char *to, const char *from, size_t rows, const brio_vtk_decoder *d) {
    bool rounded = false, is_signed = d->array->type == BRIO_VTK_INT64;
    for (size_t i = 0; i < rows; i++) {
        uint64_t raw;
        brio_scalar_gather(&raw, from + i * d->array->components * sizeof raw, 1, 0, sizeof raw, d->swap);
        double value = is_signed ? (double)(int64_t)raw : (double)raw;
        rounded |= is_rounded(raw, is_signed);
        memcpy(to + i * sizeof value, &value, sizeof value);
    }
    return rounded;
}

static brio_status append(brio_vtk_column *columns, const brio_vtk_decoder *d, const char *chunk, size_t rows) {
    size_t size = brio_vtk_type_size(d->array->type), row = size * (size_t)d->array->components;
    for (size_t k = 0; k < d->array->components; k++) {
        brio_vtk_column *c = &columns[k];
        BRIO_FORWARD(BRIO_RESERVE(d->stream->ctx, c->data, c->capacity, (c->rows + rows) * brio_scalar_size(c->type)));
        char *to = c->data + c->rows * brio_scalar_size(c->type);
        if (d->array->type < BRIO_SCALAR_END)
            brio_scalar_gather(to, chunk + k * size, rows, row, size, d->swap);
        else
            c->rounded |= convert_wide(to, chunk + k * size, rows, d);
        c->rows += rows;
    }
    return BRIO_OK;
}

/* Makes room for all rows at once. Their number was held against the file. */
static brio_status reserve(brio_vtk_column *columns, const brio_vtk_decoder *d, uint64_t rows) {
    for (size_t k = 0; k < d->array->components; k++) {
        brio_vtk_column *c = &columns[k];
        size_t need = (size_t)rows * brio_scalar_size(c->type);
        if (c->rows || c->capacity >= need) continue;
        BRIO_FORWARD(BRIO_RESIZE(d->stream->ctx, c->data, need));
        c->capacity = need;
    }
    return BRIO_OK;
}

brio_status brio_vtk_read_data(brio_vtk_data *data, brio_builder *b, brio_vtk_decoder *d, uint64_t bytes,
                               uint64_t first, uint64_t rows) {
    brio_vtk_column *columns = find(data, d->array);
    size_t row = (size_t)d->array->components * brio_vtk_type_size(d->array->type), got;
    uint64_t end = first + rows;
    if (!columns && first) return vtk_leave_out(data, b, d->array->name);
    if (!columns) BRIO_FORWARD(add_columns(data, d));
    if (!columns) columns = &data->columns[data->num_columns - d->array->components];
    if (columns->components != d->array->components || columns->file_type != d->array->type) return BRIO_OK;
    if (columns->rows == end && rows)
        return brio_fail(d->stream->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": two arrays %s", d->stream->name,
                         brio_stream_offset(d->stream), d->array->name);
    if (columns->rows != first) return BRIO_OK;
    BRIO_FORWARD(brio_vtk_expect_rows(d, bytes, rows, row));
    if (bytes != UINT64_MAX && d->stream->size != BRIO_SIZE_UNKNOWN) BRIO_FORWARD(reserve(columns, d, rows));
    if (!data->chunk) BRIO_FORWARD(BRIO_ALLOC(d->stream->ctx, data->chunk, CHUNK));
    for (;;) {
        BRIO_FORWARD(brio_vtk_decoder_take(d, data->chunk, CHUNK / row * row, &got));
        if (!got) break;
        if (columns->rows + got / row > end || got % row)
            return brio_vtk_bad_rows(d, columns->rows - first + got / row, rows);
        BRIO_FORWARD(append(columns, d, data->chunk, got / row));
        d->stream->row = columns->rows - first;
    }
    if (columns->rows != end) return brio_vtk_bad_rows(d, columns->rows - first, rows);
    return BRIO_OK;
}

brio_status brio_vtk_keep_array(brio_vtk_data *data, brio_stream *s, const brio_vtk_array *array,
                                const brio_vtk_values *values) {
    const brio_vtk_decoder d = {.stream = s, .array = array};
    BRIO_FORWARD(add_columns(data, &d));
    return append(&data->columns[data->num_columns - array->components], &d, values->bytes,
                  (size_t)(values->count / array->components));
}

/* --- properties --- */

static bool is_colour(const brio_vtk_column *c) {
    static const char *const names[] = {"rgb", "rgba", "color", "colors", "colour", "colours"};
    if (c->file_type != BRIO_SCALAR_UINT8 || (c->components != 3 && c->components != 4)) return false;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcasecmp(c->source, names[i])) return true;
    return false;
}

/* Makes the name of the property that a column becomes, which no other one has. */
static void vtk_choose_name(const brio_vtk_data *data, brio_builder *b, const brio_vtk_column *c, char name[64]) {
    static const char *const normal[] = {"nx", "ny", "nz"}, *const colour[] = {"red", "green", "blue", "alpha"};
    char part[64];
    const char *source = c->source;
    if (c->components == 3 && !strcmp(c->source, "Normals")) {
        source = normal[c->component];
    } else if (is_colour(c)) {
        source = colour[c->component];
    } else if (c->components > 1) {
        brio_numbered_name(part, sizeof part, c->source, c->component);
        source = part;
    }
    if (data->of_cells)
        brio_builder_new_face_name(b, source, name);
    else
        brio_builder_new_name(b, source, name);
}

brio_status brio_vtk_finish_point_data(brio_vtk_data *data, brio_builder *b) {
    char name[64];
    for (size_t i = 0; i < data->num_columns; i++) {
        brio_vtk_column *c = &data->columns[i];
        if (c->rows != b->mesh->num_vertices) {
            BRIO_FORWARD(vtk_leave_out(data, b, c->source));
            continue;
        }
        if (c->rounded) BRIO_FORWARD(brio_builder_leave_out(b, "integers beyond 2^53"));
        vtk_choose_name(data, b, c, name);
        void *block = c->data;
        c->data = NULL;
        if (block)
            BRIO_FORWARD(brio_builder_adopt_property(b, name, c->type, block));
        else
            BRIO_FORWARD(brio_builder_property(b, name, c->type));
    }
    return BRIO_OK;
}

void brio_vtk_data_free(brio_context *ctx, brio_vtk_data *data) {
    for (size_t i = 0; i < data->num_columns; i++) brio_release(ctx, data->columns[i].data);
    brio_release(ctx, data->columns);
    brio_release(ctx, data->chunk);
}

/* --- data of cells --- */

/* Cell data of VTU, VTP and VTK files as properties of the faces.
 *
 * A face has the values of its cell's row; all triangles of a strip have those of the strip. Rows of cells that are no
 * faces become nothing, which is said unless they hold nothing but 0, as brio writes them. */

/* Returns whether a column has a number other than 0 in a row that is no face's.   taken  of all cells. */
static bool has_others(const brio_vtk_column *c, const uint8_t *taken) {
    size_t size = brio_scalar_size(c->type);
    for (uint64_t row = 0; row < c->rows; row++) {
        double x = taken[row] ? 0 : brio_scalar_load(c->data + row * size, c->type, false);
        if (x != 0 && !isnan(x)) return true;
    }
    return false;
}

static brio_status make_property(brio_vtk_data *data, brio_builder *b, const brio_vtk_face_rows *rows,
                                 brio_vtk_column *c) {
    char name[64];
    size_t size = brio_scalar_size(c->type);
    vtk_choose_name(data, b, c, name);
    BRIO_FORWARD(brio_builder_face_property(b, name, c->type));
    char *to = b->mesh->face_properties[b->mesh->num_face_properties - 1].data;
    for (size_t f = 0; f < rows->count; f++) memcpy(to + f * size, c->data + rows->row[f] * size, size);
    if (c->rounded) BRIO_FORWARD(brio_builder_leave_out(b, "integers beyond 2^53"));
    brio_release(b->ctx, c->data);
    c->data = NULL;
    return BRIO_OK;
}

brio_status brio_vtk_finish_cell_data(brio_vtk_data *data, brio_builder *b, const brio_vtk_face_rows *rows,
                                      uint64_t num_cells) {
    brio_status status = BRIO_OK;
    uint8_t *taken = NULL;
    char name[BRIO_XML_VALUE + 32];
    if (!data->num_columns) return BRIO_OK;
    if (rows->count) BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, taken, (size_t)num_cells));
    for (size_t f = 0; f < rows->count; f++) taken[rows->row[f]] = 1;
    for (size_t i = 0; i < data->num_columns; i++) {
        brio_vtk_column *c = &data->columns[i];
        if (c->rows != num_cells || !rows->count) {
            BRIO_TRY(vtk_leave_out(data, b, c->source));
            continue;
        }
        snprintf(name, sizeof name, "%s of cells that are no polygons", c->source);
        if (has_others(c, taken)) BRIO_TRY(brio_builder_leave_out(b, name));
        BRIO_TRY(make_property(data, b, rows, c));
    }
done:
    brio_release(b->ctx, taken);
    return status;
}
