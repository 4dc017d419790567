/* Writes cells as polyhedra in VTU, VTK's XML file of an unstructured grid. Cells that are unbounded or have no faces
 * are left out.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "base/memory.h"
#include "base/sort.h"
#include "io/cells_write.h"
#include "io/vtk/vtk_xml.h"

enum { VTK_POLYHEDRON = 42 };

typedef struct {
    brio_vtk_writer xml;
    const brio_cells *cells;
    size_t num_polyhedra;
    uint32_t *vertex;     /* the distinct vertices of each polyhedron, ascending */
    size_t num_vertices;  /* of all polyhedra */
    uint64_t *end;        /* of each polyhedron: behind its last vertex */
    uint32_t *polyhedron; /* the cell of each polyhedron */
    uint64_t num_numbers; /* of the array `faces` */
} polyhedra;

static int compare_numbers(uint32_t a, uint32_t b, const void *user) {
    (void)user;
    return a < b ? -1 : a > b;
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
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(ctx, w->vertex, (size_t)cells->corner_offsets[cells->face_offsets[cells->num_cells]]));
    BRIO_TRY(BRIO_ALLOC(ctx, w->end, cells->num_cells));
    BRIO_TRY(BRIO_ALLOC(ctx, w->polyhedron, cells->num_cells));
    for (size_t c = 0; c < cells->num_cells; c++) {
        if (!cells->bounded[c] || !brio_cells_num_faces(cells, c)) continue;
        take_vertices(w, c);
        w->polyhedron[w->num_polyhedra] = (uint32_t)c;
        w->end[w->num_polyhedra++] = w->num_vertices;
    }
done:
    return status;
}

static brio_status write_xml(polyhedra *w) {
    brio_status status = BRIO_OK;
    size_t n = w->num_polyhedra, index = brio_vtk_index_size(&w->xml);
    BRIO_TRY(brio_vtk_begin(&w->xml));
    BRIO_TRY(brio_output_format(w->xml.out, "<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n",
                                w->cells->num_vertices, n));
    BRIO_TRY(brio_vtk_declare_points(&w->xml));
    BRIO_TRY(brio_output_string(w->xml.out, "<Cells>\n"));
    BRIO_TRY(brio_vtk_declare_cells(&w->xml, n, w->num_vertices));
    BRIO_TRY(brio_vtk_declare(&w->xml, "UInt8", "types", 1, n));
    BRIO_TRY(brio_vtk_declare(&w->xml, w->xml.wide ? "Int64" : "Int32", "faces", 1, w->num_numbers * index));
    BRIO_TRY(brio_vtk_declare(&w->xml, "Int64", "faceoffsets", 1, n * sizeof(int64_t)));
    BRIO_TRY(brio_output_string(w->xml.out, "</Cells>\n<CellData>\n"));
    BRIO_TRY(brio_vtk_declare(&w->xml, "UInt32", "site", 1, n * sizeof(uint32_t)));
    BRIO_TRY(brio_vtk_declare(&w->xml, "Float64", "volume", 1, n * sizeof(double)));
    BRIO_TRY(brio_vtk_declare(&w->xml, "Float64", "area", 1, n * sizeof(double)));
    BRIO_TRY(brio_vtk_declare(&w->xml, "UInt32", "faces", 1, n * sizeof(uint32_t)));
    BRIO_TRY(brio_output_string(w->xml.out, "</CellData>\n"));
    BRIO_TRY(brio_vtk_begin_data(&w->xml));
done:
    return status;
}

/* Writes the array `faces`: for each cell the number of faces, and for each face the number of corners, then these. */
static brio_status write_faces(polyhedra *w) {
    const brio_cells *cells = w->cells;
    brio_status status = brio_vtk_write_size(&w->xml, w->num_numbers * brio_vtk_index_size(&w->xml));
    for (size_t i = 0; i < w->num_polyhedra && status == BRIO_OK; i++) {
        size_t c = w->polyhedron[i];
        uint32_t count = (uint32_t)brio_cells_num_faces(cells, c);
        status = brio_vtk_write_indices(&w->xml, &count, 1);
        for (uint64_t f = cells->face_offsets[c]; f < cells->face_offsets[c + 1] && status == BRIO_OK; f++) {
            uint64_t first = cells->corner_offsets[f], corners = cells->corner_offsets[f + 1] - first;
            count = (uint32_t)corners;
            BRIO_TRY(brio_vtk_write_indices(&w->xml, &count, 1));
            BRIO_TRY(brio_vtk_write_indices(&w->xml, cells->face_vertices + first, (size_t)corners));
        }
    }
done:
    return status;
}

