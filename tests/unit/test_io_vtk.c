/* VTU and VTP files: what is written reads back in every encoding; files of other programs. */
#include "base/rng.h"
#include "failing_allocator.h"
#include "vtk_ways.h"

/* --- round trips --- */

static bool same_edges(const brio_mesh *a, const brio_mesh *b) {
    return a->num_edges == b->num_edges && io_same_bytes(a->edges, b->edges, 2 * a->num_edges * sizeof *a->edges);
}

static bool same_properties(const brio_mesh *a, const brio_mesh *b) {
    if (a->num_properties != b->num_properties) return false;
    for (size_t i = 0; i < a->num_properties; i++) {
        const brio_property *p = &a->properties[i], *q = &b->properties[i];
        size_t size = a->num_vertices * brio_scalar_size(p->type);
        if (strcmp(p->name, q->name) != 0 || p->type != q->type || !io_same_bytes(p->data, q->data, size)) return false;
    }
    return true;
}

static void check_way(const char *name, way w, size_t n, int parts, bool edges) {
    const uint32_t ends[] = {0, 1, 5, 2, 2, 2};
    brio_write_options options = options_of(w);
    brio_mesh *mesh = io_make(n, parts), *back = NULL;
    options.float32 = parts & IO_SINGLE;
    if (edges) EXPECT(brio_mesh_set_edges(mesh, ends, 3) == BRIO_OK);
    EXPECT(brio_write(io_ctx, io_path(name), mesh, &options) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(brio_read(io_ctx, io_path(name), NULL, &back) == BRIO_OK, "%s", brio_message(io_ctx));
    if (back)
        EXPECT(io_same_points(mesh, back) && io_same_faces(mesh, back) && io_same_tetrahedra(mesh, back) &&
                   same_edges(mesh, back) && same_properties(mesh, back),
               "%s, way %d, parts %d", name, (int)w, parts);
    brio_mesh_free(mesh);
    brio_mesh_free(back);
}

static void all_parts_read_back(void) {
    for (int w = 0; w < num_ways(); w++)
        for (int parts = 0; parts < 32; parts++) {
            check_way("a.vtu", (way)w, 700, parts, parts % 3 == 1);
            if (!(parts & IO_TETRAHEDRA)) check_way("a.vtp", (way)w, 700, parts, parts % 3 == 1);
        }
}

/* Arrays of several blocks, and of none. */
static void sizes_read_back(void) {
    static const size_t sizes[] = {0, 6, 5461, 5462, 16384, 40000};
    for (int w = 0; w < num_ways(); w++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            check_way("b.vtu", (way)w, sizes[i], IO_PROPERTIES, sizes[i] > 0);
            check_way("b.vtp", (way)w, sizes[i], 0, false);
        }
}

static void threads_do_not_change_the_bytes(void) {
    size_t sizes[2];
    char *bytes[2];
    brio_mesh *mesh = io_make(12000, IO_PROPERTIES);
    brio_write_options options = options_of(num_ways() == NUM_WAYS ? PACKED : RAW);
    for (int i = 0; i < 2; i++) {
        brio_context_set_threads(io_ctx, 1 + 3 * i);
        EXPECT(brio_write(io_ctx, io_path("a.vtu"), mesh, &options) == BRIO_OK);
        bytes[i] = io_get("a.vtu", &sizes[i]);
    }
    EXPECT(sizes[0] == sizes[1] && io_same_bytes(bytes[0], bytes[1], sizes[0]));
    brio_context_set_threads(io_ctx, 0);
    free(bytes[0]);
    free(bytes[1]);
    brio_mesh_free(mesh);
}

static void refused_options(void) {
    brio_mesh *mesh = io_make(5, 0);
    brio_write_options options = options_of(PACKED);
    EXPECT(brio_write(io_ctx, io_path("a.ply"), mesh, &options) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(io_ctx), ".vtu .vtp .pcd can"), "%s", brio_message(io_ctx));
    options.ascii = 1;
    EXPECT(brio_write(io_ctx, io_path("a.vtu"), mesh, &options) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(io_ctx), "text is not compressed"), "%s", brio_message(io_ctx));
    brio_mesh_free(mesh);
}

/* --- files of others --- */

