/* Writes PCD files: binary, text, or compressed by LZF.
 *
 * Colours of bytes are packed into the field rgb (rgba with alpha), and normals have the names of PCL. All other
 * properties are fields of their types and names. Compressed data have all numbers of a field before those of the next
 * one, so they are in memory until the end; they hold 4 GiB at most.
 *
 * Based on: Rusu Cousins. 3D is here: Point Cloud Library. ICRA 2011; PCL's description of the format, version 0.7. */
#include "base/memory.h"
#include "io/little_endian.h"
#include "io/pcd_header.h"
#include "io/row_format.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* DIGITS: room for a count that is written last. CHUNK: rows encoded at a time; chosen. */
enum { DIGITS = 20, CHUNK = 1 << 12, AXES = 3 };

/* A field of the file: a coordinate, a packed colour, or a property. */
typedef struct {
    enum { FIELD_AXIS, FIELD_COLOUR, FIELD_PROPERTY } kind;
    size_t from; /* axis or index of the property */
    unsigned size;
    char *column; /* compressed: the numbers so far */
    size_t capacity;
} pcd_field;

typedef struct {
    pcd_field *fields;
    size_t num_fields, record;
    brio_channels colour;         /* of the block, in bytes; count 0: none */
    uint64_t width_at, points_at; /* the bytes at which the number of points is to be written, or 0 */
    size_t rows;                  /* of the columns */
} pcd_writer;

/* --- header --- */

static char type_letter(brio_scalar type) {
    static const char letters[BRIO_SCALAR_END + 1] = "IUIUIUFF";
    return letters[type];
}

static brio_channels byte_colour_of(const brio_mesh *m) {
    brio_channels colour = brio_colour_of(m);
    if (colour.count && colour.of[0]->type != BRIO_SCALAR_UINT8) colour.count = 0;
    return colour;
}

static void add_field(pcd_writer *w, pcd_field field) {
    w->fields[w->num_fields++] = field;
    w->record += field.size;
}

static brio_status plan(brio_output *out, const brio_write_job *job, pcd_writer *w) {
    const brio_mesh *m = job->mesh;
    w->colour = byte_colour_of(m);
    BRIO_FORWARD(BRIO_ALLOC_ZERO(out->ctx, w->fields, AXES + m->num_properties));
    for (size_t k = 0; k < AXES; k++) add_field(w, (pcd_field){FIELD_AXIS, k, job->options->float32 ? 4 : 8, NULL, 0});
    for (size_t i = 0; i < m->num_properties; i++) {
        const brio_property *p = &m->properties[i];
        if (w->colour.count && p == w->colour.of[0]) add_field(w, (pcd_field){FIELD_COLOUR, 0, 4, NULL, 0});
        if (brio_channels_have(&w->colour, p)) continue;
        unsigned size = (unsigned)brio_scalar_size(p->type);
        add_field(w, (pcd_field){FIELD_PROPERTY, i, size, NULL, 0});
    }
    return BRIO_OK;
}

/* Returns whether a name has a meaning of PCL's: its reader takes rgb and rgba for packed colours, and _ for bytes to
 * skip. */
static bool is_reserved(const char *name) {
    return !strcmp(name, "rgb") || !strcmp(name, "rgba") || !strcmp(name, "_");
}

static brio_status write_name(brio_output *out, const brio_write_job *job, const pcd_writer *w, const pcd_field *f) {
    static const char *const normal_names[] = {"normal_x", "normal_y", "normal_z"};
    const brio_mesh *m = job->mesh;
    brio_channels normal = brio_normal_of(m);
    if (f->kind == FIELD_AXIS) return brio_output_format(out, " %c", "xyz"[f->from]);
    if (f->kind == FIELD_COLOUR) return brio_output_string(out, w->colour.count == 4 ? " rgba" : " rgb");
    for (int k = 0; k < normal.count; k++)
        if (normal.of[k] == &m->properties[f->from] && !brio_mesh_property(m, normal_names[k]))
            return brio_output_format(out, " %s", normal_names[k]);
    return brio_output_format(out, " %s", job->names[f->from]);
}

/* Returns the letter of a type. A text has packed colours as whole numbers; in binary data PCL's rgb is a float and its
 * rgba an integer. */
static char letter_of(const brio_write_job *job, const pcd_writer *w, const pcd_field *f) {
    if (f->kind == FIELD_AXIS) return 'F';
    if (f->kind == FIELD_COLOUR) return w->colour.count == 4 || job->options->ascii ? 'U' : 'F';
    return type_letter(job->mesh->properties[f->from].type);
}