static brio_status write_face_offsets(polyhedra *w) {
    const brio_cells *cells = w->cells;
    uint64_t end = 0;
    brio_status status = brio_vtk_write_size(&w->xml, w->num_polyhedra * sizeof end);
    for (size_t i = 0; i < w->num_polyhedra && status == BRIO_OK; i++) {
        uint64_t first = cells->face_offsets[w->polyhedron[i]], last = cells->face_offsets[w->polyhedron[i] + 1];
        end += 1 + (last - first) + (cells->corner_offsets[last] - cells->corner_offsets[first]);
        status = brio_output_bytes(w->xml.out, &end, sizeof end);
    }
    return status;
}

static brio_status write_types(polyhedra *w) {
    const uint8_t type = VTK_POLYHEDRON;
    brio_status status = brio_vtk_write_size(&w->xml, w->num_polyhedra);
    for (size_t i = 0; i < w->num_polyhedra && status == BRIO_OK; i++) status = brio_output_bytes(w->xml.out, &type, 1);
    return status;
}

/* Writes one number of each polyhedron, `size` bytes at `array` for each cell. */
static brio_status write_numbers(polyhedra *w, const void *array, size_t size) {
    brio_status status = brio_vtk_write_size(&w->xml, w->num_polyhedra * size);
    for (size_t i = 0; i < w->num_polyhedra && status == BRIO_OK; i++)
        status = brio_output_bytes(w->xml.out, (const char *)array + size * w->polyhedron[i], size);
    return status;
}

static brio_status write_counts(polyhedra *w) {
    brio_status status = brio_vtk_write_size(&w->xml, w->num_polyhedra * sizeof(uint32_t));
    for (size_t i = 0; i < w->num_polyhedra && status == BRIO_OK; i++) {
        uint32_t count = (uint32_t)brio_cells_num_faces(w->cells, w->polyhedron[i]);
        status = brio_output_bytes(w->xml.out, &count, sizeof count);
    }
    return status;
}

static brio_status write_data(polyhedra *w) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_vtk_write_points(&w->xml));
    BRIO_TRY(brio_vtk_write_size(&w->xml, w->num_vertices * brio_vtk_index_size(&w->xml)));
    BRIO_TRY(brio_vtk_write_indices(&w->xml, w->vertex, w->num_vertices));
    BRIO_TRY(brio_vtk_write_size(&w->xml, w->num_polyhedra * sizeof *w->end));
    BRIO_TRY(brio_output_bytes(w->xml.out, w->end, w->num_polyhedra * sizeof *w->end));
    BRIO_TRY(write_types(w));
    BRIO_TRY(write_faces(w));
    BRIO_TRY(write_face_offsets(w));
    BRIO_TRY(write_numbers(w, w->cells->site, sizeof *w->cells->site));
    BRIO_TRY(write_numbers(w, w->cells->volume, sizeof *w->cells->volume));
    BRIO_TRY(write_numbers(w, w->cells->area, sizeof *w->cells->area));
    BRIO_TRY(write_counts(w));
    BRIO_TRY(brio_vtk_end(&w->xml));
done:
    return status;
}

brio_status brio_cells_vtu_write(brio_output *out, const brio_cells *cells, const char *comment) {
    brio_status status = BRIO_OK;
    const brio_mesh points = {.num_vertices = cells->num_vertices, .vertices = cells->vertices};
    const brio_write_options options = {.size = sizeof options, .comment = comment};
    const brio_write_job job = {.mesh = &points, .options = &options};
    polyhedra w = {.xml = brio_vtk_writer_new(out, &job, "UnstructuredGrid"), .cells = cells};
    BRIO_TRY(take_cells(out->ctx, &w));
    BRIO_TRY(write_xml(&w));
    BRIO_TRY(write_data(&w));
done:
    brio_release(out->ctx, w.vertex);
    brio_release(out->ctx, w.end);
    brio_release(out->ctx, w.polyhedron);
    return status;
}
