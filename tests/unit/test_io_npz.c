/* NPZ files, made here byte by byte: which arrays are read as what, and damaged archives. tests/foreign compares with
 * NumPy. */
#include "failing_allocator.h"
#include "packed_samples.h"

static bool has_gzip;
static zip_sample z;

static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

static brio_mesh *read_z(const char *name) {
    brio_status status;
    zip_end(&z);
    brio_mesh *m = io_read_bytes(name, z.file.bytes, z.file.size, &status);
    EXPECT(status == BRIO_OK, "%s", brio_message(io_ctx));
    return m;
}

static void expect_z(const char *part) {
    brio_status status;
    brio_mesh *m = io_read_bytes("a.npz", z.file.bytes, z.file.size, &status);
    EXPECT(status == BRIO_ERR_FORMAT && strstr(brio_message(io_ctx), part), "%d: \"%s\" without \"%s\"", (int)status,
           brio_message(io_ctx), part);
    brio_mesh_free(m);
}

static bool are_points(const brio_mesh *m) {
    return m && m->num_vertices == 4 && !memcmp(m->vertices, points, sizeof points);
}

static void stored_deflated_and_wide_archives(void) {
    for (int wide = 0; wide < 2; wide++) {
        if (!has_gzip) return;
        packed_npz(&z, wide);
        brio_status status;
        brio_mesh *m = io_read_bytes("any.name", z.file.bytes, z.file.size, &status);
        EXPECT(are_points(m), "%s", brio_message(io_ctx));
        if (!m) continue;
        EXPECT(m->num_faces == 2 && m->face_vertices[5] == 3 && m->num_tetrahedra == 1 && m->tetrahedra[3] == 3);
        EXPECT(m->num_properties == 1 && m->properties[0].type == BRIO_SCALAR_UINT16 &&
               brio_property_value(&m->properties[0], 3) == 10);
        brio_mesh_free(m);
    }
}

static void stored_needs_nothing(void) {
    zip_begin(&z, false);
    zip_array(&z, "arr_0", "<f8", "(4, 3)", points, sizeof points);
    brio_mesh *m = read_z("a.npz");
    EXPECT(are_points(m) && m->num_properties == 0);
    brio_mesh_free(m);
}

/* All arrays stored: whatever the build has, these are read. */
static void array(const char *name, const char *type, const char *shape, const void *data, size_t size) {
    size_t count = z.count;
    z.count = 0;
    zip_array(&z, name, type, shape, data, size);
    z.count = count + 1;
}

static void names_decide_which_arrays_are_points(void) {
    static const char *const names[] = {"points", "Vertices", "xyz", "positions", "coords", "arr_0", "cloud"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        zip_begin(&z, false);
        array("normals", i < 6 ? "<f8" : "<i8", "(4, 3)", points, sizeof points);
        array(names[i], "<f8", "(4, 3)", points, sizeof points);
        brio_mesh *m = read_z("a.npz");
        EXPECT(are_points(m) && m->num_properties == 3 && !strcmp(m->properties[2].name, "nz"), "%s", names[i]);
        brio_mesh_free(m);
    }
    static const double x[4] = {0, 1, 0, 0}, y[4] = {0, 0, 1, 0}, w[4] = {0, 0, 0, 1};
    zip_begin(&z, false);
    array("z", "<f8", "(4,)", w, sizeof w);
    array("y", "<f8", "(4,)", y, sizeof y);
    array("x", "<f8", "(4,)", x, sizeof x);
    array("weight", "<f8", "(4, 1)", x, sizeof x);
    brio_mesh *m = read_z("a.npz");
    EXPECT(are_points(m) && m->num_properties == 1 && !strcmp(m->properties[0].name, "weight"));
    brio_mesh_free(m);
}