/* Writes a line with a count, and where the count goes if it is not known. */
static brio_status write_count(brio_output *out, const char *key, uint64_t points, uint64_t *at) {
    if (points != BRIO_COUNT_UNKNOWN) return brio_output_format(out, "%s %" PRIu64 "\n", key, points);
    BRIO_FORWARD(brio_output_format(out, "%s ", key));
    *at = brio_output_offset(out);
    return brio_output_format(out, "%*s\n", DIGITS, "");
}

static brio_status write_header(brio_output *out, const brio_write_job *job, pcd_writer *w) {
    BRIO_FORWARD(brio_output_string(out, "# .PCD v0.7 - Point Cloud Data file format\n"));
    BRIO_FORWARD(brio_output_comment(out, "# ", job->options->comment));
    BRIO_FORWARD(brio_output_string(out, "VERSION 0.7\nFIELDS"));
    for (size_t i = 0; i < w->num_fields; i++) BRIO_FORWARD(write_name(out, job, w, &w->fields[i]));
    BRIO_FORWARD(brio_output_string(out, "\nSIZE"));
    for (size_t i = 0; i < w->num_fields; i++) BRIO_FORWARD(brio_output_format(out, " %u", w->fields[i].size));
    BRIO_FORWARD(brio_output_string(out, "\nTYPE"));
    for (size_t i = 0; i < w->num_fields; i++)
        BRIO_FORWARD(brio_output_format(out, " %c", letter_of(job, w, &w->fields[i])));
    BRIO_FORWARD(brio_output_string(out, "\nCOUNT"));
    for (size_t i = 0; i < w->num_fields; i++) BRIO_FORWARD(brio_output_string(out, " 1"));
    BRIO_FORWARD(brio_output_string(out, "\n"));
    BRIO_FORWARD(write_count(out, "WIDTH", job->points, &w->width_at));
    BRIO_FORWARD(brio_output_string(out, "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"));
    BRIO_FORWARD(write_count(out, "POINTS", job->points, &w->points_at));
    const char *data = job->options->ascii ? "ascii" : job->options->compress ? "binary_compressed" : "binary";
    return brio_output_format(out, "DATA %s\n", data);
}

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    pcd_writer *w = state;
    for (size_t i = 0; i < job->mesh->num_properties; i++)
        if (is_reserved(job->names[i])) strcat(job->names[i], "_2");
    BRIO_FORWARD(plan(out, job, w));
    return write_header(out, job, w);
}

/* --- numbers --- */

static uint32_t packed_colour(const pcd_writer *w, size_t v) {
    uint32_t packed = 0;
    for (int k = 0; k < w->colour.count; k++)
        packed |= (uint32_t)((const uint8_t *)w->colour.of[k]->data)[v] << (k < 3 ? 16 - 8 * k : 24);
    return packed;
}

/* Encodes a number, little endian. */
static void encode(const brio_mesh *m, const pcd_writer *w, const pcd_field *f, size_t v, char *bytes) {
    uint64_t raw = 0;
    if (f->kind == FIELD_COLOUR) {
        brio_put_le32(bytes, packed_colour(w, v));
        return;
    }
    double x = f->kind == FIELD_AXIS ? m->vertices[AXES * v + f->from] : 0;
    float single = (float)x;
    const void *number = f->size == 4 ? (const void *)&single : &x;
    if (f->kind == FIELD_PROPERTY) number = (const char *)m->properties[f->from].data + v * f->size;
    if (!brio_host_is_little()) {
        for (unsigned i = 0; i < f->size; i++) bytes[i] = ((const char *)number)[f->size - 1 - i];
        return;
    }
    memcpy(&raw, number, f->size);
    memcpy(bytes, &raw, f->size);
}

