/* Writes VTK's legacy file of an unstructured grid, binary or as text, of version 3.0, which all programs of VTK read:
 * points, tetrahedra, polygons and edges as cells (without any of them a vertex cell for each point), and properties as
 * a field; cells that are no faces have 0.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/formats.h"
#include "io/scalar.h"
#include "mesh/properties.h"
#include <inttypes.h>
#include <string.h>

/* Types of cells. */
enum { VERTEX = 1, LINE = 3, TRIANGLE = 5, POLYGON = 7, QUAD = 9, TETRAHEDRON = 10 };

typedef struct {
    brio_output *out;
    const brio_mesh *mesh;
    bool text, single;
    uint64_t num_verts, num_cells;
} legacy_writer;

/* --- numbers --- */

/* Writes scalar i of an array.   before  what stands before it in a text. */
static brio_status put(const legacy_writer *w, char before, const brio_property *array, size_t i) {
    char bytes[8];
    size_t size = brio_scalar_size(array->type);
    if (w->text) return brio_output_scalar(w->out, before, array, i);
    brio_scalar_gather(bytes, (const char *)array->data + i * size, 1, size, size, brio_host_is_little());
    return brio_output_bytes(w->out, bytes, size);
}

static brio_status put_integer(const legacy_writer *w, char before, uint64_t number) {
    int32_t value = (int32_t)number;
    return put(w, before, &(brio_property){.type = BRIO_SCALAR_INT32, .data = &value}, 0);
}

/* --- cells --- */

static brio_status put_cell(const legacy_writer *w, const uint32_t *corners, uint64_t count) {
    BRIO_FORWARD(put_integer(w, 0, count));
    for (uint64_t i = 0; i < count; i++) BRIO_FORWARD(put_integer(w, ' ', corners[i]));
    if (w->text) BRIO_FORWARD(brio_output_string(w->out, "\n"));
    return BRIO_OK;
}

static brio_status put_cells(const legacy_writer *w) {
    const brio_mesh *m = w->mesh;
    for (size_t t = 0; t < m->num_tetrahedra; t++) BRIO_FORWARD(put_cell(w, m->tetrahedra + 4 * t, 4));
    for (size_t f = 0; f < m->num_faces; f++)
        BRIO_FORWARD(put_cell(w, m->face_vertices + m->face_offsets[f], m->face_offsets[f + 1] - m->face_offsets[f]));
    for (size_t e = 0; e < m->num_edges; e++) BRIO_FORWARD(put_cell(w, m->edges + 2 * e, 2));
    for (uint32_t v = 0; v < w->num_verts; v++) BRIO_FORWARD(put_cell(w, &v, 1));
    return BRIO_OK;
}

static brio_status put_types(const legacy_writer *w) {
    const brio_mesh *m = w->mesh;
    const char *end = w->text ? "\n" : "";
    for (uint64_t i = 0; i < w->num_cells; i++) {
        uint64_t f = i - m->num_tetrahedra;
        int type = i < m->num_tetrahedra ? TETRAHEDRON : w->num_verts ? VERTEX : LINE;
        if (i >= m->num_tetrahedra && f < m->num_faces) {
            uint64_t corners = m->face_offsets[f + 1] - m->face_offsets[f];
            type = corners == 3 ? TRIANGLE : corners == 4 ? QUAD : POLYGON;
        }
        BRIO_FORWARD(put_integer(w, 0, (uint64_t)type));
        BRIO_FORWARD(brio_output_string(w->out, end));
    }
    return BRIO_OK;
}

/* --- properties --- */

/* Writes the line of an array. In a name %20 stands for a blank. */
static brio_status put_array_line(const legacy_writer *w, const char *name, int components, uint64_t rows,
                                  brio_scalar type) {
    static const char *const types[] = {[BRIO_SCALAR_INT8] = "char",     [BRIO_SCALAR_UINT8] = "unsigned_char",
                                        [BRIO_SCALAR_INT16] = "short",   [BRIO_SCALAR_UINT16] = "unsigned_short",
                                        [BRIO_SCALAR_INT32] = "int",     [BRIO_SCALAR_UINT32] = "unsigned_int",
                                        [BRIO_SCALAR_FLOAT32] = "float", [BRIO_SCALAR_FLOAT64] = "double"};
    for (; *name; name++) {
        unsigned char c = (unsigned char)*name;
        if (c <= ' ' || c == '%' || c == '"' || c > 126)
            BRIO_FORWARD(brio_output_format(w->out, "%%%02X", c));
        else
            BRIO_FORWARD(brio_output_bytes(w->out, name, 1));
    }
    return brio_output_format(w->out, " %d %" PRIu64 " %s\n", components, rows, types[type]);
}

/* The properties of points or of faces, given as those of points, and the rows of 0 round them. */
typedef struct {
    const brio_mesh *of;
    uint64_t before, behind;
} owner;

static brio_status put_row(const legacy_writer *w, const brio_property *const *of, int count, const uint64_t *row) {
    static const char zero[8];
    const brio_property none = {.type = of[0]->type, .data = (void *)(uintptr_t)zero};
    for (int k = 0; k < count; k++) BRIO_FORWARD(put(w, k ? ' ' : 0, row ? of[k] : &none, row ? (size_t)*row : 0));
    if (w->text) BRIO_FORWARD(brio_output_string(w->out, "\n"));
    return BRIO_OK;
}

