/* Writes VTK's XML files: meshes as unstructured grids or as polygons, and Voronoi cells. */
#include "base/memory.h"
#include "base/sort.h"
#include "io/formats.h"
#include "io/vtk/vtk_writer.h"
#include <math.h>
#include <string.h>

/* --- unstructured grids --- */

/* Writes VTU, VTK's XML file of an unstructured grid: tetrahedra, polygons and edges. Without any of them, writes one
 * vertex cell for each point.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */

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
    brio_vtk_writer *xml = &w->xml;
    BRIO_FORWARD(brio_output_string(xml->out, "<Cells>\n"));
    BRIO_FORWARD(brio_vtk_write_array(
        xml, &(brio_vtk_source){"connectivity", brio_vtk_index_type(xml), 1, w->num_corners, fill_connectivity, w}));
    BRIO_FORWARD(
        brio_vtk_write_array(xml, &(brio_vtk_source){"offsets", BRIO_VTK_INT64, 1, w->num_cells, fill_offsets, w}));
    BRIO_FORWARD(
        brio_vtk_write_array(xml, &(brio_vtk_source){"types", BRIO_SCALAR_UINT8, 1, w->num_cells, fill_types, w}));
    return brio_output_string(xml->out, "</Cells>\n");
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

/* --- polygons --- */

/* Writes VTP, VTK's XML file of polygonal data: polygons, and edges as lines. Without either, writes one vertex cell
 * for each point. The rows of cell data are those of edges, then of polygons. */

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
    BRIO_FORWARD(brio_output_format(w->xml.out, "<%s>\n", s->name));
    BRIO_FORWARD(brio_vtk_write_array(
        &w->xml, &(brio_vtk_source){"connectivity", brio_vtk_index_type(&w->xml), 1, s->num_corners, s->corners, w}));
    BRIO_FORWARD(
        brio_vtk_write_array(&w->xml, &(brio_vtk_source){"offsets", BRIO_VTK_INT64, 1, s->num_cells, s->ends, w}));
    return brio_output_format(w->xml.out, "</%s>\n", s->name);
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

/* --- cells --- */

/* Writes cells as polyhedra in VTU, VTK's XML file of an unstructured grid. Cells that are unbounded, that have no
 * faces, or a vertex that doubles cannot hold, are left out, and so are such vertices. */

enum { VTK_POLYHEDRON = 42 };

typedef struct {
    brio_vtk_writer xml;
    const brio_cells *cells;
    size_t num_polyhedra;
    uint32_t *vertex;    /* the distinct vertices of each polyhedron, ascending */
    size_t num_vertices; /* of all polyhedra */
    uint32_t *number;    /* of each vertex in the file; NULL if all are finite, and keep their numbers */
    double *finite;      /* then, the finite vertices */
    size_t num_finite;
    uint64_t *end;        /* of each polyhedron: behind its last vertex */
    uint32_t *polyhedron; /* the cell of each polyhedron */
    uint64_t num_numbers; /* of the array `faces` */
    /* the place in the array `faces`: the next corner of a face of a polyhedron, or what stands before it */
    size_t at_polyhedron;
    uint64_t at_face, at_corner;
    enum { AT_FACES, AT_CORNERS, AT_VERTEX } at;
    uint64_t faces_end; /* of the polyhedra before, in the array `faceoffsets` */
} polyhedra;

static int compare_numbers(uint32_t a, uint32_t b, const void *user) {
    (void)user;
    return a < b ? -1 : a > b;
}

static bool is_finite(const brio_cells *cells, size_t vertex) {
    const double *x = cells->vertices + 3 * vertex;
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

/* Numbers the finite vertices, if some are not. */
static brio_status take_finite(brio_context *ctx, polyhedra *w) {
    const brio_cells *cells = w->cells;
    size_t n = cells->num_vertices;
    for (size_t v = 0; v < n; v++) w->num_finite += is_finite(cells, v);
    if (w->num_finite == n) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(ctx, w->number, n));
    BRIO_FORWARD(BRIO_ALLOC(ctx, w->finite, 3 * w->num_finite));
    for (size_t v = 0, kept = 0; v < n; v++) {
        w->number[v] = (uint32_t)kept;
        if (is_finite(cells, v)) memcpy(w->finite + 3 * kept++, cells->vertices + 3 * v, 3 * sizeof *w->finite);
    }
    return BRIO_OK;
}

static uint32_t number_of(const polyhedra *w, uint32_t vertex) {
    return w->number ? w->number[vertex] : vertex;
}

