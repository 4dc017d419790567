/* Atoms in chemical XYZ files, and binary oriented points. */
#include "failing_allocator.h"
#include "io_files.h"

static const char water[] = "3\nwater\nO 0 0 0.1\nH 0.7 0.5 -0.4\nh1 -0.7 0.5 -0.4\n";

static double value(const brio_mesh *m, const char *name, size_t i) {
    const brio_property *p = m ? brio_mesh_property(m, name) : NULL;
    EXPECT(p, "no %s", name);
    return p ? brio_property_value(p, i) : 0;
}

static void elements_by_symbol_label_and_number(void) {
    brio_mesh *m = io_read_text("a.xyz", water);
    if (!m) return;
    EXPECT(m->num_vertices == 3 && m->vertices[2] == 0.1 && m->vertices[6] == -0.7 && m->num_properties == 2);
    EXPECT(value(m, "atomic_number", 0) == 8 && value(m, "atomic_number", 2) == 1);
    EXPECT(brio_mesh_property(m, "atomic_number")->type == BRIO_SCALAR_UINT8);
    EXPECT(value(m, "radius", 0) == 1.52 && value(m, "radius", 1) == 1.10);
    brio_mesh_free(m);
    m = io_read_text("a.xyz", "4\n\nFe3+ 1 2 3 0.5 x\nCL -1 2 3 1.5 y\nU 0 0 0 2.5 z\nD 0 0 1 3.5 w\n");
    EXPECT(value(m, "atomic_number", 0) == 26 && value(m, "atomic_number", 1) == 17);
    EXPECT(value(m, "atomic_number", 2) == 92 && value(m, "radius", 2) == 1.8 && value(m, "atomic_number", 3) == 1);
    EXPECT(value(m, "column5", 1) == 1.5 && m->num_properties == 3);
    brio_mesh_free(m);
    m = io_read_text("a.xyz", "2\nenergy -12.5\n6 0 0 0\n118 1 1 1\n");
    EXPECT(value(m, "atomic_number", 0) == 6 && value(m, "atomic_number", 1) == 118);
    brio_mesh_free(m);
    m = io_read_text("a.chemical", "1\n\n6 0 0 0\n");
    EXPECT(value(m, "atomic_number", 0) == 6);
    brio_mesh_free(m);
}

/* What begins like atoms and is not stays a text of points. */
static void points_stay_points(void) {
    static const char *const texts[] = {"2\n1 2 3 4\n5 6 7 8\n", "2\nx y z w\n1 2 3 4\n5 6 7 8\n",
                                        "2\n# c\n1 2 3 4\n5 6 7 8\n", "2\n\n1 2 3 4\n5 6 7 8\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        brio_mesh *m = io_read_text("a.xyz", texts[i]);
        EXPECT(m && m->num_vertices == 2 && m->vertices[3] == 5 && m->num_properties == 1, "%s", texts[i]);
        brio_mesh_free(m);
    }
    io_expect_error("a.txt", water, BRIO_ERR_FORMAT, "line");
}

static void columns_that_the_caller_names_make_it_a_text(void) {
    brio_read_options o = {0};
    brio_mesh *m = NULL;
    o.columns = "-,x,y,z";
    io_put("a.xyz", water, strlen(water));
    EXPECT(brio_read(io_ctx, io_path("a.xyz"), &o, &m) == BRIO_ERR_FORMAT, "the comment is no row");
    io_put("a.xyz", "2\nwater\n", 8);
    o.format = BRIO_FORMAT_CHEMICAL;
    EXPECT(brio_read(io_ctx, io_path("a.xyz"), &o, &m) == BRIO_ERR_ARGUMENT && !m);
}

static void of_several_frames_the_first(void) {
    char two[256];
    snprintf(two, sizeof two, "%s%s\n", water, water);
    brio_mesh *m = io_read_text("a.xyz", two);
    EXPECT(m && m->num_vertices == 3);
    brio_mesh_free(m);
}

static void extended_xyz_names_its_columns(void) {
    brio_mesh *m = io_read_text("a.xyz", "2\nLattice=\"1 2 3\" Properties=tag:I:1:label:S:1:pos:R:3:forces:R:3:fixed:L:"
                                         "1:species:S:1 energy=-1\n"
                                         "7 a 1 2 3 0.1 0.2 0.3 T Si\n-8 b 4 5 6 0.4 0.5 0.6 F C\n");
    if (!m) return;
    EXPECT(m->vertices[0] == 1 && m->vertices[5] == 6 && m->num_properties == 7);
    EXPECT(value(m, "tag", 1) == -8 && value(m, "forces_2", 0) == 0.3 && value(m, "fixed", 0) == 1);
    EXPECT(value(m, "atomic_number", 0) == 14 && value(m, "radius", 1) == 1.7);
    brio_mesh_free(m);
}

/* A form feed or a vertical tab ended words, but was skipped nowhere: the search for the next word never ended. */
static void a_form_feed_in_the_comment_ends_no_loop(void) {
    brio_mesh *m = io_read_text("a.xyz", "2\na\fb \v c\n\vC 0\f0 0\nO\t1 0 0\v\n");
    EXPECT(m && m->num_vertices == 2 && value(m, "atomic_number", 1) == 8);
    brio_mesh_free(m);
    m = io_read_text("a.xyz", "1\na\fb\n6 0 0 0\n"); /* the comment decides that 6 is carbon */
    EXPECT(m && m->num_vertices == 1 && value(m, "atomic_number", 0) == 6);
    brio_mesh_free(m);
    m = io_read_text("a.xyz", "1\nc\nC 0 0 0\v5\f\n");
    EXPECT(m && m->num_vertices == 1 && value(m, "column5", 0) == 5);
    brio_mesh_free(m);
}

