/* Writes PLY files: binary in this machine's byte order, or text.
 *
 * While the number of vertices is not known, a comment keeps room for its digits.
 *
 * The place of every binary row is known in advance: threads encode chunks of rows, and each chunk is written as a
 * whole. */
#include "base/memory.h"
#include "base/team.h"
#include "io/ply_header.h"
#include "io/row_format.h"
#include "io/scalar.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* COUNT_LINES: bytes of the lines that count_lines makes. */
enum { DIGITS = 20, COUNT_LINES = DIGITS + 24 };

typedef struct {
    bool long_lists;
    uint64_t count_at; /* the byte at which the number of vertices is to be written, or 0 */
} ply_writer;

/* Returns the most corners of a face: of triangles that are only announced, 3. */
static size_t most_corners(const brio_mesh *m) {
    size_t most = m->face_offsets ? 0 : 3;
    for (size_t f = 0; m->face_offsets && f < m->num_faces; f++) {
        size_t corners = (size_t)(m->face_offsets[f + 1] - m->face_offsets[f]);
        if (corners > most) most = corners;
    }
    return most;
}

/* Makes the line with the number of vertices, and a comment before it that fills up to COUNT_LINES bytes. */
static void count_lines(char text[COUNT_LINES + 1], uint64_t points) {
    char line[COUNT_LINES + 1];
    int length = snprintf(line, sizeof line, "\nelement vertex %" PRIu64 "\n", points);
    memset(text, ' ', COUNT_LINES);
    memcpy(text, "comment", 7);
    memcpy(text + COUNT_LINES - length, line, (size_t)length + 1);
}

static brio_status write_count(brio_output *out, const brio_write_job *job, ply_writer *w) {
    char text[COUNT_LINES + 1];
    if (job->points != BRIO_COUNT_UNKNOWN) return brio_output_format(out, "element vertex %" PRIu64 "\n", job->points);
    w->count_at = brio_output_offset(out);
    count_lines(text, 0);
    return brio_output_string(out, text);
}

/* Writes the coordinate system as comments of at most CRS_LINE bytes, which readers with short lines take. No line ends
 * with a blank, which some of them drop. */
