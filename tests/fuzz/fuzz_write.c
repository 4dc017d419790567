/* Every writer: a mesh of a few numbers, with hostile names of properties, is written and read again. Formats that hold
 * doubles give back the same bits, and every format the parts that docs/formats.md says it keeps. */
#include "fuzz_folder.h"

enum { MOST = 8, LONGEST = 1 << 18, DOUBLES = 1, FACES = 2, TETRAHEDRA = 4, PROPERTIES = 8, EDGES = 16 };

static const struct {
    const char *name;
    brio_format format;
    int keeps;
} kinds[] = {{"a.ply", BRIO_FORMAT_PLY, DOUBLES | FACES | TETRAHEDRA | PROPERTIES},
             {"a.xyz", BRIO_FORMAT_XYZ, DOUBLES | PROPERTIES},
             {"a.csv", BRIO_FORMAT_XYZ, DOUBLES | PROPERTIES},
             {"a.obj", BRIO_FORMAT_OBJ, DOUBLES | FACES},
             {"a.off", BRIO_FORMAT_OFF, DOUBLES | FACES},
             {"a.vtu", BRIO_FORMAT_VTU, DOUBLES | FACES | TETRAHEDRA | PROPERTIES | EDGES},
             {"a.vtp", BRIO_FORMAT_VTP, DOUBLES | FACES | PROPERTIES | EDGES},
             {"a.node", BRIO_FORMAT_NODE, DOUBLES},
             {"a.las", BRIO_FORMAT_LAS, 0},
             {"a.stl", BRIO_FORMAT_STL, 0},
             {"a.npy", BRIO_FORMAT_NPY, DOUBLES | PROPERTIES},
             {"a.glb", BRIO_FORMAT_GLB, 0},
             {"a.laz", BRIO_FORMAT_LAZ, 0},
             {"a.gltf", BRIO_FORMAT_GLB, 0},
             {"a.e57", BRIO_FORMAT_E57, DOUBLES | PROPERTIES},
             {"a.ptx", BRIO_FORMAT_PTX, 0},
             {"a.pcd", BRIO_FORMAT_PCD, DOUBLES},
             {"a.pts", BRIO_FORMAT_PTS, DOUBLES},
             {"a.xyzrgb", BRIO_FORMAT_XYZRGB, DOUBLES},
             {"a.xyzn", BRIO_FORMAT_XYZN, DOUBLES},
             {"a.vtk", BRIO_FORMAT_VTK, 0}};

enum { KINDS = sizeof kinds / sizeof *kinds };

static void forget_files(void) {
    static const char *const beside[] = {"a.ele", "a.neigh", "a.face", "a.edge"};
    for (size_t i = 0; i < KINDS; i++) fuzz_remove(kinds[i].name);
    for (size_t i = 0; i < sizeof beside / sizeof *beside; i++) fuzz_remove(beside[i]);
    fuzz_leave_folder();
}

/* --- a mesh --- */

static void add_property(fuzz_input *in, brio_mesh *m) {
    static const char *const names[] = {"value", "x",  "X",   "nx",  "easting", "1.5",      "a b", "a,b",
                                        "#a",    "//", "\"q", "<a>", "a\n",     "\xc3\xa4", "red", "vertex_indices",
                                        "x_2",   "-"};
    char name[80] = {0};
    void *data;
    size_t choice = fuzz_below(in, 24);
    if (choice < sizeof names / sizeof *names)
        strcpy(name, names[choice]);
    else
        for (size_t i = 0, length = fuzz_below(in, 66); i < length; i++) name[i] = (char)(1 + fuzz_byte(in) % 255);
    brio_scalar type = (brio_scalar)fuzz_below(in, BRIO_SCALAR_END);
    if (brio_mesh_add_property(m, name, type, &data) != BRIO_OK) return;
    for (size_t i = 0; i < m->num_vertices; i++) {
        if (type == BRIO_SCALAR_FLOAT64)
            ((double *)data)[i] = fuzz_double(in);
        else if (type == BRIO_SCALAR_FLOAT32)
            ((float *)data)[i] = (float)fuzz_byte(in) / 3;
        else
            for (size_t k = 0; k < brio_scalar_size(type); k++)
                ((uint8_t *)data)[i * brio_scalar_size(type) + k] = fuzz_byte(in);
    }
}

