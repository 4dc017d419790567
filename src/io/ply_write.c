/* Writes PLY files: binary in this machine's byte order, or text.
 *
 * The place of every binary row is known in advance: threads encode chunks of rows, and each chunk is written as a
 * whole. */
#include "base/memory.h"
#include "base/team.h"
#include "io/formats.h"
#include "io/ply_header.h"
#include "io/scalar.h"
#include <string.h>

static size_t most_corners(const brio_mesh *m) {
    size_t most = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        size_t corners = (size_t)(m->face_offsets[f + 1] - m->face_offsets[f]);
        if (corners > most) most = corners;
    }
    return most;
}

static brio_status write_header(brio_output *out, const brio_write_job *job, bool long_lists) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    const char *binary = brio_host_is_little() ? "binary_little_endian" : "binary_big_endian";
    const char *index = m->num_vertices > INT32_MAX ? "uint" : "int";
    BRIO_TRY(brio_output_format(out, "ply\nformat %s 1.0\n", job->options->ascii ? "ascii" : binary));
    BRIO_TRY(brio_output_comment(out, "comment ", job->options->comment));
    BRIO_TRY(brio_output_format(out, "element vertex %zu\n", m->num_vertices));
    for (int k = 0; k < 3; k++)
        BRIO_TRY(brio_output_format(out, "property %s %c\n", job->options->float32 ? "float" : "double", "xyz"[k]));
    for (size_t i = 0; i < m->num_properties; i++)
        BRIO_TRY(brio_output_format(out, "property %s %s\n", brio_ply_type_name(m->properties[i].type), job->names[i]));
    if (m->num_faces)
        BRIO_TRY(brio_output_format(out, "element face %zu\nproperty list %s %s vertex_indices\n", m->num_faces,
                                    long_lists ? "int" : "uchar", index));
    if (m->num_tetrahedra)
        BRIO_TRY(brio_output_format(out, "element tetrahedron %zu\nproperty list uchar %s vertex_indices\n",
                                    m->num_tetrahedra, index));
    if (m->num_edges)
        BRIO_TRY(brio_output_format(out, "element edge %zu\nproperty %s vertex1\nproperty %s vertex2\n", m->num_edges,
                                    index, index));
    BRIO_TRY(brio_output_string(out, "end_header\n"));
done:
    return status;
}

/* --- binary rows --- */

/* CHUNK: rows encoded at a time. Both chosen. */
enum { CHUNK = 1 << 16, ROWS_A_THREAD = 1 << 12 };

static size_t vertex_size(const brio_write_job *job) {
    size_t size = 3 * (job->options->float32 ? sizeof(float) : sizeof(double));
    for (size_t i = 0; i < job->mesh->num_properties; i++) size += brio_scalar_size(job->mesh->properties[i].type);
    return size;
}

static void encode_vertex(const brio_write_job *job, size_t v, char *bytes) {
    const double *p = job->mesh->vertices + 3 * v;
    float rounded[3] = {(float)p[0], (float)p[1], (float)p[2]};
    size_t size = job->options->float32 ? sizeof rounded : 3 * sizeof *p;
    memcpy(bytes, job->options->float32 ? (const void *)rounded : p, size);
    for (size_t i = 0; i < job->mesh->num_properties; i++) {
        const brio_property *property = &job->mesh->properties[i];
        bytes += size;
        size = brio_scalar_size(property->type);
        memcpy(bytes, (const char *)property->data + v * size, size);
    }
}

/* A chunk of encoded rows: vertices or faces from `first` on. */
typedef struct {
    const brio_write_job *job;
    size_t first;
    char *bytes;
    size_t size; /* bytes of a vertex, or of the number before the corners of a face */
} rows;

static void encode_vertices(void *user, size_t begin, size_t end, int thread) {
    const rows *r = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) encode_vertex(r->job, r->first + i, r->bytes + i * r->size);
}

static brio_status write_binary_vertices(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    size_t size = vertex_size(job);
    char *bytes = NULL;
    if (!m->num_properties && !job->options->float32)
        return brio_output_bytes(out, m->vertices, 3 * m->num_vertices * sizeof *m->vertices);
    BRIO_TRY(BRIO_ALLOC(out->ctx, bytes, CHUNK * size));
    for (size_t begin = 0; begin < m->num_vertices; begin += CHUNK) {
        size_t count = m->num_vertices - begin < CHUNK ? m->num_vertices - begin : CHUNK;
        brio_for(out->ctx, brio_threads(out->ctx, count, ROWS_A_THREAD), count, encode_vertices,
                 &(rows){job, begin, bytes, size});
        BRIO_TRY(brio_output_bytes(out, bytes, count * size));
    }
done:
    brio_release(out->ctx, bytes);
    return status;
}

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
    for (size_t i = begin; i < end; i++)
        encode_list(m->face_vertices + offsets[i], (size_t)(offsets[i + 1] - offsets[i]), r->size == sizeof(uint32_t),
                    r->bytes + i * r->size + (size_t)(offsets[i] - offsets[0]) * sizeof(uint32_t));
}

