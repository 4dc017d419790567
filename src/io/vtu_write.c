/* Writes VTU, VTK's XML file of an unstructured grid, with all arrays appended raw behind the XML: tetrahedra and
 * polygons, or one vertex cell for each point when there is neither.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/formats.h"
#include "io/scalar.h"
#include <stdio.h>
#include <string.h>

enum { VTK_VERTEX = 1, VTK_POLYGON = 7, VTK_TETRAHEDRON = 10 };

typedef struct {
    brio_output *out;
    const brio_write_job *job;
    size_t num_corners, num_cells; /* of all cells */
    bool wide;                     /* indices do not fit Int32 */
    bool vertices;                 /* cells are the points */
    uint64_t offset;               /* of the next array among the appended data */
} vtu_writer;

static const char *type_name(brio_scalar type) {
    static const char *const names[BRIO_SCALAR_END] = {"Int8",  "UInt8",  "Int16",   "UInt16",
                                                       "Int32", "UInt32", "Float32", "Float64"};
    return names[type];
}

/* --- the XML --- */

static brio_status write_escaped(brio_output *out, const char *text) {
    brio_status status = BRIO_OK;
    for (; *text; text++) {
        const char *escape = *text == '&'   ? "&amp;"
                             : *text == '<' ? "&lt;"
                             : *text == '>' ? "&gt;"
                             : *text == '"' ? "&quot;"
                                            : NULL;
        char control = (unsigned char)*text < ' ' ? ' ' : *text; /* XML has no way to write it */
        BRIO_TRY(escape ? brio_output_string(out, escape) : brio_output_bytes(out, &control, 1));
    }
done:
    return status;
}

/* Two hyphens end a comment of XML too early. */
static brio_status write_comment(brio_output *out, const char *comment) {
    brio_status status = BRIO_OK;
    if (!comment || !*comment) return BRIO_OK;
    BRIO_TRY(brio_output_string(out, "<!-- "));
    for (char last = 0; *comment; last = *comment++) {
        char plain = *comment == '-' && last == '-' ? ' ' : *comment;
        BRIO_TRY(brio_output_bytes(out, &plain, 1));
    }
    BRIO_TRY(brio_output_string(out, " -->\n"));
done:
    return status;
}

static brio_status declare(vtu_writer *w, const char *type, const char *name, int components, uint64_t bytes) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_output_format(w->out, "<DataArray type=\"%s\" Name=\"", type));
    BRIO_TRY(write_escaped(w->out, name));
    BRIO_TRY(brio_output_format(w->out, "\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%llu\"/>\n",
                                components, (unsigned long long)w->offset));
    w->offset += sizeof(uint64_t) + bytes;
done:
    return status;
}

static size_t point_size(const vtu_writer *w) {
    return 3 * (w->job->options->float32 ? sizeof(float) : sizeof(double));
}
static size_t index_size(const vtu_writer *w) {
    return w->wide ? sizeof(int64_t) : sizeof(int32_t);
}

