/* Writes VTU, VTK's XML file of an unstructured grid: tetrahedra, polygons and edges. Without any of them, writes one
 * vertex cell for each point.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk_xml.h"

enum { VTK_VERTEX = 1, VTK_LINE = 3, VTK_POLYGON = 7, VTK_TETRAHEDRON = 10 };

typedef struct {
    brio_vtk_writer xml;
    const brio_mesh *mesh;
    size_t num_corners, num_cells; /* of all cells: tetrahedra, then faces, then edges */
    bool vertices;                 /* whether the cells are the points */
} vtu_writer;

static brio_status write_xml(vtu_writer *w) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_vtk_begin(&w->xml));
    BRIO_TRY(brio_output_format(w->xml.out, "<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n",
                                w->mesh->num_vertices, w->num_cells));
    BRIO_TRY(brio_vtk_declare_points(&w->xml));
    BRIO_TRY(brio_output_string(w->xml.out, "<Cells>\n"));
    BRIO_TRY(brio_vtk_declare_cells(&w->xml, w->num_cells, w->num_corners));
    BRIO_TRY(brio_vtk_declare(&w->xml, "UInt8", "types", 1, w->num_cells));
    BRIO_TRY(brio_output_string(w->xml.out, "</Cells>\n"));
    BRIO_TRY(brio_vtk_begin_data(&w->xml));
done:
    return status;
}

static brio_status write_connectivity(vtu_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->mesh;
    BRIO_TRY(brio_vtk_write_size(&w->xml, w->num_corners * brio_vtk_index_size(&w->xml)));
    BRIO_TRY(brio_vtk_write_indices(&w->xml, m->tetrahedra, 4 * m->num_tetrahedra));
    if (m->num_faces)
        BRIO_TRY(brio_vtk_write_indices(&w->xml, m->face_vertices, (size_t)m->face_offsets[m->num_faces]));
    BRIO_TRY(brio_vtk_write_indices(&w->xml, m->edges, 2 * m->num_edges));
    for (size_t v = 0; w->vertices && v < m->num_vertices; v++) {
        uint32_t index = (uint32_t)v;
        BRIO_TRY(brio_vtk_write_indices(&w->xml, &index, 1));
    }
done:
    return status;
}

/* Returns the index behind the last corner of a cell. */
static uint64_t end_of_cell(const vtu_writer *w, size_t c) {
    const brio_mesh *m = w->mesh;
    size_t t = m->num_tetrahedra, f = m->num_faces;
    if (w->vertices) return c + 1;
    if (c < t) return 4 * (c + 1);
    if (c < t + f) return 4 * t + m->face_offsets[c - t + 1];
    return 4 * t + (f ? m->face_offsets[f] : 0) + 2 * (c - t - f + 1);
}

static brio_status write_offsets(vtu_writer *w) {
    brio_status status = brio_vtk_write_size(&w->xml, w->num_cells * sizeof(int64_t));
    for (size_t c = 0; c < w->num_cells && status == BRIO_OK; c++) {
        uint64_t offset = end_of_cell(w, c);
        status = brio_output_bytes(w->xml.out, &offset, sizeof offset);
    }
    return status;
}

static uint8_t type_of_cell(const vtu_writer *w, size_t c) {
    size_t t = w->mesh->num_tetrahedra;
    return w->vertices ? VTK_VERTEX : c < t ? VTK_TETRAHEDRON : c < t + w->mesh->num_faces ? VTK_POLYGON : VTK_LINE;
}

static brio_status write_types(vtu_writer *w) {
    brio_status status = brio_vtk_write_size(&w->xml, w->num_cells);
    for (size_t c = 0; c < w->num_cells && status == BRIO_OK; c++) {
        uint8_t type = type_of_cell(w, c);
        status = brio_output_bytes(w->xml.out, &type, 1);
    }
    return status;
}

brio_status brio_vtu_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    vtu_writer w = {.xml = brio_vtk_writer_new(out, job, "UnstructuredGrid"), .mesh = m};
    w.vertices = !m->num_faces && !m->num_tetrahedra && !m->num_edges;
    w.num_cells = w.vertices ? m->num_vertices : m->num_faces + m->num_tetrahedra + m->num_edges;
    w.num_corners = w.vertices ? m->num_vertices : 4 * m->num_tetrahedra + 2 * m->num_edges;
    if (m->num_faces) w.num_corners += (size_t)m->face_offsets[m->num_faces];
    BRIO_TRY(write_xml(&w));
    BRIO_TRY(brio_vtk_write_points(&w.xml));
    BRIO_TRY(write_connectivity(&w));
    BRIO_TRY(write_offsets(&w));
    BRIO_TRY(write_types(&w));
    BRIO_TRY(brio_vtk_end(&w.xml));
done:
    return status;
}
