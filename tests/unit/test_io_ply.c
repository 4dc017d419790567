/* PLY files as others write them. */
#include "io_files.h"

#define HEADER(format) "ply\nformat " format " 1.0\n"
#define XYZ            "property float x\nproperty float y\nproperty float z\n"

/* A file under construction. */
static char bytes[1 << 16];
static size_t used;

static void text(const char *s) {
    memcpy(bytes + used, s, strlen(s));
    used += strlen(s);
}

/* A scalar in little or big endian order, on a machine of either. */
static void scalar(const void *value, size_t size, bool big) {
    const uint16_t probe = 1;
    bool host_big = *(const uint8_t *)&probe == 0;
    for (size_t i = 0; i < size; i++) bytes[used++] = ((const char *)value)[big == host_big ? i : size - 1 - i];
}

static void number(brio_scalar type, double x, bool big) {
    switch (type) {
    case BRIO_SCALAR_INT8:
        scalar(&(int8_t){(int8_t)x}, 1, big);
        break;
    case BRIO_SCALAR_UINT8:
        scalar(&(uint8_t){(uint8_t)x}, 1, big);
        break;
    case BRIO_SCALAR_INT16:
        scalar(&(int16_t){(int16_t)x}, 2, big);
        break;
    case BRIO_SCALAR_UINT16:
        scalar(&(uint16_t){(uint16_t)x}, 2, big);
        break;
    case BRIO_SCALAR_INT32:
        scalar(&(int32_t){(int32_t)x}, 4, big);
        break;
    case BRIO_SCALAR_UINT32:
        scalar(&(uint32_t){(uint32_t)x}, 4, big);
        break;
    case BRIO_SCALAR_FLOAT32:
        scalar(&(float){(float)x}, 4, big);
        break;
    case BRIO_SCALAR_FLOAT64:
        scalar(&x, 8, big);
        break;
    case BRIO_SCALAR_END:
        break;
    }
}

static brio_mesh *read_bytes(void) {
    brio_status status;
    brio_mesh *mesh = io_read_bytes("t.ply", bytes, used, &status);
    EXPECT(status == BRIO_OK, "%s", brio_message(io_ctx));
    return mesh;
}

