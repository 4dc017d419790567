/* GLB files: what is written reads back, how far vertices move, and files that lie. Trees of nodes, modes and attributes
 * of other programs are in tests/foreign/test_glb.py. */
#define _GNU_SOURCE
#include "io_files.h"

static bool can_read;

/* Writes a mesh and reads it back.   moved  receives what brio_write reports. */
static brio_mesh *write_and_read(const brio_mesh *mesh, double *moved) {
    brio_mesh *back = NULL;
    brio_write_options options = {0};
    options.moved = moved;
    options.comment = "a \"comment\" \\ of two\nlines";
    *moved = -1;
    EXPECT(brio_write(io_ctx, io_path("a.glb"), mesh, &options) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_status status = brio_read(io_ctx, io_path("a.glb"), NULL, &back);
    EXPECT(status == BRIO_OK || !can_read, "%s", brio_message(io_ctx));
    return back;
}

static double greatest_distance(const brio_mesh *a, const brio_mesh *b) {
    double most = 0;
    EXPECT(a->num_vertices == b->num_vertices);
    for (size_t v = 0; v < a->num_vertices && v < b->num_vertices; v++) {
        const double *p = a->vertices + 3 * v, *q = b->vertices + 3 * v;
        double d = sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
        most = fmax(most, d);
    }
    return most;
}

/* n points in a box of this half side about a centre. */
static brio_mesh *box(size_t n, const double *centre, double half) {
    brio_mesh *m = NULL;
    uint64_t state = n;
    EXPECT(brio_mesh_new(io_ctx, &m) == BRIO_OK && brio_mesh_set_vertices(m, NULL, n) == BRIO_OK);
    for (size_t i = 0; i < 3 * n; i++)
        m->vertices[i] = centre[i % 3] + half * (2 * (double)io_random(&state) / 0x1p53 - 1);
    return m;
}

/* Coordinates that are floats stay as they are. */
static void floats_read_back(void) {
    for (int parts = 0; parts < 2; parts++)
        for (size_t n = 0; n < 300; n += 20) {
            double moved;
            brio_mesh *mesh = io_make(n, n ? IO_SINGLE | (parts ? IO_FACES : 0) : 0);
            brio_mesh *back = write_and_read(mesh, &moved);
            EXPECT(moved == 0, "moved by %g", moved);
            if (back) EXPECT(io_same_points(mesh, back), "%zu points", n);
            brio_mesh_free(mesh);
            brio_mesh_free(back);
        }
}

/* The report is the distance found, and as small as single precision allows about the middle of the box. */
static void distance_is_reported(void) {
    static const double centres[][3] = {{0, 0, 0}, {1, 1, 1}, {638982.55, 4912345.75, 312.5}, {1e15, -1e15, 1e15}};
    for (size_t i = 0; i < 4; i++)
        for (int power = -20; power <= 20; power += 5) {
            double moved, half = ldexp(1, power);
            brio_mesh *mesh = box(500, centres[i], half), *back = write_and_read(mesh, &moved);
            if (back)
                EXPECT(greatest_distance(mesh, back) == moved, "%g, not %g", greatest_distance(mesh, back), moved);
            /* half a unit in the last place of 24 bits of each coordinate, the origin off the middle by a sixteenth, and
             * the rounding of the sum in double precision */
            double most = 1.75 * (half * 1.125 * 0x1p-24 + fabs(centres[i][0]) * 0x1p-52 * 4);
            EXPECT(moved <= most, "centre %g, half side %g: moved by %g, expected %g at most", centres[i][0], half,
                   moved, most);
            brio_mesh_free(mesh);
            brio_mesh_free(back);
        }
}

static void expect_property(const brio_mesh *a, const brio_mesh *b, const char *name) {
    const brio_property *p = brio_mesh_property(a, name), *q = brio_mesh_property(b, name);
    EXPECT(p && q, "%s", name);
    for (size_t v = 0; p && q && v < a->num_vertices; v++) {
        double x = brio_property_value(p, v);
        bool single = p->type >= BRIO_SCALAR_INT32;
        EXPECT(brio_property_value(q, v) == (single ? (double)(float)x : x), "%s of vertex %zu", name, v);
    }
    if (p && q) EXPECT(q->type == (p->type >= BRIO_SCALAR_INT32 ? BRIO_SCALAR_FLOAT32 : p->type), "%s", name);
}

static void properties_read_back(void) {
    static const struct {
        const char *names;
        brio_scalar type;
    } groups[] = {{"nx ny nz", BRIO_SCALAR_FLOAT32},
                  {"red green blue", BRIO_SCALAR_UINT8},
                  {"red green blue alpha", BRIO_SCALAR_UINT16},
                  {"red green blue", BRIO_SCALAR_FLOAT32},
                  {"red green blue", BRIO_SCALAR_INT8},
                  {"nx nz confidence a\"b\\", BRIO_SCALAR_FLOAT32},
                  {"one", BRIO_SCALAR_INT8},
                  {"one two", BRIO_SCALAR_UINT16},
                  {"one", BRIO_SCALAR_INT16}};
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++) {
        uint64_t state = g;
        double moved;
        char names[64], *name, *rest = names;
        brio_mesh *mesh = io_make(37, IO_FACES | IO_SINGLE);
        strcpy(names, groups[g].names);
        while ((name = strsep(&rest, " ")) != NULL) io_fill_property(mesh, name, groups[g].type, &state);
        brio_mesh *back = write_and_read(mesh, &moved);
        for (size_t i = 0; back && i < mesh->num_properties; i++) expect_property(mesh, back, mesh->properties[i].name);
        if (back) EXPECT(back->num_properties == mesh->num_properties, "%s", groups[g].names);
        brio_mesh_free(mesh);
        brio_mesh_free(back);
    }
}