static brio_status write_text(brio_output *out, const brio_write_job *job, const pcd_writer *w) {
    const brio_mesh *m = job->mesh;
    for (size_t v = 0; v < m->num_vertices; v++) {
        for (size_t i = 0; i < w->num_fields; i++) {
            const pcd_field *f = &w->fields[i];
            double x = f->kind == FIELD_AXIS ? m->vertices[AXES * v + f->from] : 0;
            char before = i ? ' ' : 0;
            if (f->kind == FIELD_AXIS)
                BRIO_FORWARD(brio_output_double(out, before, f->size == 4 ? (double)(float)x : x));
            else if (f->kind == FIELD_COLOUR)
                BRIO_FORWARD(brio_output_integer(out, before, packed_colour(w, v)));
            else
                BRIO_FORWARD(brio_output_scalar(out, before, &m->properties[f->from], v));
        }
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

static brio_status write_binary(brio_output *out, const brio_write_job *job, const pcd_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    char *bytes = NULL;
    BRIO_TRY(BRIO_ALLOC(out->ctx, bytes, CHUNK * w->record));
    for (size_t first = 0; first < m->num_vertices; first += CHUNK) {
        size_t count = m->num_vertices - first < CHUNK ? m->num_vertices - first : CHUNK;
        char *at = bytes;
        for (size_t v = first; v < first + count; v++)
            for (size_t i = 0; i < w->num_fields; at += w->fields[i++].size) encode(m, w, &w->fields[i], v, at);
        BRIO_TRY(brio_output_bytes(out, bytes, count * w->record));
    }
done:
    brio_release(out->ctx, bytes);
    return status;
}

static brio_status keep_columns(brio_output *out, const brio_write_job *job, pcd_writer *w) {
    const brio_mesh *m = job->mesh;
    BRIO_EXPECT(out->ctx, m->num_vertices <= UINT32_MAX / w->record - w->rows, BRIO_ERR_ARGUMENT,
                "%s: compressed data hold 4 GiB at most", out->name);
    for (size_t i = 0; i < w->num_fields; i++) {
        pcd_field *f = &w->fields[i];
        BRIO_FORWARD(BRIO_RESERVE(out->ctx, f->column, f->capacity, (w->rows + m->num_vertices) * f->size));
        for (size_t v = 0; v < m->num_vertices; v++) encode(m, w, f, v, f->column + (w->rows + v) * f->size);
    }
    w->rows += m->num_vertices;
    return BRIO_OK;
}

static brio_status write_rows(brio_output *out, const brio_write_job *job, void *state) {
    pcd_writer *w = state;
    w->colour = byte_colour_of(job->mesh);
    if (job->options->ascii) return write_text(out, job, w);
    return job->options->compress ? keep_columns(out, job, w) : write_binary(out, job, w);
}

/* --- the end --- */

static brio_status write_compressed(brio_output *out, const pcd_writer *w) {
    brio_status status = BRIO_OK;
    size_t size = w->rows * w->record, at = 0, packed = 0;
    uint8_t *plain = NULL, *bytes = NULL;
    uint32_t *table = NULL;
    char sizes[8];
    BRIO_TRY(BRIO_ALLOC(out->ctx, plain, size + 1));
    BRIO_TRY(BRIO_ALLOC(out->ctx, bytes, brio_lzf_room(size)));
    BRIO_TRY(BRIO_ALLOC(out->ctx, table, BRIO_LZF_TABLE));
    for (size_t i = 0; i < w->num_fields && w->rows; at += w->rows * w->fields[i++].size)
        memcpy(plain + at, w->fields[i].column, w->rows * w->fields[i].size);
    packed = brio_lzf_compress(plain, size, bytes, table);
    BRIO_REQUIRE(out->ctx, packed <= UINT32_MAX, BRIO_ERR_ARGUMENT, "%s: compressed data hold 4 GiB at most",
                 out->name);
    brio_put_le32(sizes, (uint32_t)packed);
    brio_put_le32(sizes + 4, (uint32_t)size);
    BRIO_TRY(brio_output_bytes(out, sizes, sizeof sizes));
    BRIO_TRY(brio_output_bytes(out, bytes, packed));
done:
    brio_release(out->ctx, plain);
    brio_release(out->ctx, bytes);
    brio_release(out->ctx, table);
    return status;
}

static brio_status patch_count(brio_output *out, uint64_t at, uint64_t points) {
    char digits[DIGITS + 1];
    if (!at) return BRIO_OK;
    snprintf(digits, sizeof digits, "%-*" PRIu64, DIGITS, points);
    return brio_output_patch(out, at, digits, DIGITS);
}

static brio_status end(brio_output *out, const brio_write_job *job, void *state) {
    const pcd_writer *w = state;
    BRIO_FORWARD(patch_count(out, w->width_at, job->points));
    BRIO_FORWARD(patch_count(out, w->points_at, job->points));
    if (job->options->compress) BRIO_FORWARD(write_compressed(out, w));
    return BRIO_OK;
}

static void free_state(brio_context *ctx, void *state) {
    pcd_writer *w = state;
    for (size_t i = 0; i < w->num_fields; i++) brio_release(ctx, w->fields[i].column);
    brio_release(ctx, w->fields);
}

const brio_row_format brio_pcd_rows = {
    .state = sizeof(pcd_writer), .counts = true, .begin = begin, .rows = write_rows, .end = end, .free = free_state};
