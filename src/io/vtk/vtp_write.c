/* Writes VTP, VTK's XML file of polygonal data: polygons, and edges as lines. Without either, writes one vertex cell
 * for each point.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk_xml.h"

typedef struct {
    brio_vtk_writer xml;
    const brio_mesh *mesh;
    size_t num_verts, num_corners; /* num_verts: cells that are points; num_corners: of the faces */
} vtp_writer;

static brio_status declare_section(vtp_writer *w, const char *name, size_t num_cells, size_t num_corners) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_output_format(w->xml.out, "<%s>\n", name));
    BRIO_TRY(brio_vtk_declare_cells(&w->xml, num_cells, num_corners));
    BRIO_TRY(brio_output_format(w->xml.out, "</%s>\n", name));
done:
    return status;
}

static brio_status write_xml(vtp_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->mesh;
    BRIO_TRY(brio_vtk_begin(&w->xml));
    BRIO_TRY(brio_output_format(w->xml.out,
                                "<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"%zu\" "
                                "NumberOfStrips=\"0\" NumberOfPolys=\"%zu\">\n",
                                m->num_vertices, w->num_verts, m->num_edges, m->num_faces));
    BRIO_TRY(brio_vtk_declare_points(&w->xml));
    BRIO_TRY(declare_section(w, "Verts", w->num_verts, w->num_verts));
    BRIO_TRY(declare_section(w, "Lines", m->num_edges, 2 * m->num_edges));
    BRIO_TRY(declare_section(w, "Polys", m->num_faces, w->num_corners));
    BRIO_TRY(brio_vtk_begin_data(&w->xml));
done:
    return status;
}

static brio_status write_verts(vtp_writer *w) {
    brio_status status = brio_vtk_write_size(&w->xml, w->num_verts * brio_vtk_index_size(&w->xml));
    for (size_t v = 0; v < w->num_verts && status == BRIO_OK; v++) {
        uint32_t index = (uint32_t)v;
        status = brio_vtk_write_indices(&w->xml, &index, 1);
    }
    return status == BRIO_OK ? brio_vtk_write_even_offsets(&w->xml, w->num_verts, 1) : status;
}

static brio_status write_lines(vtp_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->mesh;
    BRIO_TRY(brio_vtk_write_size(&w->xml, 2 * m->num_edges * brio_vtk_index_size(&w->xml)));
    BRIO_TRY(brio_vtk_write_indices(&w->xml, m->edges, 2 * m->num_edges));
    BRIO_TRY(brio_vtk_write_even_offsets(&w->xml, m->num_edges, 2));
done:
    return status;
}

static brio_status write_polys(vtp_writer *w) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = w->mesh;
    BRIO_TRY(brio_vtk_write_size(&w->xml, w->num_corners * brio_vtk_index_size(&w->xml)));
    BRIO_TRY(brio_vtk_write_indices(&w->xml, m->face_vertices, w->num_corners));
    BRIO_TRY(brio_vtk_write_size(&w->xml, m->num_faces * sizeof(int64_t)));
    if (m->num_faces) BRIO_TRY(brio_output_bytes(w->xml.out, m->face_offsets + 1, m->num_faces * sizeof(int64_t)));
done:
    return status;
}

brio_status brio_vtp_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    vtp_writer w = {.xml = brio_vtk_writer_new(out, job, "PolyData"), .mesh = m};
    w.num_verts = m->num_faces || m->num_edges ? 0 : m->num_vertices;
    w.num_corners = m->num_faces ? (size_t)m->face_offsets[m->num_faces] : 0;
    BRIO_TRY(write_xml(&w));
    BRIO_TRY(brio_vtk_write_points(&w.xml));
    BRIO_TRY(write_verts(&w));
    BRIO_TRY(write_lines(&w));
    BRIO_TRY(write_polys(&w));
    BRIO_TRY(brio_vtk_end(&w.xml));
done:
    return status;
}