static brio_status write_binary_faces(brio_output *out, const brio_write_job *job, bool long_lists) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    size_t head = long_lists ? sizeof(uint32_t) : sizeof(uint8_t), capacity = 0;
    char *bytes = NULL;
    for (size_t begin = 0; begin < m->num_faces; begin += CHUNK) {
        size_t count = m->num_faces - begin < CHUNK ? m->num_faces - begin : CHUNK;
        const uint64_t *offsets = m->face_offsets + begin;
        size_t size = count * head + (size_t)(offsets[count] - offsets[0]) * sizeof(uint32_t);
        BRIO_TRY(BRIO_RESERVE(out->ctx, bytes, capacity, size));
        brio_for(out->ctx, brio_threads(out->ctx, count, ROWS_A_THREAD), count, encode_faces,
                 &(rows){job, begin, bytes, head});
        BRIO_TRY(brio_output_bytes(out, bytes, size));
    }
done:
    brio_release(out->ctx, bytes);
    return status;
}

static brio_status write_binary(brio_output *out, const brio_write_job *job, bool long_lists) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    BRIO_TRY(write_binary_vertices(out, job));
    BRIO_TRY(write_binary_faces(out, job, long_lists));
    for (size_t t = 0; t < m->num_tetrahedra; t++) {
        char bytes[1 + 4 * sizeof(uint32_t)];
        encode_list(m->tetrahedra + 4 * t, 4, false, bytes);
        BRIO_TRY(brio_output_bytes(out, bytes, sizeof bytes));
    }
    if (m->num_edges) BRIO_TRY(brio_output_bytes(out, m->edges, 2 * m->num_edges * sizeof *m->edges));
done:
    return status;
}

/* --- text --- */

static brio_status write_text_vertex(brio_output *out, const brio_write_job *job, size_t v) {
    brio_status status = BRIO_OK;
    const double *p = job->mesh->vertices + 3 * v;
    double rounded[3] = {p[0], p[1], p[2]};
    if (job->options->float32)
        for (int k = 0; k < 3; k++) rounded[k] = (double)(float)p[k];
    BRIO_TRY(brio_output_point(out, rounded));
    for (size_t i = 0; i < job->mesh->num_properties; i++)
        BRIO_TRY(brio_output_scalar(out, ' ', &job->mesh->properties[i], v));
    BRIO_TRY(brio_output_string(out, "\n"));
done:
    return status;
}

static brio_status write_text_list(brio_output *out, const uint32_t *items, size_t count) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_output_integer(out, 0, (int64_t)count));
    for (size_t i = 0; i < count; i++) BRIO_TRY(brio_output_integer(out, ' ', items[i]));
    BRIO_TRY(brio_output_string(out, "\n"));
done:
    return status;
}

static brio_status write_text_edge(brio_output *out, const uint32_t *edge) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_output_integer(out, 0, edge[0]));
    BRIO_TRY(brio_output_integer(out, ' ', edge[1]));
    BRIO_TRY(brio_output_string(out, "\n"));
done:
    return status;
}

static brio_status write_text(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    for (size_t v = 0; v < m->num_vertices; v++) BRIO_TRY(write_text_vertex(out, job, v));
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t from = m->face_offsets[f], to = m->face_offsets[f + 1];
        BRIO_TRY(write_text_list(out, m->face_vertices + from, (size_t)(to - from)));
    }
    for (size_t t = 0; t < m->num_tetrahedra; t++) BRIO_TRY(write_text_list(out, m->tetrahedra + 4 * t, 4));
    for (size_t e = 0; e < m->num_edges; e++) BRIO_TRY(write_text_edge(out, m->edges + 2 * e));
done:
    return status;
}

/* --- file --- */

brio_status brio_ply_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    size_t corners = most_corners(m);
    bool long_lists = corners > UINT8_MAX;
    BRIO_REQUIRE(out->ctx, corners <= INT32_MAX, BRIO_ERR_ARGUMENT, "%s: a face of %zu corners does not fit a PLY file",
                 out->name, corners);
    BRIO_TRY(write_header(out, job, long_lists));
    BRIO_TRY(job->options->ascii ? write_text(out, job) : write_binary(out, job, long_lists));
done:
    return status;
}
