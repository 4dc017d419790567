/* NPY files of NumPy: an array of rows, or of records with names.
 *
 * Rows have three or more numbers: x, y, z, and properties column4, column5, ... Records have fields x, y, z or X, Y,
 * Z, or one field of three numbers such as xyz; all other fields of numbers are properties. Integers of 64 bits become
 * doubles. An array in Fortran's order is one column after the other.
 *
 * Based on: NumPy enhancement proposal 1: a simple file format for NumPy arrays. 2007. */
#include "base/memory.h"
#include "io/little_endian.h"
#include "io/npy_header.h"
#include "io/row_format.h"
#include "io/builder.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static bool starts(const char *bytes, size_t size) {
    return size >= 6 && !memcmp(bytes, "\x93NUMPY", 6);
}

/* --- reading --- */

/* Returns the letters of the coordinates' fields: PDAL writes X, Y, Z. */
static const char *letters_of(const brio_npy_header *h) {
    for (size_t i = 0; i < h->num_fields; i++)
        if (h->fields[i].name[0] >= 'x' && h->fields[i].name[0] <= 'z' && !h->fields[i].name[1]) return "xyz";
    return "XYZ";
}

static brio_status plan(brio_builder *b, brio_npy_header *h) {
    const char *letters = letters_of(h);
    unsigned axes = 0;
    for (size_t i = 0; i < h->num_fields; i++) {
        brio_npy_field *f = &h->fields[i];
        bool axis = f->name[0] >= letters[0] && f->name[0] <= letters[2] && !f->name[1];
        f->axis = axis ? f->name[0] - letters[0] : -1;
        f->property = b->mesh->num_properties;
        BRIO_EXPECT(b->ctx, !axis || !(axes & 1u << f->axis), BRIO_ERR_FORMAT, "%s: two fields named %s", b->name,
                    f->name);
        if (axis)
            axes |= 1u << f->axis;
        else
            BRIO_FORWARD(brio_builder_property(b, f->name, f->wide ? BRIO_SCALAR_FLOAT64 : f->type));
    }
    for (size_t i = 0; i < h->num_passed; i++) BRIO_FORWARD(brio_builder_leave_out(b, h->passed[i]));
    BRIO_EXPECT(b->ctx, axes == 7, BRIO_ERR_FORMAT, "%s: the records have no field %c", b->name, "xyxzxyx"[axes]);
    return BRIO_OK;
}

static void store(const brio_mesh *m, brio_npy_field *f, size_t v, const char *bytes) {
    double value = brio_npy_load(f, bytes);
    f->rounded |= brio_npy_is_rounded(f, bytes);
    if (f->axis >= 0) {
        m->vertices[3 * v + (size_t)f->axis] = value;
        return;
    }
    brio_property *p = &m->properties[f->property];
    brio_scalar_store((char *)p->data + v * brio_scalar_size(p->type), p->type, value);
}

static brio_status read_rows(brio_stream *s, brio_builder *b, brio_npy_header *h) {
    brio_status status = BRIO_OK;
    const char *bytes = NULL;
    for (; s->row < h->rows; s->row++) {
        status = brio_stream_take(s, h->record, &bytes);
        if (brio_salvage(b, s, brio_builder_count(b), true, &status)) break;
        BRIO_TRY(status);
        BRIO_TRY(brio_builder_add_vertices(b, 1));
        for (size_t i = 0; i < h->num_fields; i++)
            store(b->mesh, &h->fields[i], b->mesh->num_vertices - 1, bytes + h->fields[i].at);
    }
done:
    return status;
}

static brio_status read_columns(brio_stream *s, brio_builder *b, brio_npy_header *h) {
    const char *bytes = NULL;
    for (size_t i = 0; i < h->num_fields; i++)
        for (s->row = 0; s->row < h->rows; s->row++) {
            if (i == 0) BRIO_FORWARD(brio_builder_add_vertices(b, 1));
            BRIO_FORWARD(brio_stream_take(s, h->record / h->num_fields, &bytes));
            store(b->mesh, &h->fields[i], (size_t)s->row, bytes);
        }
    return BRIO_OK;
}

brio_status brio_npy_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_npy_header h;
    BRIO_TRY(brio_npy_header_read(s, &h));
    bool salvages = b->salvage && !h.fortran; /* columns that end early leave no row whole */
    if (!salvages) BRIO_TRY(brio_stream_expect(s, h.rows, h.record, "the header"));
    if (!h.fortran) brio_builder_stream(b, salvages ? BRIO_COUNT_UNKNOWN : h.rows);
    BRIO_REQUIRE(b->ctx, b->streams || h.rows <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE,
                 "%s: %" PRIu64 " points, the most are %" PRIu64, b->name, h.rows, BRIO_MAX_VERTICES);
    BRIO_TRY(plan(b, &h));
    if (s->size != BRIO_SIZE_UNKNOWN && !salvages) BRIO_TRY(brio_builder_expect_vertices(b, h.rows));
    brio_stream_element(s, "row", h.rows);
    BRIO_TRY(h.fortran ? read_columns(s, b, &h) : read_rows(s, b, &h));
    for (size_t i = 0; i < h.num_fields; i++)
        if (h.fields[i].rounded) BRIO_TRY(brio_builder_leave_out(b, "integers beyond 2^53"));