static brio_status write_crs(brio_output *out, const brio_mesh *m) {
    enum { CRS_LINE = 200 };
    const brio_metadata *crs = brio_mesh_metadata(m, "crs.wkt");
    if (!crs) crs = brio_mesh_metadata(m, "crs.code");
    for (size_t at = 0, end; crs && at < crs->size; at = end) {
        BRIO_FORWARD(brio_output_string(out, "comment crs "));
        end = crs->size - at < CRS_LINE ? crs->size : at + CRS_LINE;
        while (end < crs->size && end > at + 1 &&
               (brio_is_blank(crs->bytes[end - 1]) || (crs->bytes[end] & 0xc0) == 0x80))
            end--;
        for (; at < end; at++) {
            char c = (unsigned char)crs->bytes[at] < ' ' ? ' ' : crs->bytes[at];
            BRIO_FORWARD(brio_output_bytes(out, &c, 1));
        }
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

static brio_status write_header(brio_output *out, const brio_write_job *job, ply_writer *w) {
    const brio_mesh *m = job->mesh;
    const char *binary = brio_host_is_little() ? "binary_little_endian" : "binary_big_endian";
    uint64_t points = job->points != BRIO_COUNT_UNKNOWN ? job->points : m->num_vertices;
    const char *index = points > INT32_MAX ? "uint" : "int";
    BRIO_FORWARD(brio_output_format(out, "ply\nformat %s 1.0\n", job->options->ascii ? "ascii" : binary));
    BRIO_FORWARD(brio_output_comment(out, "comment ", job->options->comment));
    if (job->options->crs_comment) BRIO_FORWARD(write_crs(out, m));
    BRIO_FORWARD(write_count(out, job, w));
    for (int k = 0; k < 3; k++)
        BRIO_FORWARD(brio_output_format(out, "property %s %c\n", job->options->float32 ? "float" : "double", "xyz"[k]));
    for (size_t i = 0; i < m->num_properties; i++)
        BRIO_FORWARD(
            brio_output_format(out, "property %s %s\n", brio_ply_type_name(m->properties[i].type), job->names[i]));
    if (m->num_faces)
        BRIO_FORWARD(brio_output_format(out, "element face %zu\nproperty list %s %s vertex_indices\n", m->num_faces,
                                        w->long_lists ? "int" : "uchar", index));
    for (size_t i = 0; i < m->num_face_properties && m->num_faces; i++)
        BRIO_FORWARD(brio_output_format(out, "property %s %s\n", brio_ply_type_name(m->face_properties[i].type),
                                        job->face_names[i]));
    if (m->num_tetrahedra)
        BRIO_FORWARD(brio_output_format(out, "element tetrahedron %zu\nproperty list uchar %s vertex_indices\n",
                                        m->num_tetrahedra, index));
    if (m->num_edges)
        BRIO_FORWARD(brio_output_format(out, "element edge %zu\nproperty %s vertex1\nproperty %s vertex2\n",
                                        m->num_edges, index, index));
    return brio_output_string(out, "end_header\n");
}

/* --- binary rows --- */

/* CHUNK: faces encoded at a time. Both chosen. */
enum { CHUNK = 1 << 16, ROWS_A_THREAD = 1 << 15 };

/* A chunk of encoded faces from `first` on. */
typedef struct {
    const brio_write_job *job;
    size_t first;
    char *bytes;
    size_t size, extra; /* bytes of the number before the corners of a face, and of its properties behind them */
} rows;

static void encode_list(const uint32_t *items, size_t count, bool long_list, char *bytes) {
    uint32_t wide = (uint32_t)count;
    uint8_t narrow = (uint8_t)count;
    size_t size = long_list ? sizeof wide : sizeof narrow;
    memcpy(bytes, long_list ? (const void *)&wide : &narrow, size);
    memcpy(bytes + size, items, count * sizeof *items);
}

static void encode_faces(void *user, size_t begin, size_t end, int thread) {
    const rows *r = user;
    const brio_mesh *m = r->job->mesh;
    const uint64_t *offsets = m->face_offsets + r->first;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        size_t corners = (size_t)(offsets[i + 1] - offsets[i]);
        char *at = r->bytes + i * (r->size + r->extra) + (size_t)(offsets[i] - offsets[0]) * sizeof(uint32_t);
        encode_list(m->face_vertices + offsets[i], corners, r->size == sizeof(uint32_t), at);
        at += r->size + corners * sizeof(uint32_t);
        for (size_t k = 0; k < m->num_face_properties; k++) {
            size_t size = brio_scalar_size(m->face_properties[k].type);
            memcpy(at, (const char *)m->face_properties[k].data + (r->first + i) * size, size);
            at += size;
        }
    }
}

static brio_status write_binary_faces(brio_output *out, const brio_write_job *job, bool long_lists) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    size_t head = long_lists ? sizeof(uint32_t) : sizeof(uint8_t), capacity = 0, extra = 0;
    char *bytes = NULL;
    for (size_t k = 0; k < m->num_face_properties; k++) extra += brio_scalar_size(m->face_properties[k].type);
    for (size_t begin = 0; begin < m->num_faces; begin += CHUNK) {
        size_t count = m->num_faces - begin < CHUNK ? m->num_faces - begin : CHUNK;
        const uint64_t *offsets = m->face_offsets + begin;
        size_t size = count * (head + extra) + (size_t)(offsets[count] - offsets[0]) * sizeof(uint32_t);
        BRIO_TRY(BRIO_RESERVE(out->ctx, bytes, capacity, size));
        BRIO_TRY(brio_for(out->ctx, brio_threads(out->ctx, count, ROWS_A_THREAD), count, encode_faces,
                          &(rows){job, begin, bytes, head, extra}));
        BRIO_TRY(brio_output_bytes(out, bytes, size));
    }
done:
    brio_release(out->ctx, bytes);
    return status;
}