static bool is_taken(const polyhedra *w, size_t c) {
    const brio_cells *cells = w->cells;
    uint64_t first = cells->corner_offsets[cells->face_offsets[c]];
    uint64_t last = cells->corner_offsets[cells->face_offsets[c + 1]];
    if (!cells->bounded[c] || !brio_cells_num_faces(cells, c)) return false;
    for (uint64_t i = first; i < last && w->number; i++)
        if (!is_finite(cells, cells->face_vertices[i])) return false;
    return true;
}

/* Appends the distinct corners of a cell. */
static void take_vertices(polyhedra *w, size_t c) {
    const brio_cells *cells = w->cells;
    uint64_t first = cells->corner_offsets[cells->face_offsets[c]];
    uint64_t last = cells->corner_offsets[cells->face_offsets[c + 1]];
    uint32_t *list = w->vertex + w->num_vertices;
    size_t count = 0;
    for (uint64_t i = first; i < last; i++) list[count++] = cells->face_vertices[i];
    brio_sort_indices(list, count, compare_numbers, NULL);
    size_t distinct = 0;
    for (size_t i = 0; i < count; i++)
        if (i == 0 || list[i] != list[distinct - 1]) list[distinct++] = list[i];
    w->num_vertices += distinct;
    w->num_numbers += 1 + brio_cells_num_faces(cells, c) + (last - first);
}

static brio_status take_cells(brio_context *ctx, polyhedra *w) {
    const brio_cells *cells = w->cells;
    BRIO_FORWARD(BRIO_ALLOC(ctx, w->vertex, (size_t)cells->corner_offsets[cells->face_offsets[cells->num_cells]]));
    BRIO_FORWARD(BRIO_ALLOC(ctx, w->end, cells->num_cells));
    BRIO_FORWARD(BRIO_ALLOC(ctx, w->polyhedron, cells->num_cells));
    for (size_t c = 0; c < cells->num_cells; c++) {
        BRIO_FORWARD(brio_look(ctx, 16));
        if (!is_taken(w, c)) continue;
        take_vertices(w, c);
        w->polyhedron[w->num_polyhedra] = (uint32_t)c;
        w->end[w->num_polyhedra++] = w->num_vertices;
    }
    return BRIO_OK;
}

/* --- arrays --- */

static void fill_vertices(void *user, uint64_t first, size_t count, void *to) {
    const polyhedra *w = user;
    for (size_t i = 0; i < count; i++) brio_vtk_store_index(&w->xml, to, i, number_of(w, w->vertex[first + i]));
}

static void fill_ends(void *user, uint64_t first, size_t count, void *to) {
    const polyhedra *w = user;
    memcpy(to, w->end + first, count * sizeof *w->end);
}

static void fill_polyhedron_types(void *user, uint64_t first, size_t count, void *to) {
    (void)user, (void)first;
    memset(to, VTK_POLYHEDRON, count);
}

/* Returns the next number of the array `faces`: for each cell the number of faces, and for each face the number of
 * corners, then these. */
static uint32_t next_of_faces(polyhedra *w) {
    const brio_cells *cells = w->cells;
    size_t c = w->polyhedron[w->at_polyhedron];
    if (w->at == AT_FACES) {
        w->at_face = cells->face_offsets[c];
        w->at = AT_CORNERS;
        return (uint32_t)brio_cells_num_faces(cells, c);
    }
    uint64_t end = cells->corner_offsets[w->at_face + 1];
    if (w->at == AT_CORNERS) {
        w->at_corner = cells->corner_offsets[w->at_face];
        w->at = AT_VERTEX;
        return (uint32_t)(end - w->at_corner);
    }
    uint32_t vertex = cells->face_vertices[w->at_corner++];
    if (w->at_corner < end) return number_of(w, vertex);
    w->at = ++w->at_face < cells->face_offsets[c + 1] ? AT_CORNERS : AT_FACES;
    w->at_polyhedron += w->at == AT_FACES;
    return number_of(w, vertex);
}

static void fill_faces(void *user, uint64_t first, size_t count, void *to) {
    polyhedra *w = user;
    (void)first;
    for (size_t i = 0; i < count; i++) brio_vtk_store_index(&w->xml, to, i, next_of_faces(w));
}