static uint32_t fuzz_vertex(fuzz_input *in, size_t n, bool wrong) {
    return wrong && fuzz_byte(in) == 255 ? (uint32_t)n : (uint32_t)fuzz_below(in, n);
}

static brio_mesh *make_mesh(brio_context *ctx, fuzz_input *in) {
    brio_mesh *m;
    uint64_t offsets[MOST + 1] = {0};
    uint32_t corners[MOST * 6], tetrahedra[4 * MOST], edges[2 * MOST];
    size_t n = fuzz_below(in, MOST + 1);
    uint8_t parts = n ? fuzz_byte(in) : 0;
    bool wrong = parts & 64;
    FUZZ_EXPECT(brio_mesh_new(ctx, &m) == BRIO_OK && brio_mesh_set_vertices(m, NULL, n) == BRIO_OK);
    for (size_t i = 0; i < 3 * n; i++) m->vertices[i] = fuzz_double(in);
    size_t faces = parts & 1 ? fuzz_below(in, MOST + 1) : 0, tets = parts & 2 ? fuzz_below(in, MOST + 1) : 0;
    size_t lines = parts & 4 ? fuzz_below(in, MOST + 1) : 0;
    for (size_t f = 0; f < faces; f++) {
        offsets[f + 1] = offsets[f] + 3 + (parts & 8 ? fuzz_below(in, 4) : 0);
        for (uint64_t c = offsets[f]; c < offsets[f + 1]; c++) corners[c] = fuzz_vertex(in, n, wrong);
    }
    for (size_t i = 0; i < 4 * tets; i++) tetrahedra[i] = fuzz_vertex(in, n, wrong);
    for (size_t i = 0; i < 2 * lines; i++) edges[i] = fuzz_vertex(in, n, wrong);
    if (faces) FUZZ_EXPECT(brio_mesh_set_faces(m, offsets, corners, faces) == BRIO_OK);
    if (tets) FUZZ_EXPECT(brio_mesh_set_tetrahedra(m, tetrahedra, 4, tets) == BRIO_OK);
    if (lines) FUZZ_EXPECT(brio_mesh_set_edges(m, edges, lines) == BRIO_OK);
    for (size_t more = parts & 16 ? fuzz_below(in, 4) : 0; more; more--) add_property(in, m);
    for (int k = 0; k < 3 && parts & 32; k++)
        m->coordinate_step[k] = fuzz_flag(in) ? 0.01 : fuzz_double(in), m->coordinate_origin[k] = fuzz_double(in);
    return m;
}

/* --- what a reader finds --- */

static brio_mesh *read_again(brio_context *ctx, const char *name) {
    static char bytes[LONGEST];
    brio_mesh *m = NULL;
    FILE *f = fopen(fuzz_path(name), "rb");
    FUZZ_EXPECT(f, "%s is not there", name);
    size_t size = fread(bytes, 1, sizeof bytes, f);
    fclose(f);
    FUZZ_EXPECT(size < sizeof bytes);
    brio_status status = brio_read_memory(ctx, bytes, size, name, NULL, &m);
    FUZZ_EXPECT(status == BRIO_OK, "%s: %s", name, brio_message(ctx));
    fuzz_expect_sound(m);
    return m;
}

/* Returns whether every format can hold the name, and no other name becomes the same. Names in XML begin with no digit. */
static bool is_word(const char *name) {
    bool axis = strchr("xyzXYZ", name[0]) && !name[1], digit = name[0] >= '0' && name[0] <= '9';
    return !axis && !digit &&
           strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789") == strlen(name);
}