static brio_status write_binary(brio_output *out, const brio_write_job *job, bool long_lists) {
    const brio_mesh *m = job->mesh;
    BRIO_FORWARD(write_binary_faces(out, job, long_lists));
    for (size_t t = 0; t < m->num_tetrahedra; t++) {
        char bytes[1 + 4 * sizeof(uint32_t)];
        encode_list(m->tetrahedra + 4 * t, 4, false, bytes);
        BRIO_FORWARD(brio_output_bytes(out, bytes, sizeof bytes));
    }
    if (m->num_edges) BRIO_FORWARD(brio_output_bytes(out, m->edges, 2 * m->num_edges * sizeof *m->edges));
    return BRIO_OK;
}

/* --- text --- */

static brio_status write_text_vertex(brio_output *out, const brio_write_job *job, size_t v) {
    const double *p = job->mesh->vertices + 3 * v;
    double rounded[3] = {p[0], p[1], p[2]};
    if (job->options->float32)
        for (int k = 0; k < 3; k++) rounded[k] = (double)(float)p[k];
    BRIO_FORWARD(brio_output_point(out, rounded));
    for (size_t i = 0; i < job->mesh->num_properties; i++)
        BRIO_FORWARD(brio_output_scalar(out, ' ', &job->mesh->properties[i], v));
    return brio_output_string(out, "\n");
}

static brio_status write_text_list(brio_output *out, const uint32_t *items, size_t count) {
    BRIO_FORWARD(brio_output_integer(out, 0, (int64_t)count));
    for (size_t i = 0; i < count; i++) BRIO_FORWARD(brio_output_integer(out, ' ', items[i]));
    return BRIO_OK;
}

static brio_status write_text_face(brio_output *out, const brio_mesh *m, size_t f) {
    uint64_t from = m->face_offsets[f], to = m->face_offsets[f + 1];
    BRIO_FORWARD(write_text_list(out, m->face_vertices + from, (size_t)(to - from)));
    for (size_t i = 0; i < m->num_face_properties; i++)
        BRIO_FORWARD(brio_output_scalar(out, ' ', &m->face_properties[i], f));
    return brio_output_string(out, "\n");
}

static brio_status write_text_edge(brio_output *out, const uint32_t *edge) {
    BRIO_FORWARD(brio_output_integer(out, 0, edge[0]));
    BRIO_FORWARD(brio_output_integer(out, ' ', edge[1]));
    return brio_output_string(out, "\n");
}

static brio_status write_text(brio_output *out, const brio_write_job *job) {
    const brio_mesh *m = job->mesh;
    for (size_t f = 0; f < m->num_faces; f++) BRIO_FORWARD(write_text_face(out, m, f));
    for (size_t t = 0; t < m->num_tetrahedra; t++) {
        BRIO_FORWARD(write_text_list(out, m->tetrahedra + 4 * t, 4));
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    for (size_t e = 0; e < m->num_edges; e++) BRIO_FORWARD(write_text_edge(out, m->edges + 2 * e));
    return BRIO_OK;
}

/* --- file --- */

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    ply_writer *w = state;
    size_t corners = most_corners(job->mesh);
    w->long_lists = corners > UINT8_MAX;
    BRIO_EXPECT(out->ctx, corners <= INT32_MAX, BRIO_ERR_ARGUMENT, "%s: a face of %zu corners does not fit a PLY file",
                out->name, corners);
    return write_header(out, job, w);
}

static brio_status write_vertices(brio_output *out, const brio_write_job *job, void *state) {
    (void)state;
    if (!job->options->ascii) return brio_rows_write(out, job);
    for (size_t v = 0; v < job->mesh->num_vertices; v++) BRIO_FORWARD(write_text_vertex(out, job, v));
    return BRIO_OK;
}

static brio_status end(brio_output *out, const brio_write_job *job, void *state) {
    const ply_writer *w = state;
    char count[COUNT_LINES + 1];
    if (w->count_at) {
        count_lines(count, job->points);
        BRIO_FORWARD(brio_output_patch(out, w->count_at, count, COUNT_LINES));
    }
    return job->options->ascii ? write_text(out, job) : write_binary(out, job, w->long_lists);
}

const brio_row_format brio_ply_rows = {
    .state = sizeof(ply_writer), .counts = true, .begin = begin, .rows = write_vertices, .end = end};