done:
    brio_npy_header_free(s->ctx, &h);
    return status;
}

/* --- writing --- */

/* Where the number of rows is to be written later: the dictionary from there on ends with `behind` and blanks. */
typedef struct {
    size_t at, room; /* room 0: the number was known */
    const char *behind;
} npy_writer;

typedef struct {
    char *bytes;
    size_t used, capacity;
} growing_text;

/* Adds at most 159 bytes. */
static brio_status put(brio_context *ctx, growing_text *t, const char *format, ...) {
    char piece[160];
    va_list arguments;
    va_start(arguments, format);
    size_t length = (size_t)vsnprintf(piece, sizeof piece, format, arguments);
    va_end(arguments);
    brio_status status = BRIO_RESERVE(ctx, t->bytes, t->capacity, t->used + length + 1);
    if (status != BRIO_OK) return status;
    memcpy(t->bytes + t->used, piece, length + 1);
    t->used += length;
    return BRIO_OK;
}

/* Writes a name as Python quotes it: a backslash behind a backslash. Other quotes are no part of names here. */
static brio_status put_name(brio_context *ctx, growing_text *text, const char *name) {
    BRIO_FORWARD(put(ctx, text, "'"));
    for (; *name; name++) BRIO_FORWARD(put(ctx, text, *name == '\\' ? "\\\\" : "%c", *name));
    return put(ctx, text, "'");
}

/* Returns whether a name is not ASCII, so that the header is UTF-8, which version 3.0 is for. */
static bool needs_utf8(const brio_write_job *job) {
    for (size_t i = 0; i < job->mesh->num_properties; i++)
        for (const char *c = job->names[i]; *c; c++)
            if ((unsigned char)*c > 127) return true;
    return false;
}

/* Makes the dictionary of Python up to the number of rows. */
static brio_status make_start(brio_context *ctx, const brio_write_job *job, growing_text *text) {
    static const char *const types[BRIO_SCALAR_END] = {"i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8"};
    const char order = brio_host_is_little() ? '<' : '>', *real = job->options->float32 ? "f4" : "f8";
    const brio_mesh *m = job->mesh;
    BRIO_FORWARD(put(ctx, text, "............{'descr': ")); /* versions 2.0 and 3.0: a length of 32 bits */
    for (int k = 0; k < 3 && m->num_properties; k++)
        BRIO_FORWARD(put(ctx, text, "%s('%c', '%c%s')", k ? ", " : "[", "xyz"[k], order, real));
    for (size_t i = 0; i < m->num_properties; i++) {
        brio_scalar type = m->properties[i].type;
        char letter = brio_scalar_size(type) == 1 ? '|' : order;
        BRIO_FORWARD(put(ctx, text, ", ("));
        BRIO_FORWARD(put_name(ctx, text, job->names[i]));
        BRIO_FORWARD(put(ctx, text, ", '%c%s')", letter, types[type]));
    }
    if (m->num_properties)
        BRIO_FORWARD(put(ctx, text, "]"));
    else
        BRIO_FORWARD(put(ctx, text, "'%c%s'", order, real));
    BRIO_FORWARD(put(ctx, text, ", 'fortran_order': False, 'shape': ("));
    return BRIO_OK;
}

/* Writes all bytes before the rows, a multiple of 64. BRIO_COUNT_UNKNOWN has as many digits as a number can have. */
static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    npy_writer *w = state;
    growing_text text = {.bytes = NULL};
    BRIO_TRY(make_start(out->ctx, job, &text));
    w->at = text.used;
    w->behind = job->mesh->num_properties ? ",), }" : ", 3), }";
    BRIO_TRY(put(out->ctx, &text, "%" PRIu64 "%s", job->points, w->behind));
    while ((text.used + 1) % 64) BRIO_TRY(put(out->ctx, &text, " "));
    BRIO_TRY(put(out->ctx, &text, "\n"));
    memcpy(text.bytes, needs_utf8(job) ? "\x93NUMPY\x03\x00" : "\x93NUMPY\x02\x00", 8);
    brio_put_le32(text.bytes + 8, (uint32_t)(text.used - 12));
    if (job->points == BRIO_COUNT_UNKNOWN) w->room = text.used - 1 - w->at;
    BRIO_TRY(brio_output_bytes(out, text.bytes, text.used));
done:
    brio_release(out->ctx, text.bytes);
    return status;
}

static brio_status write_rows(brio_output *out, const brio_write_job *job, void *state) {
    (void)state;
    return brio_rows_write(out, job);
}

static brio_status end(brio_output *out, const brio_write_job *job, void *state) {
    const npy_writer *w = state;
    char text[128];
    if (!w->room) return BRIO_OK;
    memset(text, ' ', sizeof text);
    int length = snprintf(text, sizeof text, "%" PRIu64 "%s", job->points, w->behind);
    text[length] = ' ';
    return brio_output_patch(out, w->at, text, w->room);
}

static const brio_row_format rows = {
    .state = sizeof(npy_writer), .counts = true, .begin = begin, .rows = write_rows, .end = end};

const brio_codec brio_npy_codec = {.starts = starts, .read = brio_npy_read, .rows = &rows};
