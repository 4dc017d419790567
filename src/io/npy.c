/* NPY files of NumPy: an array of rows, or of records with names.
 *
 * Rows have three or more numbers: x, y, z, and properties column4, column5, ... Records have fields x, y, z, all other
 * fields are properties. Integers of 64 bits become doubles. An array in Fortran's order is one column after the other.
 *
 * Based on: NumPy enhancement proposal 1: a simple file format for NumPy arrays. 2007. */
#include "io/formats.h"
#include "io/little_endian.h"
#include "io/npy_header.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

bool brio_npy_starts(const char *bytes, size_t size) {
    return size >= 6 && !memcmp(bytes, "\x93NUMPY", 6);
}

/* --- reading --- */

static brio_status plan(brio_builder *b, brio_npy_header *h) {
    brio_status status = BRIO_OK;
    unsigned axes = 0;
    for (size_t i = 0; i < h->num_fields; i++) {
        brio_npy_field *f = &h->fields[i];
        bool axis = f->name[0] >= 'x' && f->name[0] <= 'z' && !f->name[1];
        f->axis = axis ? f->name[0] - 'x' : -1;
        f->property = b->mesh->num_properties;
        if (axis)
            axes |= 1u << f->axis;
        else
            BRIO_TRY(brio_builder_property(b, f->name, f->wide ? BRIO_SCALAR_FLOAT64 : f->type));
    }
    BRIO_REQUIRE(b->ctx, axes == 7, BRIO_ERR_FORMAT, "%s: the records have no field %c", b->name, "xyxzxyx"[axes]);
done:
    return status;
}

static void store(const brio_mesh *m, const brio_npy_field *f, size_t v, const char *bytes) {
    double value = brio_npy_load(f, bytes);
    if (f->axis >= 0) {
        m->vertices[3 * v + (size_t)f->axis] = value;
        return;
    }
    brio_property *p = &m->properties[f->property];
    brio_scalar_store((char *)p->data + v * brio_scalar_size(p->type), p->type, value);
}

static brio_status read_rows(brio_stream *s, brio_builder *b, const brio_npy_header *h) {
    brio_status status = BRIO_OK;
    const char *bytes = NULL;
    for (; s->row < h->rows; s->row++) {
        BRIO_TRY(brio_stream_take(s, h->record, &bytes));
        BRIO_TRY(brio_builder_add_vertices(b, 1));
        for (size_t i = 0; i < h->num_fields; i++)
            store(b->mesh, &h->fields[i], (size_t)s->row, bytes + h->fields[i].at);
    }
done:
    return status;
}

static brio_status read_columns(brio_stream *s, brio_builder *b, const brio_npy_header *h) {
    brio_status status = BRIO_OK;
    const char *bytes = NULL;
    for (size_t i = 0; i < h->num_fields; i++)
        for (s->row = 0; s->row < h->rows; s->row++) {
            if (i == 0) BRIO_TRY(brio_builder_add_vertices(b, 1));
            BRIO_TRY(brio_stream_take(s, h->record / h->num_fields, &bytes));
            store(b->mesh, &h->fields[i], (size_t)s->row, bytes);
        }
done:
    return status;
}

brio_status brio_npy_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_npy_header h;
    BRIO_TRY(brio_npy_header_read(s, &h));
    BRIO_TRY(brio_stream_expect(s, h.rows, h.record, "the header"));
    BRIO_REQUIRE(b->ctx, h.rows <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE,
                 "%s: %" PRIu64 " points, the most are %" PRIu64, b->name, h.rows, BRIO_MAX_VERTICES);
    BRIO_TRY(plan(b, &h));
    if (s->size != BRIO_SIZE_UNKNOWN) BRIO_TRY(brio_builder_expect_vertices(b, h.rows));
    brio_stream_element(s, "row", h.rows);
    BRIO_TRY(h.fortran ? read_columns(s, b, &h) : read_rows(s, b, &h));
done:
    brio_npy_header_free(s->ctx, &h);
    return status;
}

/* --- writing --- */

/* Writes the header: a dictionary of Python. Its length with what precedes it is a multiple of 64. */
static brio_status write_header(brio_output *out, const brio_write_job *job, bool count_only, size_t *length) {
    static const char *const types[BRIO_SCALAR_END] = {"|i1", "|u1", "<i2", "<u2", "<i4", "<u4", "<f4", "<f8"};
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    const char *real = job->options->float32 ? "<f4" : "<f8";
    char text[160];
    *length = 0;
#define PUT(...)                                                                                                       \
    do {                                                                                                               \
        *length += (size_t)snprintf(text, sizeof text, __VA_ARGS__);                                                   \
        if (!count_only) BRIO_TRY(brio_output_string(out, text));                                                      \
    } while (0)
    if (m->num_properties) {
        PUT("{'descr': [('x', '%s'), ('y', '%s'), ('z', '%s')", real, real, real);
        for (size_t i = 0; i < m->num_properties; i++)
            PUT(", ('%s', '%s')", job->names[i], types[m->properties[i].type]);
        PUT("], 'fortran_order': False, 'shape': (%zu,), }", m->num_vertices);
    } else {
        PUT("{'descr': '%s', 'fortran_order': False, 'shape': (%zu, 3), }", real, m->num_vertices);
    }
#undef PUT
done:
    return status;
}

static brio_status write_start(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    char start[12] = "\x93NUMPY\x02"; /* version 2.0: a length of 32 bits */
    size_t length;
    BRIO_TRY(write_header(out, job, true, &length));
    size_t blanks = 63 - (sizeof start + length) % 64;
    brio_put_le32(start + 8, (uint32_t)(length + blanks + 1));
    BRIO_TRY(brio_output_bytes(out, start, sizeof start));
    BRIO_TRY(write_header(out, job, false, &length));
    for (size_t i = 0; i < blanks; i++) BRIO_TRY(brio_output_string(out, " "));
    BRIO_TRY(brio_output_string(out, "\n"));
done:
    return status;
}

static brio_status write_number(brio_output *out, const void *number, size_t size) {
    char bytes[8];
    brio_scalar_gather(bytes, number, 1, size, size, !brio_host_is_little());
    return brio_output_bytes(out, bytes, size);
}

brio_status brio_npy_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    BRIO_TRY(write_start(out, job));
    for (size_t v = 0; v < m->num_vertices; v++) {
        for (size_t k = 0; k < 3; k++) {
            float single = (float)m->vertices[3 * v + k];
            BRIO_TRY(job->options->float32 ? write_number(out, &single, sizeof single)
                                           : write_number(out, &m->vertices[3 * v + k], sizeof(double)));
        }
        for (size_t i = 0; i < m->num_properties; i++) {
            size_t size = brio_scalar_size(m->properties[i].type);
            BRIO_TRY(write_number(out, (const char *)m->properties[i].data + v * size, size));
        }
    }
done:
    return status;
}