static brio_status write_xml(vtu_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->job->mesh;
    brio_output *out = w->out;
    BRIO_TRY(brio_output_format(out,
                                "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                                "byte_order=\"%s\" header_type=\"UInt64\">\n",
                                brio_host_is_little() ? "LittleEndian" : "BigEndian"));
    BRIO_TRY(write_comment(out, w->job->options->comment));
    BRIO_TRY(brio_output_format(out,
                                "<UnstructuredGrid>\n<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n<Points>\n",
                                m->num_vertices, w->num_cells));
    BRIO_TRY(
        declare(w, w->job->options->float32 ? "Float32" : "Float64", "Points", 3, m->num_vertices * point_size(w)));
    BRIO_TRY(brio_output_string(out, "</Points>\n<PointData>\n"));
    for (size_t i = 0; i < m->num_properties; i++) {
        const brio_property *p = &m->properties[i];
        BRIO_TRY(declare(w, type_name(p->type), p->name, 1, m->num_vertices * brio_scalar_size(p->type)));
    }
    BRIO_TRY(brio_output_string(out, "</PointData>\n<Cells>\n"));
    BRIO_TRY(declare(w, w->wide ? "Int64" : "Int32", "connectivity", 1, w->num_corners * index_size(w)));
    BRIO_TRY(declare(w, "Int64", "offsets", 1, w->num_cells * sizeof(int64_t)));
    BRIO_TRY(declare(w, "UInt8", "types", 1, w->num_cells));
    BRIO_TRY(brio_output_string(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_"));
done:
    return status;
}

/* --- the arrays --- */

static brio_status write_size(vtu_writer *w, uint64_t bytes) {
    return brio_output_bytes(w->out, &bytes, sizeof bytes);
}

static brio_status write_points(vtu_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->job->mesh;
    BRIO_TRY(write_size(w, m->num_vertices * point_size(w)));
    if (!w->job->options->float32) return brio_output_bytes(w->out, m->vertices, m->num_vertices * point_size(w));
    for (size_t i = 0; i < 3 * m->num_vertices; i++) {
        float rounded = (float)m->vertices[i];
        BRIO_TRY(brio_output_bytes(w->out, &rounded, sizeof rounded));
    }
done:
    return status;
}

static brio_status write_properties(vtu_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->job->mesh;
    for (size_t i = 0; i < m->num_properties; i++) {
        size_t bytes = m->num_vertices * brio_scalar_size(m->properties[i].type);
        BRIO_TRY(write_size(w, bytes));
        BRIO_TRY(brio_output_bytes(w->out, m->properties[i].data, bytes));
    }
done:
    return status;
}

static brio_status write_indices(vtu_writer *w, const uint32_t *indices, size_t count) {
    brio_status status = BRIO_OK;
    if (!w->wide) return brio_output_bytes(w->out, indices, count * sizeof *indices);
    for (size_t i = 0; i < count; i++) {
        int64_t index = indices[i];
        BRIO_TRY(brio_output_bytes(w->out, &index, sizeof index));
    }
done:
    return status;
}

static brio_status write_connectivity(vtu_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->job->mesh;
    BRIO_TRY(write_size(w, w->num_corners * index_size(w)));
    BRIO_TRY(write_indices(w, m->tetrahedra, 4 * m->num_tetrahedra));
    if (m->num_faces) BRIO_TRY(write_indices(w, m->face_vertices, (size_t)m->face_offsets[m->num_faces]));
    for (size_t v = 0; w->vertices && v < m->num_vertices; v++) {
        uint32_t index = (uint32_t)v;
        BRIO_TRY(write_indices(w, &index, 1));
    }
done:
    return status;
}

static brio_status write_offsets(vtu_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->job->mesh;
    BRIO_TRY(write_size(w, w->num_cells * sizeof(int64_t)));
    for (size_t c = 0; c < w->num_cells; c++) {
        size_t t = m->num_tetrahedra;
        uint64_t offset = w->vertices ? c + 1 : c < t ? 4 * (c + 1) : 4 * t + m->face_offsets[c - t + 1];
        BRIO_TRY(brio_output_bytes(w->out, &offset, sizeof offset));
    }
done:
    return status;
}

static brio_status write_types(vtu_writer *w) {
    brio_status status = BRIO_OK;
    BRIO_TRY(write_size(w, w->num_cells));
    for (size_t c = 0; c < w->num_cells; c++) {
        uint8_t type = w->vertices ? VTK_VERTEX : c < w->job->mesh->num_tetrahedra ? VTK_TETRAHEDRON : VTK_POLYGON;
        BRIO_TRY(brio_output_bytes(w->out, &type, 1));
    }
done:
    return status;
}

brio_status brio_vtu_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    vtu_writer w = {.out = out, .job = job, .wide = m->num_vertices > INT32_MAX};
    w.vertices = !m->num_faces && !m->num_tetrahedra;
    w.num_cells = w.vertices ? m->num_vertices : m->num_faces + m->num_tetrahedra;
    w.num_corners = w.vertices ? m->num_vertices : 4 * m->num_tetrahedra;
    if (m->num_faces) w.num_corners += (size_t)m->face_offsets[m->num_faces];
    BRIO_TRY(write_xml(&w));
    BRIO_TRY(write_points(&w));
    BRIO_TRY(write_properties(&w));
    BRIO_TRY(write_connectivity(&w));
    BRIO_TRY(write_offsets(&w));
    BRIO_TRY(write_types(&w));
    BRIO_TRY(brio_output_string(out, "\n</AppendedData>\n</VTKFile>\n"));
done:
    return status;
}