/* Narrow sizes, point data before the points, wide and unsigned indices, other cells, comments with tags in them. */
static void vtu_of_others(void) {
    static const char xml[] =
        "<!-- <AppendedData> -->\n" VTU_TAG " header_type='UInt32'><UnstructuredGrid><Piece NumberOfPoints=\"4\" "
        "NumberOfCells=\"3\"><PointData><DataArray type=\"Int16\" Name=\"a&lt;b\" format=\"appended\" offset=\"0\"/>"
        "<DataArray type=\"Float32\" Name=\"v\" NumberOfComponents=\"3\" format=\"appended\" "
        "offset=\"12\"/></PointData>"
        "<CellData><DataArray type=\"Float32\" Name=\"c\" format=\"ascii\">7 8 9</DataArray></CellData>"
        "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" "
        "offset=\"64\"/></Points><Cells>"
        "<DataArray type=\"UInt32\" Name=\"connectivity\" format=\"appended\" offset=\"116\"/>"
        "<DataArray type=\"Int32\" Name=\"offsets\" format=\"appended\" offset=\"156\"/>"
        "<DataArray type=\"Int64\" Name=\"types\" format=\"appended\" "
        "offset=\"172\"/></Cells></Piece></UnstructuredGrid>"
        "<AppendedData encoding=\"raw\">\n   _";
    struct __attribute__((packed)) {
        uint32_t a_size;
        int16_t a[4];
        uint32_t v_size;
        float v[12];
        uint32_t points_size;
        float points[12];
        uint32_t connectivity_size;
        uint32_t connectivity[9];
        uint32_t offsets_size;
        int32_t offsets[3];
        uint32_t types_size;
        int64_t types[3];
    } data = {8,  {1, -2, 3, -4},
              48, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
              48, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1},
              36, {0, 1, 2, 0, 1, 2, 3, 0, 1},
              12, {3, 7, 9},
              24, {5, 10, 3}};
    const uint16_t probe = 1;
    if (*(const uint8_t *)&probe == 0) return; /* the bytes above are those of a little-endian machine */
    size_t size = sizeof xml - 1;
    char *bytes = malloc(size + sizeof data);
    memcpy(bytes, xml, size);
    memcpy(bytes + size, &data, sizeof data);
    brio_status status;
    brio_mesh *m = io_read_bytes("o.vtu", bytes, size + sizeof data, &status);
    free(bytes);
    EXPECT(m, "%s", brio_message(io_ctx));
    if (!m) return;
    EXPECT(m->num_vertices == 4 && m->vertices[3] == 1 && m->vertices[11] == 1);
    EXPECT(m->num_faces == 1 && m->face_vertices[2] == 2 && m->num_tetrahedra == 1 && m->tetrahedra[3] == 3);
    EXPECT(m->num_edges == 1 && m->edges[1] == 1);
    EXPECT(m->num_properties == 4 && !strcmp(m->properties->name, "a<b") &&
           brio_property_value(m->properties, 3) == -4);
    const brio_property *v = brio_mesh_property(m, "v_1");
    EXPECT(v && v->type == BRIO_SCALAR_FLOAT32 && brio_property_value(v, 3) == 10);
    EXPECT(m->num_face_properties == 1 && brio_property_value(m->face_properties, 0) == 7);
    brio_mesh_free(m);
}

/* A file of VTK: inline text of two pieces, tags within arrays, strips, lines, vertices; base 64 with blanks and with a
 * padded end after its size. */