/* Integers of 32 bits and doubles are rounded to floats. */
static void wide_properties_are_rounded(void) {
    static const char *const names[] = {"i", "u", "d"};
    double moved;
    uint64_t state = 3;
    brio_mesh *mesh = io_make(20, IO_SINGLE);
    for (int i = 0; i < 3; i++)
        io_fill_property(mesh, names[i],
                         (const brio_scalar[]){BRIO_SCALAR_INT32, BRIO_SCALAR_UINT32, BRIO_SCALAR_FLOAT64}[i], &state);
    for (size_t v = 0; v < 20; v++) ((double *)mesh->properties[2].data)[v] = 0.1 * (double)v;
    brio_mesh *back = write_and_read(mesh, &moved);
    for (int i = 0; back && i < 3; i++) expect_property(mesh, back, names[i]);
    brio_mesh_free(mesh);
    brio_mesh_free(back);
}

/* Polygons are cut from their first corner; edges stay beside them, and vertices stay one set. */
static void faces_and_edges(void) {
    const uint64_t offsets[] = {0, 5, 7, 10};
    const uint32_t corners[] = {0, 1, 2, 3, 4, 0, 1, 4, 1, 2}, edges[] = {0, 4, 3, 1};
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 4, 1, 2};
    double moved;
    brio_mesh *mesh = io_make(5, IO_SINGLE);
    EXPECT(brio_mesh_set_faces(mesh, offsets, corners, 3) == BRIO_OK && brio_mesh_set_edges(mesh, edges, 2) == BRIO_OK);
    brio_mesh *back = write_and_read(mesh, &moved);
    if (back) {
        EXPECT(back->num_vertices == 5 && back->num_faces == 4 && back->num_edges == 2);
        EXPECT(io_same_bytes(back->face_vertices, triangles, sizeof triangles));
        EXPECT(io_same_bytes(back->edges, edges, sizeof edges));
    }
    brio_mesh_free(mesh);
    brio_mesh_free(back);
}

static void refused_meshes(void) {
    brio_mesh *mesh = io_make(5, IO_TETRAHEDRA);
    EXPECT(brio_write(io_ctx, io_path("a.glb"), mesh, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(io_ctx), "a GLB file cannot hold tetrahedra"), "%s", brio_message(io_ctx));
    brio_mesh_free(mesh);
    mesh = io_make(2, 0);
    mesh->vertices[0] = 1e300;
    mesh->vertices[3] = -1e300;
    EXPECT(brio_write(io_ctx, io_path("a.glb"), mesh, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(io_ctx), "single precision"), "%s", brio_message(io_ctx));
    mesh->vertices[3] = mesh->vertices[0] = 1;
    EXPECT(brio_write(io_ctx, io_path("a.gltf"), mesh, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(io_ctx), ".glb files are"), "%s", brio_message(io_ctx));
    brio_mesh_free(mesh);
}

/* --- files that lie --- */

static void expect_json_error(const char *json, const char *part) {
    if (can_read) io_expect_error("a.gltf", json, BRIO_ERR_FORMAT, part);
}