static void columns_become_properties(void) {
    static const uint8_t rgb[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    zip_begin(&z, false);
    array("points", "<f4", "(4, 3)", (float[12]){0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 48);
    array("colors", "|u1", "(4, 3)", rgb, sizeof rgb);
    array("uv", "<f4", "(4, 2)", (float[8]){1, 2, 3, 4, 5, 6, 7, 8}, 32);
    array("triangles", "<i4", "(1, 4)", (int32_t[4]){0, 1, 2, 3}, 16);
    array("simplices", "<i4", "(1, 3)", (int32_t[3]){3, 1, 2}, 12);
    array("three", "<f4", "(3,)", (float[3]){1, 2, 3}, 12);
    brio_mesh *m = read_z("a.npz");
    EXPECT(are_points(m) && m->num_properties == 5);
    if (!m) return;
    EXPECT(brio_property_value(brio_mesh_property(m, "green"), 3) == 11);
    EXPECT(brio_property_value(brio_mesh_property(m, "uv_1"), 3) == 8);
    EXPECT(m->num_faces == 2 && m->face_offsets[1] == 4 && m->face_vertices[4] == 3);
    brio_mesh_free(m);
}

static void unclear_files_list_their_arrays(void) {
    zip_begin(&z, false);
    array("points", "<f8", "(4, 3)", points, sizeof points);
    array("vertices", "<f8", "(4, 3)", points, sizeof points);
    zip_end(&z);
    expect_z("several arrays may be the points");
    EXPECT(strstr(brio_message(io_ctx), "the arrays: points (4, 3), vertices (4, 3)"), "%s", brio_message(io_ctx));
    zip_begin(&z, false);
    array("a", "<f8", "(12,)", points, sizeof points);
    zip_end(&z);
    expect_z("no array is known to be the points");
    zip_begin(&z, false);
    zip_end(&z);
    expect_z("without arrays of NumPy");
}

/* The letters behind the end of an empty type were compared: valgrind tells. */
static void an_empty_type_is_no_type(void) {
    zip_begin(&z, false);
    array("points", "", "(4, 3)", points, sizeof points);
    zip_end(&z);
    expect_z("expected");
}

static void claims_are_held_against_the_file(void) {
    static const char *const shapes[] = {"(5, 3)", "(9223372036854775808, 3)", "(18446744073709551615, 3)",
                                         "(4000000000, 3)"};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        zip_begin(&z, false);
        array("points", "<f8", shapes[i], points, sizeof points);
        zip_end(&z);
        brio_mesh_free(io_expect_sane("a.npz", z.file.bytes, z.file.size, shapes[i], 0));
        zip_begin(&z, false);
        array("points", "<f8", "(4, 3)", points, sizeof points);
        array("faces", "<i8", shapes[i], points, sizeof points);
        zip_end(&z);
        expect_z("promises");
    }
    zip_begin(&z, false);
    array("points", "<f8", "(4, 3)", points, sizeof points);
    array("faces", "<i4", "(1, 3)", (int32_t[3]){0, 1, 4}, 12);
    zip_end(&z);
    expect_z("index 4, expected one of the 4 vertices");
}

static void damaged_archives(void) {
    packed_npz(&z, false);
    size_t end = z.file.size - 25, table = end - z.table.size, one = 0;
    while (memcmp(z.file.bytes + one, &points[3], sizeof *points) != 0) one++;
    z.file.bytes[one] ^= 1;
    expect_z("is damaged: ");
    packed_npz(&z, false);
    z.file.bytes[end] = 'x';
    expect_z("no table at its end");
    packed_npz(&z, false);
    memset(z.file.bytes + table + 24, 0x7f, 4); /* the size of the first array */
    expect_z("cannot stand for");
    packed_npz(&z, false);
    z.file.bytes[table + 8] = 1;
    expect_z("encrypted");
    packed_npz(&z, false);
    z.file.bytes[table + 10] = 12;
    expect_z("method 12 of zip");
    packed_npz(&z, false);
    memset(z.file.bytes + table + 42, 0x7f, 4);
    expect_z("out of place");
}

static void every_prefix_and_changed_byte(void) {
    uint64_t state = 3;
    for (int wide = 0; wide < 2; wide++) {
        packed_npz(&z, wide);
        for (size_t n = 0; n < z.file.size; n++) {
            brio_mesh *m = io_expect_sane("a.npz", z.file.bytes, n, "prefix", n);
            EXPECT(!m, "%zu bytes of %zu were read", n, z.file.size);
            brio_mesh_free(m);
        }
        for (size_t i = 0; i < z.file.size; i++) {
            char old = z.file.bytes[i];
            z.file.bytes[i] ^= (char)(1 << io_random(&state) % 8);
            brio_mesh_free(io_expect_sane("a.npz", z.file.bytes, z.file.size, "byte", i));
            z.file.bytes[i] = (char)0xff;
            brio_mesh_free(io_expect_sane("a.npz", z.file.bytes, z.file.size, "byte 255", i));
            z.file.bytes[i] = old;
        }
    }
}

static int take_whole(const brio_mesh *block, void *user) {
    int *blocks = user;
    EXPECT(are_points(block) && block->num_faces == 2 && block->num_tetrahedra == 1 && block->num_properties == 1);
    ++*blocks;
    return 0;
}

/* The points were handed on before the other arrays were read: polygons were announced and not written, and properties of
 * more points than a block has were written behind its end. */
static void all_arrays_are_one_block(void) {
    brio_file_facts facts = {0};
    brio_mesh *m = NULL;
    int blocks = 0;
    if (!has_gzip) return;
    packed_npz(&z, false);
    io_put("a.npz", z.file.bytes, z.file.size);
    EXPECT(brio_read_blocks(io_ctx, io_path("a.npz"), NULL, take_whole, &blocks, &facts) == BRIO_OK);
    EXPECT(blocks == 1 && !facts.streamed, "%d blocks", blocks);
    EXPECT(brio_convert(io_ctx, io_path("a.npz"), io_path("b.ply"), NULL, NULL) == BRIO_OK);
    EXPECT(brio_read(io_ctx, io_path("b.ply"), NULL, &m) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(are_points(m) && m->num_faces == 2 && m->num_tetrahedra == 1 && m->num_properties == 1);
    brio_mesh_free(m);
}

static brio_status read_current(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_read(ctx, io_path("a.npz"), NULL, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static void each_allocation_fails(void) {
    if (!has_gzip) return;
    packed_npz(&z, true);
    io_put("a.npz", z.file.bytes, z.file.size);
    expect_clean_failures(read_current);
}

SUITE(test_io_npz) {
    io_begin();
    has_gzip = reads_packed(false);
    RUN(stored_needs_nothing);
    RUN(stored_deflated_and_wide_archives);
    RUN(names_decide_which_arrays_are_points);
    RUN(columns_become_properties);
    RUN(unclear_files_list_their_arrays);
    RUN(an_empty_type_is_no_type);
    RUN(claims_are_held_against_the_file);
    if (has_gzip) RUN(damaged_archives);
    RUN(every_prefix_and_changed_byte);
    RUN(all_arrays_are_one_block);
    RUN(each_allocation_fails);
    return io_end();
}