static void vtp_of_others(void) {
    static const char text[] =
        "<?xml version=\"1.0\"?>\n" VTP_TAG "><PolyData>"
        "<Piece NumberOfPoints=\"4\" NumberOfVerts=\"1\" NumberOfLines=\"1\" NumberOfStrips=\"1\" NumberOfPolys=\"1\">"
        "<PointData Normals=\"Normals\"><DataArray type=\"Int64\" Name=\"id\" format=\"ascii\" RangeMin=\"1e+299\">\n"
        "1 -2 9007199254740993\n4 <InformationKey name=\"L2\"><Value index=\"0\">\n7\n</Value></InformationKey>"
        "</DataArray><DataArray type=\"UInt8\" Name=\"RGB\" NumberOfComponents=\"3\" format=\"ascii\">"
        "1 2 3 4 5 6 7 8 9 10 11 12</DataArray>"
        "<DataArray type='Float32' Name='only here' format='ascii'>1 2 3 nan</DataArray></PointData>"
        "<CellData><DataArray type=\"Float32\" Name=\"a > b\" format=\"ascii\">1 2 3 4</DataArray></CellData>"
        "<Points><DataArray type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">"
        "0 0 0 1 0 0 0 1 0 .5 1e0 -2.5E-1</DataArray></Points>"
        "<Verts><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">3</DataArray>"
        "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">1</DataArray></Verts>"
        "<Lines><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">3 1 0</DataArray>"
        "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3</DataArray></Lines>"
        "<Strips><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"
        "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray></Strips>"
        "<Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">2 1 0</DataArray>"
        "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece>"
        "<Piece NumberOfPoints=\"1\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"1\">"
        "<PointData><DataArray type=\"Int64\" Name=\"id\" format=\"binary\">\n  CAAA AAAAAAA=\nBQAAAAAA\tAAA=\n"
        "</DataArray><DataArray type=\"UInt8\" Name=\"RGB\" NumberOfComponents=\"3\" format=\"ascii\">7 8 9"
        "</DataArray></PointData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">"
        "DAAAAAAAAAAAAIA/AAAAQAAAQEA=</DataArray></Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" "
        "format=\"ascii\">0 0 0</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3</DataArray>"
        "</Polys></Piece></PolyData></VTKFile>\n";
    const uint32_t corners[] = {0, 1, 2, 1, 3, 2, 2, 1, 0, 4, 4, 4}, edges[] = {3, 1, 1, 0};
    brio_mesh *m = io_read_text("o.vtp", text);
    if (!m) return;
    EXPECT(m->num_vertices == 5 && m->vertices[11] == -.25 && m->vertices[12] == 1 && m->vertices[14] == 3);
    EXPECT(m->num_faces == 4 && !memcmp(m->face_vertices, corners, sizeof corners));
    EXPECT(m->num_edges == 2 && !memcmp(m->edges, edges, sizeof edges));
    const brio_property *id = brio_mesh_property(m, "id"), *blue = brio_mesh_property(m, "blue");
    EXPECT(id && id->type == BRIO_SCALAR_FLOAT64 && brio_property_value(id, 1) == -2 &&
           brio_property_value(id, 4) == 5);
    EXPECT(blue && blue->type == BRIO_SCALAR_UINT8 && brio_property_value(blue, 4) == 9 && m->num_properties == 4);
    brio_mesh_free(m);
}

/* Point data that a piece lacks are passed over, and so are data that a piece has in another type. */
static void data_of_some_pieces(void) {
#define PIECE(data)                                                                                                    \
    "<Piece NumberOfPoints=\"1\"><Points><DataArray type=\"Int8\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3"     \
    "</DataArray></Points><PointData><DataArray type=\"Int8\" Name=\"all\" format=\"ascii\">7</DataArray>" data        \
    "</PointData></Piece>"
#define DATA(name, type) "<DataArray type=\"" type "\" Name=\"" name "\" format=\"ascii\">5</DataArray>"
    brio_mesh *m =
        io_read_text("a.vtp", VTP_TAG "><PolyData>" PIECE(DATA("outer", "Int8") DATA("two types", "Int8"))
                                  PIECE(DATA("inner", "Int8") DATA("two types", "Int16"))
                                      PIECE(DATA("outer", "Int8") DATA("two types", "Int8")) "</PolyData></VTKFile>");
#undef PIECE
#undef DATA
    if (!m) return;
    EXPECT(m->num_vertices == 3 && m->num_properties == 1 && !strcmp(m->properties->name, "all"), "%zu properties",
           m->num_properties);
    brio_mesh_free(m);
}

/* 36 bytes in three blocks, as base 64. */
#define PACKED_POINTS                                                                                                  \
    "AwAAAAAAAAAQAAAAAAAAAAQAAAAAAAAAGwAAAAAAAAAbAAAAAAAAAA8AAAAAAAAAeAEBEADv/wAAgD8AAABAAABAQA"                       \
    "AAgEAQgwJAeAEBEADv/wAAoEAAAMBAAADgQAAAAEEckQNCeAEBBAD7/wAAEEEAZQBS"

#define PACKED_FILE(attributes, inside, behind)                                                                        \
    VTP_TAG " compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"3\"><Points><DataArray "          \
            "type=\"Float32\" NumberOfComponents=\"3\" " attributes ">" inside "</DataArray></Points></Piece>"         \
            "</PolyData>" behind "</VTKFile>"