/* Writes properties as one array.   name  NULL: that of the property. */
static brio_status put_array(const legacy_writer *w, const owner *o, const char *name, const brio_property *const *of,
                             int count) {
    uint64_t rows = o->of->num_vertices;
    BRIO_FORWARD(put_array_line(w, name ? name : of[0]->name, count, o->before + rows + o->behind, of[0]->type));
    for (uint64_t i = 0; i < o->before; i++) BRIO_FORWARD(put_row(w, of, count, NULL));
    for (uint64_t i = 0; i < rows; i++) BRIO_FORWARD(put_row(w, of, count, &i));
    for (uint64_t i = 0; i < o->behind; i++) BRIO_FORWARD(put_row(w, of, count, NULL));
    return brio_output_string(w->out, "\n");
}

/* Writes properties under a title. Colours of bytes and normals are one array each, unless its name is taken. */
static brio_status put_properties(const legacy_writer *w, const char *title, const owner *o) {
    const brio_mesh *m = o->of;
    brio_channels colour = brio_colour_of(m), normal = brio_normal_of(m);
    const char *name = colour.count == 4 ? "RGBA" : "RGB";
    if (colour.count && (colour.of[0]->type != BRIO_SCALAR_UINT8 || brio_mesh_property(m, name))) colour.count = 0;
    if (brio_mesh_property(m, "Normals")) normal.count = 0;
    size_t arrays =
        m->num_properties + 2 - (size_t)(colour.count ? colour.count : 1) - (size_t)(normal.count ? normal.count : 1);
    if (!m->num_properties) return BRIO_OK;
    BRIO_FORWARD(brio_output_format(w->out, "%s %" PRIu64 "\nFIELD FieldData %zu\n", title,
                                    o->before + m->num_vertices + o->behind, arrays));
    for (size_t i = 0; i < m->num_properties; i++) {
        const brio_property *p = &m->properties[i];
        if (colour.count && p == colour.of[0])
            BRIO_FORWARD(put_array(w, o, name, colour.of, colour.count));
        else if (normal.count && p == normal.of[0])
            BRIO_FORWARD(put_array(w, o, "Normals", normal.of, normal.count));
        else if (!brio_channels_have(&colour, p) && !brio_channels_have(&normal, p))
            BRIO_FORWARD(put_array(w, o, NULL, &p, 1));
    }
    return BRIO_OK;
}

/* --- the file --- */

static brio_status put_points(const legacy_writer *w) {
    const brio_mesh *m = w->mesh;
    BRIO_FORWARD(brio_output_format(w->out, "POINTS %zu %s\n", m->num_vertices, w->single ? "float" : "double"));
    for (size_t i = 0; i < 3 * m->num_vertices; i++) {
        float single = w->single ? (float)m->vertices[i] : 0;
        double wide = m->vertices[i];
        brio_property number = {.type = w->single ? BRIO_SCALAR_FLOAT32 : BRIO_SCALAR_FLOAT64,
                                .data = w->single ? (void *)&single : (void *)&wide};
        BRIO_FORWARD(put(w, i % 3 ? ' ' : i ? '\n' : 0, &number, 0));
    }
    return brio_output_string(w->out, "\n");
}

/* Writes the header. The title is one line of at most 255 characters. */
static brio_status put_header(const legacy_writer *w, const char *comment) {
    size_t length = comment ? strcspn(comment, "\r\n") : 0;
    BRIO_FORWARD(brio_output_string(w->out, "# vtk DataFile Version 3.0\n"));
    BRIO_FORWARD(brio_output_bytes(w->out, length ? comment : "brio", length ? (length < 255 ? length : 255) : 4));
    return brio_output_format(w->out, "\n%s\nDATASET UNSTRUCTURED_GRID\n", w->text ? "ASCII" : "BINARY");
}

brio_status brio_vtk_legacy_write(brio_output *out, const brio_write_job *job) {
    const brio_mesh *m = job->mesh, faces = brio_mesh_faces_as_points(m);
    legacy_writer w = {.out = out, .mesh = m, .text = job->options->ascii, .single = job->options->float32};
    uint64_t corners = (m->num_faces ? m->face_offsets[m->num_faces] : 0) + 4 * (uint64_t)m->num_tetrahedra +
                       2 * (uint64_t)m->num_edges;
    w.num_verts = m->num_faces || m->num_edges || m->num_tetrahedra ? 0 : m->num_vertices;
    w.num_cells = m->num_faces + m->num_edges + m->num_tetrahedra + w.num_verts;
    uint64_t numbers = corners + w.num_verts + w.num_cells;
    BRIO_EXPECT(out->ctx, numbers <= INT32_MAX && m->num_vertices <= INT32_MAX, BRIO_ERR_ARGUMENT,
                "%s: cells of %" PRIu64 " numbers, a VTK file has at most %d: write .vtu", out->name, numbers,
                INT32_MAX);
    BRIO_FORWARD(put_header(&w, job->options->comment));
    BRIO_FORWARD(put_points(&w));
    BRIO_FORWARD(brio_output_format(out, "CELLS %" PRIu64 " %" PRIu64 "\n", w.num_cells, numbers));
    BRIO_FORWARD(put_cells(&w));
    BRIO_FORWARD(brio_output_format(out, "\nCELL_TYPES %" PRIu64 "\n", w.num_cells));
    BRIO_FORWARD(put_types(&w));
    BRIO_FORWARD(brio_output_string(out, "\n"));
    BRIO_FORWARD(put_properties(&w, "POINT_DATA", &(owner){m, 0, 0}));
    if (m->num_faces) BRIO_FORWARD(put_properties(&w, "CELL_DATA", &(owner){&faces, m->num_tetrahedra, m->num_edges}));
    return BRIO_OK;
}
