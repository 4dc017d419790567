/* Point data of VTU, VTP and VTK files as properties, and what cell data have in common with them.
 *
 * A column is a component of an array, and grows from piece to piece. An array of one component is a property of its
 * name, one of several components is name_0, name_1, ... Normals become nx, ny, nz, and colours of bytes red, green,
 * blue, alpha, which other formats have, too. Integers of 64 bits become doubles. */
#include "base/memory.h"
#include "base/utf8.h"
#include "io/scalar.h"
#include "io/vtk/vtk_values.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

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
    brio_status status = BRIO_OK;
    const brio_vtk_array *a = d->array;
    BRIO_REQUIRE(d->stream->ctx, data->num_columns + a->components <= BRIO_MOST_NUMBERS, BRIO_ERR_FORMAT,
                 "%s: more than %d numbers a point", d->stream->name, BRIO_MOST_NUMBERS);
    BRIO_TRY(BRIO_RESERVE(d->stream->ctx, data->columns, data->capacity, data->num_columns + a->components));
    for (uint64_t k = 0; k < a->components; k++) {
        brio_vtk_column *c = &data->columns[data->num_columns++];
        *c = (brio_vtk_column){.component = k, .components = a->components, .file_type = a->type};
        memcpy(c->source, a->name, sizeof c->source);
        c->type = a->type < BRIO_SCALAR_END ? (brio_scalar)a->type : BRIO_SCALAR_FLOAT64;
    }
done:
    return status;
}

brio_status brio_vtk_leave_out(const brio_vtk_data *data, brio_builder *b, const char *array) {
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
    brio_status status = BRIO_OK;
    size_t size = brio_vtk_type_size(d->array->type), row = size * (size_t)d->array->components;
    for (size_t k = 0; k < d->array->components; k++) {
        brio_vtk_column *c = &columns[k];
        BRIO_TRY(BRIO_RESERVE(d->stream->ctx, c->data, c->capacity, (c->rows + rows) * brio_scalar_size(c->type)));
        char *to = c->data + c->rows * brio_scalar_size(c->type);
        if (d->array->type < BRIO_SCALAR_END)
            brio_scalar_gather(to, chunk + k * size, rows, row, size, d->swap);
        else
            c->rounded |= convert_wide(to, chunk + k * size, rows, d);
        c->rows += rows;
    }
done:
    return status;
}

/* Makes room for all rows at once. Their number was held against the file. */
static brio_status reserve(brio_vtk_column *columns, const brio_vtk_decoder *d, uint64_t rows) {
    brio_status status = BRIO_OK;
    for (size_t k = 0; k < d->array->components; k++) {
        brio_vtk_column *c = &columns[k];
        size_t need = (size_t)rows * brio_scalar_size(c->type);
        if (c->rows || c->capacity >= need) continue;
        BRIO_TRY(BRIO_RESIZE(d->stream->ctx, c->data, need));
        c->capacity = need;
    }
done:
    return status;
}

brio_status brio_vtk_read_data(brio_vtk_data *data, brio_builder *b, brio_vtk_decoder *d, uint64_t bytes,
                               uint64_t first, uint64_t rows) {
    brio_status status = BRIO_OK;
    brio_vtk_column *columns = find(data, d->array);
    size_t row = (size_t)d->array->components * brio_vtk_type_size(d->array->type), got;
    uint64_t end = first + rows;
    if (!columns && first) return brio_vtk_leave_out(data, b, d->array->name);
    if (!columns) BRIO_TRY(add_columns(data, d));
    if (!columns) columns = &data->columns[data->num_columns - d->array->components];
    if (columns->components != d->array->components || columns->file_type != d->array->type) return BRIO_OK;
    if (columns->rows == end && rows)
        return brio_fail(d->stream->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": two arrays %s", d->stream->name,
                         brio_stream_offset(d->stream), d->array->name);
    if (columns->rows != first) return BRIO_OK;
    BRIO_TRY(brio_vtk_expect_rows(d, bytes, rows, row));
    if (bytes != UINT64_MAX && d->stream->size != BRIO_SIZE_UNKNOWN) BRIO_TRY(reserve(columns, d, rows));
    if (!data->chunk) BRIO_TRY(BRIO_ALLOC(d->stream->ctx, data->chunk, CHUNK));
    for (;;) {
        BRIO_TRY(brio_vtk_decoder_take(d, data->chunk, CHUNK / row * row, &got));
        if (!got) break;
        if (columns->rows + got / row > end || got % row)
            return brio_vtk_bad_rows(d, columns->rows - first + got / row, rows);
        BRIO_TRY(append(columns, d, data->chunk, got / row));
        d->stream->row = columns->rows - first;
    }
    if (columns->rows != end) return brio_vtk_bad_rows(d, columns->rows - first, rows);
done:
    return status;
}

brio_status brio_vtk_keep_array(brio_vtk_data *data, brio_stream *s, const brio_vtk_array *array,
                                const brio_vtk_values *values) {
    brio_status status = BRIO_OK;
    const brio_vtk_decoder d = {.stream = s, .array = array};
    BRIO_TRY(add_columns(data, &d));
    BRIO_TRY(append(&data->columns[data->num_columns - array->components], &d, values->bytes,
                    (size_t)(values->count / array->components)));
done:
    return status;
}

/* --- properties --- */

static bool is_colour(const brio_vtk_column *c) {
    static const char *const names[] = {"rgb", "rgba", "color", "colors", "colour", "colours"};
    if (c->file_type != BRIO_SCALAR_UINT8 || (c->components != 3 && c->components != 4)) return false;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcasecmp(c->source, names[i])) return true;
    return false;
}

void brio_vtk_choose_name(const brio_vtk_data *data, brio_builder *b, const brio_vtk_column *c, char name[64]) {
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
    brio_status status = BRIO_OK;
    char name[64];
    for (size_t i = 0; i < data->num_columns; i++) {
        brio_vtk_column *c = &data->columns[i];
        if (c->rows != b->mesh->num_vertices) {
            BRIO_TRY(brio_vtk_leave_out(data, b, c->source));
            continue;
        }
        if (c->rounded) BRIO_TRY(brio_builder_leave_out(b, "integers beyond 2^53"));
        brio_vtk_choose_name(data, b, c, name);
        void *block = c->data;
        c->data = NULL;
        if (block)
            BRIO_TRY(brio_builder_adopt_property(b, name, c->type, block));
        else
            BRIO_TRY(brio_builder_property(b, name, c->type));
    }
done:
    return status;
}

void brio_vtk_data_free(brio_context *ctx, brio_vtk_data *data) {
    for (size_t i = 0; i < data->num_columns; i++) brio_release(ctx, data->columns[i].data);
    brio_release(ctx, data->columns);
    brio_release(ctx, data->chunk);
}