/* Compressed arrays as base 64, within the tags and behind them: whole, cut off anywhere, with any byte changed. */
static void packed_base64(void) {
    static const char *const files[] = {PACKED_FILE("format=\"binary\"", PACKED_POINTS, ""),
                                        PACKED_FILE("format=\"appended\" offset=\"3\"", "",
                                                    "<AppendedData encoding=\"base64\">\n_AAA\n" PACKED_POINTS
                                                    "\n</AppendedData>")};
    brio_status status;
    if (num_ways() < NUM_WAYS) return;
    for (size_t i = 0; i < 2; i++) {
        size_t size = strlen(files[i]), data = (size_t)(strstr(files[i], "AwAAAAAAAAA") - files[i]);
        brio_mesh *m = io_read_text("p.vtp", files[i]);
        EXPECT(m && m->num_vertices == 3 && m->vertices[0] == 1 && m->vertices[8] == 9);
        brio_mesh_free(m);
        char *changed = malloc(size + 1);
        for (size_t n = 0; n < size; n++) {
            m = io_read_bytes("p.vtp", files[i], n, &status);
            EXPECT(status == BRIO_OK || status == BRIO_ERR_FORMAT, "%zu: %d", n, (int)status);
            EXPECT(n >= data + strlen(PACKED_POINTS) || !m, "%zu bytes", n);
            brio_mesh_free(m);
            memcpy(changed, files[i], size);
            changed[n] ^= 1;
            brio_mesh_free(io_read_bytes("p.vtp", changed, size, &status));
            EXPECT(status == BRIO_OK || status == BRIO_ERR_FORMAT || status == BRIO_ERR_NOT_FINITE, "%zu: %d", n,
                   (int)status);
        }
        free(changed);
    }
    EXPECT(brio_context_memory(io_ctx) == 0);
}

/* Names that two arrays would take. */
static void names_stay_distinct(void) {
    brio_mesh *m = io_read_text(
        "a.vtp", VTP_TAG "><PolyData><Piece NumberOfPoints=\"1\"><PointData>"
                         "<DataArray type=\"Int8\" Name=\"nx\" format=\"ascii\">1</DataArray>"
                         "<DataArray type=\"Int8\" Name=\"Normals\" NumberOfComponents=\"3\" format=\"ascii\">2 3 4"
                         "</DataArray><DataArray type=\"Int8\" Name=\"v\" NumberOfComponents=\"2\" format=\"ascii\">5 6"
                         "</DataArray></PointData><Points><DataArray type=\"Int64\" NumberOfComponents=\"3\" "
                         "format=\"ascii\">1 2 3</DataArray></Points></Piece></PolyData></VTKFile>");
    if (!m) return;
    EXPECT(m->num_properties == 6 && m->vertices[2] == 3);
    EXPECT(brio_mesh_property(m, "nx_2") && brio_property_value(brio_mesh_property(m, "nx_2"), 0) == 2);
    EXPECT(brio_mesh_property(m, "v_1") && brio_property_value(brio_mesh_property(m, "v_1"), 0) == 6);
    brio_mesh_free(m);
}

