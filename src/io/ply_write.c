/* Writes PLY files: binary in this machine's byte order, or text. */
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

static brio_status write_binary_vertex(brio_output *out, const brio_write_job *job, size_t v) {
    brio_status status = BRIO_OK;
    const double *p = job->mesh->vertices + 3 * v;
    if (job->options->float32) {
        float rounded[3] = {(float)p[0], (float)p[1], (float)p[2]};
        BRIO_TRY(brio_output_bytes(out, rounded, sizeof rounded));
    } else {
        BRIO_TRY(brio_output_bytes(out, p, 3 * sizeof *p));
    }
    for (size_t i = 0; i < job->mesh->num_properties; i++) {
        const brio_property *property = &job->mesh->properties[i];
        size_t size = brio_scalar_size(property->type);
        BRIO_TRY(brio_output_bytes(out, (const char *)property->data + v * size, size));
    }
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

static brio_status write_list(brio_output *out, const brio_write_job *job, const uint32_t *items, size_t count,
                              bool long_list) {
    brio_status status = BRIO_OK;
    if (job->options->ascii) return write_text_list(out, items, count);
    uint32_t wide = (uint32_t)count;
    uint8_t narrow = (uint8_t)count;
    BRIO_TRY(long_list ? brio_output_bytes(out, &wide, sizeof wide) : brio_output_bytes(out, &narrow, sizeof narrow));
    BRIO_TRY(brio_output_bytes(out, items, count * sizeof *items));
done:
    return status;
}

static brio_status write_edge(brio_output *out, const brio_write_job *job, const uint32_t *edge) {
    brio_status status = BRIO_OK;
    if (!job->options->ascii) return brio_output_bytes(out, edge, 2 * sizeof *edge);
    BRIO_TRY(brio_output_integer(out, 0, edge[0]));
    BRIO_TRY(brio_output_integer(out, ' ', edge[1]));
    BRIO_TRY(brio_output_string(out, "\n"));
done:
    return status;
}

brio_status brio_ply_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    size_t corners = most_corners(m);
    bool long_lists = corners > UINT8_MAX;
    BRIO_REQUIRE(out->ctx, corners <= INT32_MAX, BRIO_ERR_ARGUMENT, "%s: a face of %zu corners does not fit a PLY file",
                 out->name, corners);
    BRIO_TRY(write_header(out, job, long_lists));
    for (size_t v = 0; v < m->num_vertices; v++)
        BRIO_TRY(job->options->ascii ? write_text_vertex(out, job, v) : write_binary_vertex(out, job, v));
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t from = m->face_offsets[f], to = m->face_offsets[f + 1];
        BRIO_TRY(write_list(out, job, m->face_vertices + from, (size_t)(to - from), long_lists));
    }
    for (size_t t = 0; t < m->num_tetrahedra; t++) BRIO_TRY(write_list(out, job, m->tetrahedra + 4 * t, 4, false));
    for (size_t e = 0; e < m->num_edges; e++) BRIO_TRY(write_edge(out, job, m->edges + 2 * e));
done:
    return status;
}