static const char *const type_names[2][BRIO_SCALAR_END] = {
    {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"},
    {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"}};
static const double extremes[BRIO_SCALAR_END] = {-128, 255, -32768, 65535, -2147483648.0, 4294967295.0, -0.5, 1e300};

/* Every scalar type under both names, as coordinates, as property and as index and count of a list. */
static void all_types_and_byte_orders(void) {
    for (brio_scalar type = 0; type < BRIO_SCALAR_END; type++)
        for (int naming = 0; naming < 2; naming++)
            for (int big = 0; big < 2; big++) {
                const char *name = type_names[naming][type];
                char line[256];
                used = 0;
                text(big ? HEADER("binary_big_endian") : HEADER("binary_little_endian"));
                snprintf(line, sizeof line,
                         "element vertex 3\nproperty %s z\nproperty %s q\nproperty %s x\nproperty %s y\n", name, name,
                         name, name);
                text(line);
                snprintf(line, sizeof line, "element face 1\nproperty list %s %s vertex_indices\nend_header\n", name,
                         name);
                text(line);
                for (int v = 0; v < 3; v++) {
                    number(type, v + 30, big);
                    number(type, extremes[type], big);
                    number(type, v + 10, big);
                    number(type, v + 20, big);
                }
                for (int i = 0; i < 4; i++) number(type, i ? i - 1 : 3, big);
                brio_mesh *m = read_bytes();
                if (!m) continue;
                EXPECT(m->vertices[3] == 11 && m->vertices[4] == 21 && m->vertices[5] == 31, "%s", name);
                EXPECT(m->num_properties == 1 && m->properties->type == type, "%s", name);
                EXPECT(brio_property_value(m->properties, 2) == extremes[type], "%s big %d", name, big);
                EXPECT(m->num_faces == 1 && m->face_offsets[1] == 3 && m->face_vertices[2] == 2, "%s", name);
                brio_mesh_free(m);
            }
}

/* Carriage returns, comments, unknown elements before and after, lists in vertices, tristrips. */
static void untidy_but_valid_text(void) {
    brio_mesh *m = io_read_text(
        "a.ply", "ply\r\ncomment a b c d e f g h\r\nformat ascii 1.0\r\nobj_info x\r\nelement face 2\r\n"
                 "property uchar flag\r\nproperty list uchar int vertex_index\r\nproperty list uchar float other\r\n"
                 "element camera 1\r\nproperty float a\r\nproperty list int int b\r\n"
                 "element vertex 4\r\nproperty float x\r\nproperty list uchar int neighbours\r\nproperty float y\r\n"
                 "property double z\r\nproperty uchar red\r\nelement tristrips 1\r\nproperty list int int "
                 "vertex_indices\r\nend_header\r\n"
                 "1 3 0 1 2 0\r\n\r\n0 4 3 2 1 0 2 0.5 0.25\r\n7 2 8 9\r\n"
                 "0 0 0 1 10\r\n1 3 7 8 9 0\r\n1 20\r\n0 1 5 1 0 30\r\n 1e1\t0\t1.5 0.1 255 \r\n5 0 1 2 3 -1");
    if (!m) return;
    EXPECT(m->num_vertices == 4 && m->vertices[3] == 1 && m->vertices[9] == 10 && m->vertices[11] == 0.1);
    EXPECT(m->num_faces == 4 && m->face_offsets[2] == 7 && m->face_offsets[4] == 13 && m->face_vertices[3] == 3);
    EXPECT(m->num_properties == 1 && brio_property_value(m->properties, 3) == 255);
    brio_mesh_free(m);
}

static void binary_lists_and_other_elements_are_passed_over(void) {
    used = 0;
    text(HEADER("binary_little_endian") "element material 3\nproperty float a\nproperty uchar b\nelement vertex 2\n" XYZ
                                        "property list uchar ushort n\nproperty short s\nelement empty "
                                        "4000000000000000\nelement tetrahedron 1\n"
                                        "property list uchar int vertex_indices\nend_header\r\n");
    for (int i = 0; i < 15; i++) number(BRIO_SCALAR_UINT8, i, false);
    for (int v = 0; v < 2; v++) {
        for (int k = 0; k < 3; k++) number(BRIO_SCALAR_FLOAT32, v + k, false);
        number(BRIO_SCALAR_UINT8, 3 * v, false);
        for (int k = 0; k < 3 * v; k++) number(BRIO_SCALAR_UINT16, k, false);
        number(BRIO_SCALAR_INT16, -7 - v, false);
    }
    number(BRIO_SCALAR_UINT8, 4, false);
    for (int i = 0; i < 4; i++) number(BRIO_SCALAR_INT32, i % 2, false);
    brio_mesh *m = read_bytes();
    if (!m) return;
    EXPECT(m->num_vertices == 2 && m->vertices[5] == 3 && brio_property_value(m->properties, 1) == -8);
    EXPECT(m->num_tetrahedra == 1 && m->tetrahedra[1] == 1);
    brio_mesh_free(m);
}

/* The program's own files of edges lost them when they were read. */
static void edges_come_back(void) {
    static const double p[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t edges[6] = {0, 1, 3, 1, 2, 0};
    brio_mesh *mesh;
    EXPECT(brio_mesh_new(io_ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, p, 4) == BRIO_OK);
    EXPECT(brio_mesh_set_edges(mesh, edges, 3) == BRIO_OK);
    for (int ascii = 0; ascii < 2; ascii++) {
        brio_write_options o = {0};
        brio_mesh *back = NULL;
        o.ascii = ascii;
        EXPECT(brio_write(io_ctx, io_path("e.ply"), mesh, &o) == BRIO_OK);
        EXPECT(brio_read(io_ctx, io_path("e.ply"), NULL, &back) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(back && back->num_edges == 3 && !memcmp(back->edges, edges, sizeof edges));
        brio_mesh_free(back);
    }
    brio_mesh_free(mesh);
    io_expect_error("r.ply",
                    HEADER("ascii") "element vertex 1\n" XYZ "element edge 1\nproperty int vertex1\nproperty int "
                                    "vertex2\nend_header\n1 2 3\n0 1\n",
                    BRIO_ERR_FORMAT, "edge 0");
    mesh = io_read_text("a.ply",
                        HEADER("ascii") "element vertex 1\n" XYZ "element edge 1\nproperty int vertex1\nend_header\n"
                                        "1 2 3\n0\n");
    EXPECT(mesh && mesh->num_edges == 0, "an edge with one end is passed over");
    brio_mesh_free(mesh);
}

static void name_does_not_matter(void) {
    brio_mesh *m = io_read_text("a.xyz", HEADER("ascii") "element vertex 1\n" XYZ "end_header\n1 2 3\n");
    EXPECT(m && m->num_vertices == 1 && m->vertices[2] == 3);
    brio_mesh_free(m);
}

static void header_errors_name_the_line(void) {
    static const char *const cases[][2] = {
        {"plx\n", "line 1"},
        {"", "line 1"},
        {"ply\nformat ascii 2.0\n", "line 2"},
        {"ply\nelement vertex 0\nend_header\n", "line 3: expected a format"},
        {HEADER("ascii") "element vertex -1\n", "line 3"},
        {HEADER("ascii") "element vertex 99999999999999999999\n", "line 3"},
        {HEADER("ascii") "element vertex 1 2\n", "line 3"},
        {HEADER("ascii") "property float x\n", "line 3: expected an element"},
        {HEADER("ascii") "element vertex 1\nproperty half x\n", "line 4: expected a type"},
        {HEADER("ascii") "element vertex 1\nproperty list uchar x\n", "line 4"},
        {HEADER("ascii") "element vertex 1\nelement vertex 1\n", "a second element vertex"},
        {HEADER("ascii") "element vertex 1\n" XYZ, "line 6: expected end_header"},
        {HEADER("ascii") "element vertex 1\n" XYZ "property int x\nend_header\n1 2 3 4 5 6\n",
         "two properties named x"},
        {HEADER("ascii") "element vertex 1\n" XYZ "property int a\nproperty int a\nend_header\n1 2 3 4 5 6\n",
         "two properties"},
        {HEADER("ascii") "element vertex 1\nproperty float x\nproperty float z\nend_header\n1 2 3 4\n",
         "no property y"},
        {HEADER("ascii") "element face 0\nend_header\n", "no element vertex"},
        {HEADER("ascii") "element vertex 1\nproperty float "
                         "a234567890123456789012345678901234567890123456789012345678901234567890\n",
         "63 characters"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        io_expect_error("h.ply", cases[i][0], BRIO_ERR_FORMAT, cases[i][1]);
}

static void false_promises_allocate_nothing(void) {
    io_expect_error("p.ply", HEADER("binary_little_endian") "element vertex 4000000000000\n" XYZ "end_header\nabc",
                    BRIO_ERR_FORMAT, "promises at least 48000000000000 bytes");
    io_expect_error("p.ply", HEADER("ascii") "element vertex 18446744073709551615\n" XYZ "end_header\nabc",
                    BRIO_ERR_FORMAT, "promises");
    io_expect_error("p.ply",
                    HEADER("ascii") "element vertex 0\n" XYZ "element face 4000000000000\nproperty list uchar int "
                                    "vertex_indices\nend_header\n",
                    BRIO_ERR_FORMAT, "promises");
    EXPECT(brio_context_memory(io_ctx) == 0);
}

/* A pipe has no size to compare with. */
static void false_promises_of_a_pipe(void) {
    static const char header[] = HEADER("binary_little_endian") "element vertex 4000000000\n" XYZ "end_header\nabc";
    static const char larger[] = HEADER("binary_little_endian") "element vertex 4294967280\n" XYZ "end_header\nabc";
    for (int i = 0; i < 2; i++) {
        int ends[2], in = dup(0);
        const char *content = i ? larger : header;
        brio_mesh *m = NULL;
        EXPECT(pipe(ends) == 0 && write(ends[1], content, strlen(content)) > 0);
        close(ends[1]);
        dup2(ends[0], 0);
        brio_status status = brio_read(io_ctx, "-", NULL, &m);
        dup2(in, 0);
        close(in);
        close(ends[0]);
        EXPECT(status == (i ? BRIO_ERR_TOO_LARGE : BRIO_ERR_FORMAT) && !m, "status %d", (int)status);
        EXPECT(brio_context_memory_peak(io_ctx) < 64u << 20, "%zu bytes", brio_context_memory_peak(io_ctx));
    }
}

static void truncation_names_place_and_row(void) {
    io_expect_error("t.ply", HEADER("ascii") "element vertex 2\n" XYZ "end_header\n1.25 2.25 3.25\n4.25\n",
                    BRIO_ERR_FORMAT, "ends at byte 120 in vertex 1 (counted from 0) of 2");
    used = 0;
    text(HEADER("binary_little_endian") "element vertex 1\n" XYZ
                                        "element face 2\nproperty list uchar int vertex_indices\nend_header\n");
    for (int i = 0; i < 3; i++) number(BRIO_SCALAR_FLOAT32, 1, false);
    number(BRIO_SCALAR_UINT8, 5, false);
    for (int i = 0; i < 4; i++) number(BRIO_SCALAR_INT32, 0, false);
    brio_status status;
    brio_mesh *m = io_read_bytes("t.ply", bytes, used, &status);
    EXPECT(status == BRIO_ERR_FORMAT && !m && strstr(brio_message(io_ctx), "in face 0 (counted from 0) of 2"), "%s",
           brio_message(io_ctx));
}

static void rows_are_checked(void) {
#define FACES                                                                                                          \
    HEADER("ascii") "element vertex 3\n" XYZ "element face 2\nproperty list int int vertex_indices\nend_header\n"
#define POINTS "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    io_expect_error("r.ply", FACES POINTS "3 0 1 3\n", BRIO_ERR_FORMAT, "face 1 (counted from 0): index 3");
    io_expect_error("r.ply", FACES POINTS "3 0 -1 2\n", BRIO_ERR_FORMAT, "face 1 (counted from 0): -1 is not");
    io_expect_error("r.ply", FACES POINTS "3 0 0.5 2\n", BRIO_ERR_FORMAT, "face 1 (counted from 0): 0.5 is not");
    io_expect_error("r.ply", FACES POINTS "3 0 4294967296 2\n", BRIO_ERR_FORMAT, "face 1");
    io_expect_error("r.ply", FACES POINTS "-3 0 1 2\n", BRIO_ERR_FORMAT, "face 1 (counted from 0): a list of -3");
    io_expect_error("r.ply", FACES POINTS "3 0 1 two\n", BRIO_ERR_FORMAT, "line 14: expected a number, found \"two\"");
    io_expect_error("r.ply", FACES POINTS "3 0 1 2 0\n", BRIO_ERR_FORMAT, "line 14: expected the end of face 1");
    io_expect_error("r.ply", FACES POINTS "nan 0 1 2\n", BRIO_ERR_FORMAT, "face 1");
    io_expect_error("r.ply", HEADER("ascii") "element vertex 1\n" XYZ "property uchar red\nend_header\n1 2 3 256\n",
                    BRIO_ERR_FORMAT, "vertex 0 (counted from 0): red is 256");
    io_expect_error("r.ply",
                    HEADER("ascii") "element vertex 1\n" XYZ "element tetrahedron 1\nproperty list uchar int "
                                    "vertex_indices\nend_header\n1 2 3\n3 0 0 0\n",
                    BRIO_ERR_FORMAT, "tetrahedron 0");
    io_expect_error("r.ply", HEADER("ascii") "element vertex 3\n" XYZ "end_header\n1 2 3\n1 nan -inf\nnan 1 1\n",
                    BRIO_ERR_NOT_FINITE, "r.ply: point 1: y is NaN (2 such points in all)");
    io_expect_error("r.ply", HEADER("ascii") "element vertex 1\n" XYZ "end_header\n1 1 1e999\n", BRIO_ERR_NOT_FINITE,
                    "point 0: z is infinite (1 such point in all)");
}

/* --- part by part --- */

enum { PARTS_POINTS = 7, PARTS_TETRAHEDRA = 4 };

static brio_mesh *mesh_of_tetrahedra(void) {
    static const uint32_t tetrahedra[PARTS_TETRAHEDRA][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}, {3, 4, 5, 6}};
    double x[3 * PARTS_POINTS];
    brio_mesh *m;
    void *data;
    for (int i = 0; i < 3 * PARTS_POINTS; i++) x[i] = i * i % 11 + 1.0 / 3;
    EXPECT(brio_mesh_new(io_ctx, &m) == BRIO_OK && brio_mesh_set_vertices(m, x, PARTS_POINTS) == BRIO_OK);
    EXPECT(brio_mesh_set_tetrahedra(m, *tetrahedra, 4, PARTS_TETRAHEDRA) == BRIO_OK);
    EXPECT(brio_mesh_add_property(m, "a name", BRIO_SCALAR_UINT16, &data) == BRIO_OK);
    for (int i = 0; i < PARTS_POINTS; i++) ((uint16_t *)data)[i] = (uint16_t)(i + 500);
    return m;
}

/* Hands over the points [begin, end) of a mesh. */
static brio_status put_points(brio_mesh_parts *p, const brio_mesh *m, size_t begin, size_t end) {
    brio_mesh block = *m;
    brio_property property = m->properties[0];
    property.data = (uint16_t *)property.data + begin;
    block.properties = &property;
    block.vertices += 3 * begin;
    block.num_vertices = end - begin;
    return brio_mesh_parts_vertices(io_ctx, p, &block);
}

static void write_parts(const brio_mesh *m, const brio_write_options *o, const char *path) {
    brio_mesh_parts *p;
    EXPECT(brio_mesh_parts_new(io_ctx, path, o, PARTS_POINTS, PARTS_TETRAHEDRA, &p) == BRIO_OK);
    EXPECT(put_points(p, m, 0, 3) == BRIO_OK);
    EXPECT(put_points(p, m, 3, PARTS_POINTS) == BRIO_OK);
    EXPECT(brio_mesh_parts_tetrahedra(io_ctx, p, m->tetrahedra, 1) == BRIO_OK);
    EXPECT(brio_mesh_parts_tetrahedra(io_ctx, p, m->tetrahedra + 4, 0) == BRIO_OK);
    EXPECT(brio_mesh_parts_tetrahedra(io_ctx, p, m->tetrahedra + 4, PARTS_TETRAHEDRA - 1) == BRIO_OK);
    EXPECT(io_count_files("parts.ply") == 0); /* no name before the end */
    EXPECT(brio_mesh_parts_finish(io_ctx, p) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_mesh_parts_free(p);
}

static bool same_bytes(const char *a, const char *b) {
    FILE *f = fopen(a, "rb"), *g = fopen(b, "rb");
    int c = 0, d = 0;
    while (f && g && c == d && c != EOF) c = fgetc(f), d = fgetc(g);
    if (f) fclose(f);
    if (g) fclose(g);
    return f && g && c == d;
}

static void parts_make_the_file_of_the_whole(void) {
    brio_mesh *m = mesh_of_tetrahedra();
    for (int way = 0; way < 4; way++) {
        brio_write_options o = {.size = sizeof o, .ascii = way & 1, .float32 = way >> 1, .comment = "in parts"};
        io_empty_folder();
        write_parts(m, &o, io_path("parts.ply"));
        EXPECT(brio_write(io_ctx, io_path("whole.ply"), m, &o) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(same_bytes(io_path("parts.ply"), io_path("whole.ply")), "way %d", way);
    }
    brio_mesh_free(m);
    io_empty_folder();
}

static void wrong_parts_are_refused(void) {
    brio_mesh *m = mesh_of_tetrahedra();
    brio_mesh_parts *p;
    const uint32_t wrong[4] = {0, 1, 2, PARTS_POINTS};
    EXPECT(brio_mesh_parts_new(io_ctx, io_path("parts.vtu"), NULL, 1, 0, &p) == BRIO_ERR_ARGUMENT && !p);
    EXPECT(brio_mesh_parts_new(io_ctx, io_path("parts.xyz"), NULL, 1, 0, &p) == BRIO_ERR_ARGUMENT && !p);
    EXPECT(brio_mesh_parts_new(io_ctx, io_path("parts.ply"), NULL, UINT64_C(1) << 32, 0, &p) == BRIO_ERR_TOO_LARGE);
    EXPECT(brio_mesh_parts_new(io_ctx, io_path("parts.ply"), NULL, PARTS_POINTS, 2, &p) == BRIO_OK);
    EXPECT(put_points(p, m, 0, 4) == BRIO_OK);
    EXPECT(brio_mesh_parts_tetrahedra(io_ctx, p, m->tetrahedra, 1) == BRIO_ERR_ARGUMENT); /* points are missing */
    EXPECT(put_points(p, m, 3, PARTS_POINTS) == BRIO_ERR_ARGUMENT);                       /* one too many */
    EXPECT(put_points(p, m, 4, PARTS_POINTS) == BRIO_OK);
    EXPECT(brio_mesh_parts_tetrahedra(io_ctx, p, wrong, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_parts_tetrahedra(io_ctx, p, m->tetrahedra, 3) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_parts_tetrahedra(io_ctx, p, m->tetrahedra, 1) == BRIO_OK);
    EXPECT(put_points(p, m, 0, 0) == BRIO_ERR_ARGUMENT); /* behind a tetrahedron */
    EXPECT(brio_mesh_parts_finish(io_ctx, p) == BRIO_ERR_ARGUMENT && strstr(brio_message(io_ctx), "announced"));
    brio_mesh_parts_free(p);
    EXPECT(io_count_files("parts") == 0);
    EXPECT(brio_mesh_parts_new(io_ctx, io_path("none.ply"), NULL, 0, 0, &p) == BRIO_OK);
    EXPECT(brio_mesh_parts_finish(io_ctx, p) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_mesh_parts_free(p);
    EXPECT(io_count_files("none.ply") == 1);
    brio_mesh_parts_free(NULL);
    brio_mesh_free(m);
    io_empty_folder();
}

SUITE(test_io_ply) {
    io_begin();
    RUN(false_promises_of_a_pipe);
    RUN(all_types_and_byte_orders);
    RUN(untidy_but_valid_text);
    RUN(binary_lists_and_other_elements_are_passed_over);
    RUN(edges_come_back);
    RUN(name_does_not_matter);
    RUN(header_errors_name_the_line);
    RUN(false_promises_allocate_nothing);
    RUN(truncation_names_place_and_row);
    RUN(rows_are_checked);
    RUN(parts_make_the_file_of_the_whole);
    RUN(wrong_parts_are_refused);
    return io_end();
}