/* Names that differ in control characters only, which XML cannot hold, were one name in the file. */
static void names_of_control_characters_stay_distinct(void) {
    static const char *const NAMES[] = {"a\1", "a\2", "a _2", "a\t"}, *const WRITTEN[] = {"a ", "a _2", "a _2_2",
                                                                                          "a _3"};
    static const char *const FILES[] = {"n.vtu", "n.vtp"};
    for (int f = 0; f < 2; f++) {
        brio_mesh *mesh = NULL, *back = NULL;
        void *data;
        EXPECT(brio_mesh_new(io_ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, NULL, 1) == BRIO_OK);
        for (size_t i = 0; i < 4; i++) {
            EXPECT(brio_mesh_add_property(mesh, NAMES[i], BRIO_SCALAR_UINT8, &data) == BRIO_OK);
            *(uint8_t *)data = (uint8_t)(10 + i);
        }
        EXPECT(brio_write(io_ctx, io_path(FILES[f]), mesh, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(brio_read(io_ctx, io_path(FILES[f]), NULL, &back) == BRIO_OK, "%s", brio_message(io_ctx));
        for (size_t i = 0; i < 4; i++) {
            const brio_property *p = brio_mesh_property(back, WRITTEN[i]);
            EXPECT(p && *(const uint8_t *)p->data == 10 + i, "%s", WRITTEN[i]);
        }
        brio_mesh_free(mesh);
        brio_mesh_free(back);
    }
}

/* A reader of VTK stops at an infinite coordinate. */
static void vertices_beyond_doubles_are_no_part_of_files(void) {
    static const double points[18] = {0,     0,     0,     1e300, 0,     0, 0,     1e300, 0,
                                      1e300, 1e300, 1e290, 5e299, 4e299, 1, 5e299, 5e299, -1e299};
    brio_context *ctx = io_ctx;
    brio_cells_options o = {0};
    brio_cells *cells = NULL;
    brio_mesh *mesh = NULL;
    size_t infinite = 0;
    o.vertices = 1;
    EXPECT(brio_voronoi_cells(ctx, NULL, points, NULL, 6, &o, &cells) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < 3 * cells->num_vertices; i += 3) infinite += !isfinite(cells->vertices[i + 2]);
    EXPECT(infinite > 0 && infinite < cells->num_vertices);
    EXPECT(brio_cells_write(ctx, io_path("beyond.vtu"), cells, BRIO_CELLS_FORMAT_AUTO, NULL) == BRIO_OK, "%s",
           brio_message(ctx));
    EXPECT(brio_read(ctx, io_path("beyond.vtu"), NULL, &mesh) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(mesh && mesh->num_vertices == cells->num_vertices - infinite);
    brio_mesh_free(mesh);
    brio_cells_free(cells);
}

/* A table of faces without their sizes was read from nowhere. */
static void faces_without_sizes_were_written(void) {
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 2, 2};
    brio_cells_options o = {.size = sizeof o, .no_face_sizes = 1};
    brio_cells *cells = NULL;
    EXPECT(brio_voronoi_cells(io_ctx, NULL, points, NULL, 5, &o, &cells) == BRIO_OK, "%s", brio_message(io_ctx));
    const char *path = io_path("faces.csv");
    EXPECT(brio_cells_write(io_ctx, path, cells, BRIO_CELLS_FORMAT_FACES_CSV, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_cells_write(io_ctx, path, cells, BRIO_CELLS_FORMAT_CSV, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_cells_free(cells);
}

/* A wall between two cells is a face of each; what the file says of a cell, its faces have. */
static void cells_read_back_as_their_faces(void) {
    enum { POINTS = 40 };
    double points[3 * POINTS];
    brio_rng rng = brio_rng_new(5);
    uint64_t faces = 0, corners = 0, read_corners = 0;
    brio_cells_options o = {0};
    brio_cells *cells = NULL;
    brio_mesh *mesh = NULL;
    for (size_t i = 0; i < 3 * POINTS; i++) points[i] = brio_rng_double(&rng);
    o.vertices = 1;
    EXPECT(brio_voronoi_cells(io_ctx, NULL, points, NULL, POINTS, &o, &cells) == BRIO_OK, "%s", brio_message(io_ctx));
    const char *path = io_path("cells.vtu");
    EXPECT(brio_cells_write(io_ctx, path, cells, BRIO_CELLS_FORMAT_AUTO, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(brio_read(io_ctx, path, NULL, &mesh) == BRIO_OK, "%s", brio_message(io_ctx));
    const brio_property *volume = brio_mesh_face_property(mesh, "volume");
    for (size_t c = 0; c < cells->num_cells; c++) {
        if (!cells->bounded[c]) continue;
        for (uint64_t f = cells->face_offsets[c]; f < cells->face_offsets[c + 1]; f++, faces++) {
            EXPECT(faces < mesh->num_faces && volume && ((const double *)volume->data)[faces] == cells->volume[c]);
            corners += cells->corner_offsets[f + 1] - cells->corner_offsets[f];
        }
    }
    for (size_t f = 0; f < mesh->num_faces; f++) read_corners += mesh->face_offsets[f + 1] - mesh->face_offsets[f];
    EXPECT(faces > 100 && mesh->num_faces == faces && read_corners == corners);
    brio_mesh_free(mesh);
    brio_cells_free(cells);
}

SUITE(test_io_vtk) {
    io_begin();
    RUN(all_parts_read_back);
    RUN(sizes_read_back);
    RUN(threads_do_not_change_the_bytes);
    RUN(refused_options);
    RUN(vtu_of_others);
    RUN(vtp_of_others);
    RUN(packed_base64);
    RUN(data_of_some_pieces);
    RUN(names_stay_distinct);
    RUN(names_of_control_characters_stay_distinct);
    RUN(vertices_beyond_doubles_are_no_part_of_files);
    RUN(cells_read_back_as_their_faces);
    RUN(faces_without_sizes_were_written);
    return io_end();
}