static void errors_of_json(void) {
#define ASSET "{\"asset\":{\"version\":\"2.0\"},"
    char deep[400] = ASSET "\"x\":";
    memset(deep + strlen(deep), '[', 200);
    expect_json_error("", "expected JSON");
    expect_json_error("{\"asset\":", "expected JSON");
    expect_json_error("{}", "expected glTF 2.0");
    expect_json_error("[1,2]", "expected glTF 2.0");
    expect_json_error("{\"asset\":{\"version\":\"1.0\"}}", "expected glTF 2.0");
    expect_json_error(deep, "levels");
    expect_json_error(ASSET "\"buffers\":[7]}", "buffers[0].");
    expect_json_error(ASSET "\"buffers\":[{\"byteLength\":1e300}]}", "buffers[0].byteLength: expected a whole number");
    expect_json_error(ASSET "\"buffers\":[{\"byteLength\":4,\"uri\":\"data:;base64,A?==\"}]}", "expected base64");
    expect_json_error(ASSET "\"buffers\":[{\"byteLength\":4,\"uri\":\"data:;base64,AAAA\"}]}", "byteLength bytes");
    expect_json_error(ASSET "\"nodes\":[{\"matrix\":[1,2]}]}", "nodes[0].matrix: expected finite numbers");
    expect_json_error(ASSET "\"nodes\":[{\"scale\":[1,2,3,4]}]}", "fewer numbers");
    expect_json_error(ASSET "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}", "the file has 0 meshes");
    expect_json_error(ASSET "\"meshes\":[{\"primitives\":[{\"mode\":7}]}]}", "a number from 0 to 6");
    expect_json_error(ASSET "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{}]}]}", "without POSITION");
#undef ASSET
}

static void errors_of_the_container(void) {
    static const char *const texts[] = {"glTF\1\0\0\0\14\0\0\0", "glTF\2\0\0\0\14\0\0\0",
                                        "glTF\2\0\0\0\50\0\0\0\4\0\0\0NOSJ",
                                        "glTF\2\0\0\0\50\0\0\0\377\377\377\377JSON"};
    static const size_t sizes[] = {12, 12, 20, 20};
    static const char *const parts[] = {"version 1 of glTF", "ends at byte 12", "expected the JSON chunk",
                                        "promises at least 4294967295 bytes"};
    for (size_t i = 0; i < 4; i++) {
        brio_status status;
        brio_mesh *m = io_read_bytes("c.glb", texts[i], sizes[i], &status);
        EXPECT(status == BRIO_ERR_FORMAT && strstr(brio_message(io_ctx), parts[i]), "%s", brio_message(io_ctx));
        brio_mesh_free(m);
    }
}

/* The parser's memory counts: a text of many values in little memory is refused. */
static void memory_of_the_parser_counts(void) {
    enum { VALUES = 100000 };
    char *text = malloc(2 * VALUES + 64), *end = text;
    brio_mesh *m = NULL;
    end += sprintf(end, "{\"asset\":{\"version\":\"2.0\"},\"x\":[1");
    for (int i = 0; i < VALUES; i++) end += sprintf(end, ",1");
    end += sprintf(end, "]}");
    io_put("m.gltf", text, (size_t)(end - text));
    free(text);
    brio_context_set_memory_limit(io_ctx, 4 << 20);
    brio_status status = brio_read(io_ctx, io_path("m.gltf"), NULL, &m);
    EXPECT(status == BRIO_ERR_NO_MEMORY || !can_read, "%d", (int)status);
    brio_mesh_free(m);
    brio_context_set_memory_limit(io_ctx, 0);
    status = brio_read(io_ctx, io_path("m.gltf"), NULL, &m);
    EXPECT(status == BRIO_OK || !can_read, "%s", brio_message(io_ctx));
    brio_mesh_free(m);
}

SUITE(test_io_glb) {
    io_begin();
    brio_mesh *m = NULL;
    io_put("try.gltf", "{\"asset\":{\"version\":\"2.0\"}}", 27);
    can_read = brio_read(io_ctx, io_path("try.gltf"), NULL, &m) == BRIO_OK;
    if (!can_read) printf("skipped: reading GLB: %s\n", brio_message(io_ctx));
    EXPECT(can_read || strstr(brio_message(io_ctx), "cJSON"), "%s", brio_message(io_ctx));
    brio_mesh_free(m);
    RUN(floats_read_back);
    RUN(distance_is_reported);
    RUN(properties_read_back);
    RUN(wide_properties_are_rounded);
    RUN(faces_and_edges);
    RUN(refused_meshes);
    RUN(errors_of_json);
    RUN(errors_of_the_container);
    RUN(memory_of_the_parser_counts);
    return io_end();
}
