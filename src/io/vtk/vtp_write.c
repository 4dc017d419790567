/* Writes VTP, VTK's XML file of polygonal data: polygons, and edges as lines. Without either, writes one vertex cell
 * for each point. The rows of cell data are those of edges, then of polygons.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "io/vtk/vtk_writer.h"

typedef struct {
    brio_vtk_writer xml;
    const brio_mesh *mesh;
    size_t num_verts, num_corners; /* num_verts: cells that are points; num_corners: of the faces */
} vtp_writer;

static void fill_verts(void *user, uint64_t first, size_t count, void *to) {
    const vtp_writer *w = user;
    for (size_t i = 0; i < count; i++) brio_vtk_store_index(&w->xml, to, i, (uint32_t)(first + i));
}

static void fill_lines(void *user, uint64_t first, size_t count, void *to) {
    const vtp_writer *w = user;
    for (size_t i = 0; i < count; i++) brio_vtk_store_index(&w->xml, to, i, w->mesh->edges[first + i]);
}

static void fill_polys(void *user, uint64_t first, size_t count, void *to) {
    const vtp_writer *w = user;
    for (size_t i = 0; i < count; i++) brio_vtk_store_index(&w->xml, to, i, w->mesh->face_vertices[first + i]);
}

static void fill_verts_ends(void *user, uint64_t first, size_t count, void *to) {
    (void)user;
    for (size_t i = 0; i < count; i++) ((int64_t *)to)[i] = (int64_t)(first + i + 1);
}

static void fill_lines_ends(void *user, uint64_t first, size_t count, void *to) {
    (void)user;
    for (size_t i = 0; i < count; i++) ((int64_t *)to)[i] = (int64_t)(2 * (first + i + 1));
}

static void fill_polys_ends(void *user, uint64_t first, size_t count, void *to) {
    const vtp_writer *w = user;
    for (size_t i = 0; i < count; i++) ((int64_t *)to)[i] = (int64_t)w->mesh->face_offsets[first + i + 1];
}

/* A section: its cells and their corners, with what fills the two arrays. */
typedef struct {
    const char *name;
    size_t num_cells, num_corners;
    brio_vtk_fill corners, ends;
} section;

static brio_status write_section(vtp_writer *w, const section *s) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_output_format(w->xml.out, "<%s>\n", s->name));
    BRIO_TRY(brio_vtk_write_array(
        &w->xml, &(brio_vtk_source){"connectivity", brio_vtk_index_type(&w->xml), 1, s->num_corners, s->corners, w}));
    BRIO_TRY(brio_vtk_write_array(&w->xml, &(brio_vtk_source){"offsets", BRIO_VTK_INT64, 1, s->num_cells, s->ends, w}));
    BRIO_TRY(brio_output_format(w->xml.out, "</%s>\n", s->name));
done:
    return status;
}

brio_status brio_vtp_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    vtp_writer w = {.xml = brio_vtk_writer_new(out, job, "PolyData"), .mesh = m};
    w.num_verts = m->num_faces || m->num_edges ? 0 : m->num_vertices;
    w.num_corners = m->num_faces ? (size_t)m->face_offsets[m->num_faces] : 0;
    BRIO_TRY(brio_vtk_begin(&w.xml));
    BRIO_TRY(brio_output_format(out,
                                "<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"%zu\" "
                                "NumberOfStrips=\"0\" NumberOfPolys=\"%zu\">\n",
                                m->num_vertices, w.num_verts, m->num_edges, m->num_faces));
    BRIO_TRY(brio_vtk_write_points(&w.xml));
    BRIO_TRY(write_section(&w, &(section){"Verts", w.num_verts, w.num_verts, fill_verts, fill_verts_ends}));
    BRIO_TRY(write_section(&w, &(section){"Lines", m->num_edges, 2 * m->num_edges, fill_lines, fill_lines_ends}));
    BRIO_TRY(write_section(&w, &(section){"Polys", m->num_faces, w.num_corners, fill_polys, fill_polys_ends}));
    BRIO_TRY(brio_vtk_write_cell_data(&w.xml, m->num_edges, 0));
    BRIO_TRY(brio_vtk_end(&w.xml));
done:
    brio_vtk_writer_free(&w.xml);
    return status;
}
