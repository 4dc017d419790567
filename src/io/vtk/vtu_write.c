/* Writes VTU, VTK's XML file of an unstructured grid: tetrahedra, polygons and edges. Without any of them, writes one
 * vertex cell for each point.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk_writer.h"

enum { VTK_VERTEX = 1, VTK_LINE = 3, VTK_POLYGON = 7, VTK_TETRAHEDRON = 10 };

typedef struct {
    brio_vtk_writer xml;
    const brio_mesh *mesh;
    size_t num_corners, num_cells; /* of all cells: tetrahedra, then faces, then edges */
    size_t face_corners;
    bool vertices; /* whether the cells are the points */
} vtu_writer;

static uint32_t corner(const vtu_writer *w, uint64_t i) {
    const brio_mesh *m = w->mesh;
    uint64_t of_tetrahedra = 4 * (uint64_t)m->num_tetrahedra;
    if (w->vertices) return (uint32_t)i;
    if (i < of_tetrahedra) return m->tetrahedra[i];
    if (i < of_tetrahedra + w->face_corners) return m->face_vertices[i - of_tetrahedra];
    return m->edges[i - of_tetrahedra - w->face_corners];
}

static void fill_connectivity(void *user, uint64_t first, size_t count, void *to) {
    const vtu_writer *w = user;
    for (size_t i = 0; i < count; i++) brio_vtk_store_index(&w->xml, to, i, corner(w, first + i));
}

/* Returns the index behind the last corner of a cell. */
static uint64_t end_of_cell(const vtu_writer *w, size_t c) {
    const brio_mesh *m = w->mesh;
    size_t t = m->num_tetrahedra, f = m->num_faces;
    if (w->vertices) return c + 1;
    if (c < t) return 4 * (c + 1);
    if (c < t + f) return 4 * t + m->face_offsets[c - t + 1];
    return 4 * t + w->face_corners + 2 * (c - t - f + 1);
}

static void fill_offsets(void *user, uint64_t first, size_t count, void *to) {
    for (size_t i = 0; i < count; i++) ((uint64_t *)to)[i] = end_of_cell(user, (size_t)first + i);
}

static void fill_types(void *user, uint64_t first, size_t count, void *to) {
    const vtu_writer *w = user;
    size_t t = w->mesh->num_tetrahedra, f = w->mesh->num_faces;
    for (size_t i = 0; i < count; i++) {
        size_t c = (size_t)first + i;
        ((uint8_t *)to)[i] = w->vertices ? VTK_VERTEX : c < t ? VTK_TETRAHEDRON : c < t + f ? VTK_POLYGON : VTK_LINE;
    }
}

static brio_status write_cells(vtu_writer *w) {
    brio_status status = BRIO_OK;
    brio_vtk_writer *xml = &w->xml;
    BRIO_TRY(brio_output_string(xml->out, "<Cells>\n"));
    BRIO_TRY(brio_vtk_write_array(
        xml, &(brio_vtk_source){"connectivity", brio_vtk_index_type(xml), 1, w->num_corners, fill_connectivity, w}));
    BRIO_TRY(
        brio_vtk_write_array(xml, &(brio_vtk_source){"offsets", BRIO_VTK_INT64, 1, w->num_cells, fill_offsets, w}));
    BRIO_TRY(brio_vtk_write_array(xml, &(brio_vtk_source){"types", BRIO_SCALAR_UINT8, 1, w->num_cells, fill_types, w}));
    BRIO_TRY(brio_output_string(xml->out, "</Cells>\n"));
done:
    return status;
}

brio_status brio_vtu_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    vtu_writer w = {.xml = brio_vtk_writer_new(out, job, "UnstructuredGrid"), .mesh = m};
    w.vertices = !m->num_faces && !m->num_tetrahedra && !m->num_edges;
    w.face_corners = m->num_faces ? (size_t)m->face_offsets[m->num_faces] : 0;
    w.num_cells = w.vertices ? m->num_vertices : m->num_faces + m->num_tetrahedra + m->num_edges;
    w.num_corners = w.vertices ? m->num_vertices : 4 * m->num_tetrahedra + w.face_corners + 2 * m->num_edges;
    BRIO_TRY(brio_vtk_begin(&w.xml));
    BRIO_TRY(brio_output_format(out, "<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n", m->num_vertices,
                                w.num_cells));
    BRIO_TRY(brio_vtk_write_points(&w.xml));
    BRIO_TRY(write_cells(&w));
    BRIO_TRY(brio_vtk_write_cell_data(&w.xml, m->num_tetrahedra, m->num_edges));
    BRIO_TRY(brio_vtk_end(&w.xml));
done:
    brio_vtk_writer_free(&w.xml);
    return status;
}