static void errors_name_the_line(void) {
    io_expect_error("a.xyz", "2\nc\nC 0 0 0\nQq 0 0 0\n", BRIO_ERR_FORMAT,
                    "line 4: expected the symbol or number of an element, found \"Qq\"");
    io_expect_error("a.xyz", "3\nc\nC 0 0 0\nC 1 0 0\n", BRIO_ERR_FORMAT, "promises at least 21 bytes");
    io_expect_error("a.xyz", "3\nc\nC 0 0 0\nC 1 0.000000000 0\n", BRIO_ERR_FORMAT, "in atom 2 (counted from 0) of 3");
    io_expect_error("a.xyz", "1\nc\nC 0 0 0\nC 1 0 0\n", BRIO_ERR_FORMAT, "line 4: expected the end of the file");
    io_expect_error("a.xyz", "2\nc\nC 0 0 0\nC 1 0\n", BRIO_ERR_FORMAT, "line 4: expected another column");
    io_expect_error("a.xyz", "2\nc\nC 0 0 0\nC 1 0 x\n", BRIO_ERR_FORMAT, "line 4: expected a number, found \"x\"");
    io_expect_error("a.xyz", "9223372036854775808\nc\nC 0 0 0\n", BRIO_ERR_FORMAT,
                    "the number of atoms is 9.22337e+18");
    io_expect_error("a.xyz", "4000000000\nc\nC 0 0 0\n", BRIO_ERR_FORMAT, "promises at least 28000000000 bytes");
    io_expect_error("a.xyz", "1\nProperties=species:S:1\nC 0 0 0\n", BRIO_ERR_FORMAT, "line 2: Properties=");
    io_expect_error("a.xyz", "1\nProperties=species:S:1:pos:Q:3\nC 0 0 0\n", BRIO_ERR_FORMAT, "a type S, R, I or L");
    io_expect_error("a.xyz", "1\nProperties=species:S:1:pos:R:3:v:R:999999999\nC 0 0 0\n", BRIO_ERR_FORMAT, "1 to 256");
    io_expect_error("a.xyz", "1\nc\nC nan 0 0\n", BRIO_ERR_NOT_FINITE, "x is NaN");
    io_expect_error("a.chemical", "1\n", BRIO_ERR_FORMAT, "promises");
    io_expect_error("a.chemical", "", BRIO_ERR_FORMAT, "ends at byte 0");
}

/* --- oriented points --- */

static const float oriented[12] = {1, 2, 3, 0, 0, 1, -4, 5, 6, 0.6f, 0, -0.8f};

static void oriented_points(void) {
    brio_status status;
    const uint16_t probe = 1;
    if (*(const uint8_t *)&probe == 0) return; /* the bytes above are those of a little-endian machine */
    brio_mesh *m = io_read_bytes("a.bnpts", oriented, sizeof oriented, &status);
    EXPECT(m && m->num_vertices == 2 && m->vertices[3] == -4 && value(m, "nx", 1) == (double)0.6f);
    EXPECT(m && brio_mesh_property(m, "nz")->type == BRIO_SCALAR_FLOAT32);
    brio_mesh_free(m);
    m = io_read_bytes("a.bnpts", oriented, 0, &status);
    EXPECT(m && m->num_vertices == 0);
    brio_mesh_free(m);
    for (size_t n = 1; n < sizeof oriented; n++) {
        m = io_expect_sane("a.bnpts", (const char *)oriented, n, "prefix", n);
        EXPECT(!m == (n % 24 != 0), "%zu bytes", n);
        brio_mesh_free(m);
    }
}

/* --- damage --- */

static const char *const texts[] = {
    water, "2\nProperties=species:S:1:pos:R:3:forces:R:3:tag:I:1 \nSi 1 2 3 4 5 6 7\nC 4 5 6 7 8 9 0\n"};

static void every_prefix_and_changed_byte(void) {
    uint64_t state = 9;
    for (size_t k = 0; k < 2; k++) {
        size_t size = strlen(texts[k]);
        char *bytes = strdup(texts[k]);
        for (size_t n = 0; n < size; n++) brio_mesh_free(io_expect_sane("a.extxyz", bytes, n, "prefix", n));
        for (size_t i = 0; bytes && i < 4 * size; i++) {
            char old = bytes[i / 4];
            bytes[i / 4] ^= (char)(1 << io_random(&state) % 8);
            brio_mesh_free(io_expect_sane(i % 2 ? "a.xyz" : "a.extxyz", bytes, size, "byte", i));
            bytes[i / 4] = old;
        }
        free(bytes);
    }
}

static const char *current;

static brio_status read_current(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_read(ctx, io_path(current), NULL, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static void each_allocation_fails(void) {
    io_put("a.xyz", texts[1], strlen(texts[1]));
    io_put("a.bnpts", oriented, sizeof oriented);
    current = "a.xyz";
    expect_clean_failures(read_current);
    current = "a.bnpts";
    expect_clean_failures(read_current);
}

SUITE(test_io_chemical) {
    io_begin();
    RUN(elements_by_symbol_label_and_number);
    RUN(points_stay_points);
    RUN(columns_that_the_caller_names_make_it_a_text);
    RUN(of_several_frames_the_first);
    RUN(extended_xyz_names_its_columns);
    RUN(a_form_feed_in_the_comment_ends_no_loop);
    RUN(errors_name_the_line);
    RUN(oriented_points);
    RUN(every_prefix_and_changed_byte);
    RUN(each_allocation_fails);
    return io_end();
}