static void expect_properties(const brio_mesh *a, const brio_mesh *b, bool as_doubles) {
    FUZZ_EXPECT(a->num_properties == b->num_properties, "%zu properties, %zu written", b->num_properties,
                a->num_properties);
    for (size_t p = 0; p < a->num_properties; p++) {
        const brio_property *from = &a->properties[p], *to = &b->properties[p];
        FUZZ_EXPECT(as_doubles || from->type == to->type, "property %zu", p);
        FUZZ_EXPECT(!is_word(from->name) || !strcmp(from->name, to->name), "%s became %s", from->name, to->name);
        for (size_t i = 0; i < a->num_vertices; i++) {
            double x = brio_property_value(from, i), y = brio_property_value(to, i);
            if (as_doubles && from->type == BRIO_SCALAR_FLOAT32) y = (float)y; /* as few digits as a float needs */
            FUZZ_EXPECT(x == y, "vertex %zu: %s is %.17g, %s was %.17g", i, to->name, y, from->name, x);
        }
    }
}

static void expect_same(const brio_mesh *a, const brio_mesh *b, int keeps, bool text) {
    if (keeps & DOUBLES) {
        FUZZ_EXPECT(a->num_vertices == b->num_vertices, "%zu vertices, %zu written", b->num_vertices, a->num_vertices);
        FUZZ_EXPECT(!a->num_vertices || !memcmp(a->vertices, b->vertices, 24 * a->num_vertices), "other coordinates");
    }
    if (keeps & FACES && a->num_faces) {
        uint64_t corners = a->face_offsets[a->num_faces];
        FUZZ_EXPECT(a->num_faces == b->num_faces && corners == b->face_offsets[b->num_faces], "%zu faces, %zu written",
                    b->num_faces, a->num_faces);
        FUZZ_EXPECT(!memcmp(a->face_vertices, b->face_vertices, 4 * corners), "other faces");
    }
    if (keeps & TETRAHEDRA && a->num_tetrahedra)
        FUZZ_EXPECT(a->num_tetrahedra == b->num_tetrahedra &&
                        !memcmp(a->tetrahedra, b->tetrahedra, 16 * a->num_tetrahedra),
                    "other tetrahedra");
    if (keeps & EDGES && a->num_edges) FUZZ_EXPECT(a->num_edges == b->num_edges, "other edges");
    if (keeps & PROPERTIES && a->num_vertices) expect_properties(a, b, text);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static bool begun;
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    brio_write_options o = {0};
    size_t kind = fuzz_below(&in, KINDS);
    uint8_t bits = fuzz_byte(&in);
    char comment[9] = {0};
    double moved = -1;
    if (!begun) atexit(forget_files);
    begun = true;
    o.format = kinds[kind].format;
    o.ascii = bits & 1, o.float32 = (bits & 6) == 6, o.compress = (bits & 24) == 24, o.moved = &moved;
    if (bits & 32)
        for (int i = 0; i < 8; i++) comment[i] = (char)fuzz_byte(&in);
    o.comment = bits & 32 ? comment : NULL;
    if (bits & 64 && o.format == BRIO_FORMAT_NODE) o.neighbours = o.faces = o.edges = 1;
    brio_mesh *m = make_mesh(ctx, &in);
    brio_status status = brio_write(ctx, fuzz_path(kinds[kind].name), m, &o);
    fuzz_expect_failure(status);
    FUZZ_EXPECT(status == BRIO_OK || status == BRIO_ERR_ARGUMENT || status == BRIO_ERR_TOO_LARGE, "%s",
                brio_message(ctx));
    if (status == BRIO_OK && m->num_vertices) {
        brio_mesh *again = read_again(ctx, kinds[kind].name);
        expect_same(m, again, kinds[kind].keeps & (o.float32 ? ~DOUBLES : ~0), o.format == BRIO_FORMAT_XYZ);
        FUZZ_EXPECT(moved == 0 || !(kinds[kind].keeps & DOUBLES) || o.float32, "moved %g", moved);
        brio_mesh_free(again);
    }
    brio_mesh_free(m);
    fuzz_end();
    return 0;
}