static void fill_face_offsets(void *user, uint64_t first, size_t count, void *to) {
    polyhedra *w = user;
    const brio_cells *cells = w->cells;
    for (size_t i = 0; i < count; i++) {
        size_t c = w->polyhedron[first + i];
        uint64_t from = cells->face_offsets[c], end = cells->face_offsets[c + 1];
        w->faces_end += 1 + (end - from) + (cells->corner_offsets[end] - cells->corner_offsets[from]);
        ((uint64_t *)to)[i] = w->faces_end;
    }
}

static void fill_sites(void *user, uint64_t first, size_t count, void *to) {
    const polyhedra *w = user;
    for (size_t i = 0; i < count; i++) ((uint32_t *)to)[i] = w->cells->site[w->polyhedron[first + i]];
}

static void fill_volumes(void *user, uint64_t first, size_t count, void *to) {
    const polyhedra *w = user;
    for (size_t i = 0; i < count; i++) ((double *)to)[i] = w->cells->volume[w->polyhedron[first + i]];
}

static void fill_areas(void *user, uint64_t first, size_t count, void *to) {
    const polyhedra *w = user;
    for (size_t i = 0; i < count; i++) ((double *)to)[i] = w->cells->area[w->polyhedron[first + i]];
}

static void fill_counts(void *user, uint64_t first, size_t count, void *to) {
    const polyhedra *w = user;
    for (size_t i = 0; i < count; i++)
        ((uint32_t *)to)[i] = (uint32_t)brio_cells_num_faces(w->cells, w->polyhedron[first + i]);
}

static brio_status write_arrays(polyhedra *w, const brio_vtk_source *arrays, size_t count) {
    for (size_t i = 0; i < count; i++) BRIO_FORWARD(brio_vtk_write_array(&w->xml, &arrays[i]));
    return BRIO_OK;
}

static brio_status write_polyhedra(polyhedra *w) {
    size_t n = w->num_polyhedra;
    int index = brio_vtk_index_type(&w->xml);
    const brio_vtk_source cells[] = {{"connectivity", index, 1, w->num_vertices, fill_vertices, w},
                                     {"offsets", BRIO_VTK_INT64, 1, n, fill_ends, w},
                                     {"types", BRIO_SCALAR_UINT8, 1, n, fill_polyhedron_types, w},
                                     {"faces", index, 1, w->num_numbers, fill_faces, w},
                                     {"faceoffsets", BRIO_VTK_INT64, 1, n, fill_face_offsets, w}};
    const brio_vtk_source data[] = {{"site", BRIO_SCALAR_UINT32, 1, n, fill_sites, w},
                                    {"volume", BRIO_SCALAR_FLOAT64, 1, n, fill_volumes, w},
                                    {"area", BRIO_SCALAR_FLOAT64, 1, n, fill_areas, w},
                                    {"faces", BRIO_SCALAR_UINT32, 1, n, fill_counts, w}};
    BRIO_FORWARD(brio_output_string(w->xml.out, "<Cells>\n"));
    BRIO_FORWARD(write_arrays(w, cells, sizeof cells / sizeof *cells));
    BRIO_FORWARD(brio_output_string(w->xml.out, "</Cells>\n<CellData>\n"));
    BRIO_FORWARD(write_arrays(w, data, sizeof data / sizeof *data));
    return brio_output_string(w->xml.out, "</CellData>\n");
}

brio_status brio_cells_vtu_write(brio_output *out, const brio_cells *cells, const char *comment) {
    brio_status status = BRIO_OK;
    brio_mesh points = {.num_vertices = cells->num_vertices, .vertices = cells->vertices};
    const brio_write_options options = {.size = sizeof options, .comment = comment};
    const brio_write_job job = {.mesh = &points, .options = &options};
    polyhedra w = {.xml = brio_vtk_writer_new(out, &job, "UnstructuredGrid"), .cells = cells};
    BRIO_TRY(take_finite(out->ctx, &w));
    if (w.number) points.num_vertices = w.num_finite, points.vertices = w.finite;
    BRIO_TRY(take_cells(out->ctx, &w));
    BRIO_TRY(brio_vtk_begin(&w.xml));
    BRIO_TRY(brio_output_format(out, "<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n", points.num_vertices,
                                w.num_polyhedra));
    BRIO_TRY(brio_vtk_write_points(&w.xml));
    BRIO_TRY(write_polyhedra(&w));
    BRIO_TRY(brio_vtk_end(&w.xml));
done:
    brio_vtk_writer_free(&w.xml);
    brio_release(out->ctx, w.vertex);
    brio_release(out->ctx, w.number);
    brio_release(out->ctx, w.finite);
    brio_release(out->ctx, w.end);
    brio_release(out->ctx, w.polyhedron);
    return status;
}
