/* What VTK's XML files have in common: the header, points with their properties, and arrays of raw bytes behind the
 * XML.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk_xml.h"
#include "io/scalar.h"

static const char *type_name(brio_scalar type) {
    static const char *const names[BRIO_SCALAR_END] = {"Int8",  "UInt8",  "Int16",   "UInt16",
                                                       "Int32", "UInt32", "Float32", "Float64"};
    return names[type];
}

brio_vtk_writer brio_vtk_writer_new(brio_output *out, const brio_write_job *job, const char *kind) {
    return (brio_vtk_writer){.out = out, .job = job, .kind = kind, .wide = job->mesh->num_vertices > INT32_MAX};
}

size_t brio_vtk_index_size(const brio_vtk_writer *w) {
    return w->wide ? sizeof(int64_t) : sizeof(int32_t);
}

static size_t point_size(const brio_vtk_writer *w) {
    return 3 * (w->job->options->float32 ? sizeof(float) : sizeof(double));
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
        char control = (unsigned char)*text < ' ' ? ' ' : *text; /* XML cannot represent control characters */
        BRIO_TRY(escape ? brio_output_string(out, escape) : brio_output_bytes(out, &control, 1));
    }
done:
    return status;
}

/* Writes a comment. Two hyphens would end an XML comment too early. */
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

brio_status brio_vtk_declare(brio_vtk_writer *w, const char *type, const char *name, int components, uint64_t bytes) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_output_format(w->out, "<DataArray type=\"%s\" Name=\"", type));
    BRIO_TRY(write_escaped(w->out, name));
    BRIO_TRY(brio_output_format(w->out, "\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%llu\"/>\n",
                                components, (unsigned long long)w->offset));
    w->offset += sizeof(uint64_t) + bytes;
done:
    return status;
}

brio_status brio_vtk_begin(brio_vtk_writer *w) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_output_format(w->out,
                                "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" "
                                "byte_order=\"%s\" header_type=\"UInt64\">\n",
                                w->kind, brio_host_is_little() ? "LittleEndian" : "BigEndian"));
    BRIO_TRY(write_comment(w->out, w->job->options->comment));
    BRIO_TRY(brio_output_format(w->out, "<%s>\n", w->kind));
done:
    return status;
}

brio_status brio_vtk_declare_points(brio_vtk_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->job->mesh;
    const char *type = w->job->options->float32 ? "Float32" : "Float64";
    BRIO_TRY(brio_output_string(w->out, "<Points>\n"));
    BRIO_TRY(brio_vtk_declare(w, type, "Points", 3, m->num_vertices * point_size(w)));
    BRIO_TRY(brio_output_string(w->out, "</Points>\n<PointData>\n"));
    for (size_t i = 0; i < m->num_properties; i++) {
        const brio_property *p = &m->properties[i];
        BRIO_TRY(brio_vtk_declare(w, type_name(p->type), p->name, 1, m->num_vertices * brio_scalar_size(p->type)));
    }
    BRIO_TRY(brio_output_string(w->out, "</PointData>\n"));
done:
    return status;
}

brio_status brio_vtk_declare_cells(brio_vtk_writer *w, size_t num_cells, size_t num_corners) {
    brio_status status = BRIO_OK;
    const char *index = w->wide ? "Int64" : "Int32";
    BRIO_TRY(brio_vtk_declare(w, index, "connectivity", 1, num_corners * brio_vtk_index_size(w)));
    BRIO_TRY(brio_vtk_declare(w, "Int64", "offsets", 1, num_cells * sizeof(int64_t)));
done:
    return status;
}

brio_status brio_vtk_begin_data(brio_vtk_writer *w) {
    return brio_output_format(w->out, "</Piece>\n</%s>\n<AppendedData encoding=\"raw\">\n_", w->kind);
}

/* --- the arrays --- */

brio_status brio_vtk_write_size(brio_vtk_writer *w, uint64_t bytes) {
    return brio_output_bytes(w->out, &bytes, sizeof bytes);
}

static brio_status write_coordinates(brio_vtk_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->job->mesh;
    BRIO_TRY(brio_vtk_write_size(w, m->num_vertices * point_size(w)));
    if (!w->job->options->float32) return brio_output_bytes(w->out, m->vertices, m->num_vertices * point_size(w));
    for (size_t i = 0; i < 3 * m->num_vertices; i++) {
        float rounded = (float)m->vertices[i];
        BRIO_TRY(brio_output_bytes(w->out, &rounded, sizeof rounded));
    }
done:
    return status;
}

static brio_status write_properties(brio_vtk_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->job->mesh;
    for (size_t i = 0; i < m->num_properties; i++) {
        size_t bytes = m->num_vertices * brio_scalar_size(m->properties[i].type);
        BRIO_TRY(brio_vtk_write_size(w, bytes));
        BRIO_TRY(brio_output_bytes(w->out, m->properties[i].data, bytes));
    }
done:
    return status;
}

brio_status brio_vtk_write_points(brio_vtk_writer *w) {
    brio_status status = write_coordinates(w);
    return status == BRIO_OK ? write_properties(w) : status;
}

brio_status brio_vtk_write_indices(brio_vtk_writer *w, const uint32_t *indices, size_t count) {
    brio_status status = BRIO_OK;
    if (!w->wide) return brio_output_bytes(w->out, indices, count * sizeof *indices);
    for (size_t i = 0; i < count; i++) {
        int64_t index = indices[i];
        BRIO_TRY(brio_output_bytes(w->out, &index, sizeof index));
    }
done:
    return status;
}

brio_status brio_vtk_write_even_offsets(brio_vtk_writer *w, size_t num_cells, size_t corners) {
    brio_status status = brio_vtk_write_size(w, num_cells * sizeof(int64_t));
    for (size_t c = 1; c <= num_cells && status == BRIO_OK; c++) {
        uint64_t offset = corners * c;
        status = brio_output_bytes(w->out, &offset, sizeof offset);
    }
    return status;
}

brio_status brio_vtk_end(brio_vtk_writer *w) {
    return brio_output_string(w->out, "\n</AppendedData>\n</VTKFile>\n");
}
