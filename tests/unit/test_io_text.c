/* Texts of numbers, OBJ, OFF and NODE files as others write them. */
#include "io_files.h"
#include <ctype.h>

static void format_of_names(void) {
    EXPECT(brio_format_of("a/b.c/d.PLY") == BRIO_FORMAT_PLY && brio_format_of(".ply") == BRIO_FORMAT_PLY);
    EXPECT(brio_format_of("ply") == BRIO_FORMAT_PLY && brio_format_of("a.pts") == BRIO_FORMAT_PTS);
    EXPECT(brio_format_of("x.txt") == BRIO_FORMAT_XYZ && brio_format_of("x.csv") == BRIO_FORMAT_XYZ);
    EXPECT(brio_format_of("x.xyzrgb") == BRIO_FORMAT_XYZRGB && brio_format_of("x.xyzn") == BRIO_FORMAT_XYZN);
    EXPECT(brio_format_of("x.obj") == BRIO_FORMAT_OBJ && brio_format_of("x.off") == BRIO_FORMAT_OFF);
    EXPECT(brio_format_of("x.vtu") == BRIO_FORMAT_VTU && brio_format_of("x.node") == BRIO_FORMAT_NODE);
    EXPECT(brio_format_of("x.ele") == BRIO_FORMAT_NODE && brio_format_of("x.ply.gz") == BRIO_FORMAT_AUTO);
    EXPECT(brio_format_of("x.npz") == BRIO_FORMAT_NPZ && brio_format_of("x.bnpts") == BRIO_FORMAT_BNPTS);
    EXPECT(brio_format_of("x.extxyz") == BRIO_FORMAT_CHEMICAL);
    EXPECT(brio_format_of("") == BRIO_FORMAT_AUTO && brio_format_of("off.d/x") == BRIO_FORMAT_AUTO);
}

static void missing_files_and_unknown_formats(void) {
    brio_mesh *m;
    EXPECT(brio_read(io_ctx, io_path("none.ply"), NULL, &m) == BRIO_ERR_OPEN && !m);
    EXPECT(strstr(brio_message(io_ctx), "none.ply: No such file"), "%s", brio_message(io_ctx));
    EXPECT(brio_read(io_ctx, io_folder, &(brio_read_options){.format = BRIO_FORMAT_XYZ}, &m) == BRIO_ERR_OPEN && !m,
           "a folder");
    io_expect_error("a.what", "1 2 3\n", BRIO_ERR_FORMAT, "unknown format");
}

/* --- numbers --- */

static void expect_points(const char *name, const char *text, size_t count, size_t properties) {
    brio_mesh *m = io_read_text(name, text);
    if (!m) return;
    EXPECT(m->num_vertices == count && m->num_properties == properties, "%zu points, %zu properties: %.60s",
           m->num_vertices, m->num_properties, text);
    for (size_t i = 0; i < 3 * m->num_vertices; i++) EXPECT(m->vertices[i] == (double)(i + 1), "%.60s", text);
    brio_mesh_free(m);
}

static void xyz_separators_and_comments(void) {
    expect_points("a.xyz", "1 2 3\n4 5 6\n", 2, 0);
    expect_points("a.txt", "\xef\xbb\xbf\r\n# c\r\n1,2,3\r\n// c\r\n\r\n4;5;6", 2, 0);
    expect_points("a.csv", "1 , 2\t,3,\n%c\n;c\n  4\t5  6 # c\n7 8 9// c\n", 3, 0);
    expect_points("a.pts", "2\n1 2 3\n4 5 6\n", 2, 0);
    expect_points("a.pts", "# c\n 0 \n", 0, 0);
    expect_points("a.xyz", "", 0, 0);
    expect_points("a.xyz", "+1.0 2e0 .3E1 10\n4 5 6\n", 2, 1);
    expect_points("a.xyz", "1 2 3 10\n4 5 6 11 12\n", 2, 1);
    expect_points("a.xyz", "1 2 3 tree 10\n4 5 6 house 11\n", 2, 1);
}

static double value(const brio_mesh *m, const char *name, size_t i) {
    const brio_property *p = m ? brio_mesh_property(m, name) : NULL;
    EXPECT(p && p->type == BRIO_SCALAR_FLOAT64, "no %s", name);
    return p ? brio_property_value(p, i) : 0;
}

static void xyz_names_of_columns(void) {
    brio_mesh *m = io_read_text("a.csv", "\"Point ID\",Z,y,X,a b,\n7,3,2,1,8,\n9,6,5,4,8,\n");
    EXPECT(m && m->vertices[0] == 1 && m->vertices[5] == 6);
    EXPECT(value(m, "Point ID", 1) == 9 && value(m, "a b", 0) == 8 && m->num_properties == 2);
    brio_mesh_free(m);
    m = io_read_text("a.csv", "x,y,z,v\n1,2,3,\n4,5,6,7\n");
    EXPECT(isnan(value(m, "v", 0)) && value(m, "v", 1) == 7, "a comma at the end before an empty field");
    brio_mesh_free(m);
    m = io_read_text("a.csv", "x,y,z,v,w\n1,2,3,,1\n4,5,6,7,1\n");
    EXPECT(isnan(value(m, "v", 0)) && value(m, "v", 1) == 7, "an empty field");
    brio_mesh_free(m);
    m = io_read_text("a.csv", "x,y,z,v,w\n1,2,3,7,1\n4,5,6,7\n");
    EXPECT(m && m->num_properties == 2 && value(m, "v", 1) == 7, "a column that a row lacks");
    EXPECT(value(m, "w", 0) == 1 && isnan(value(m, "w", 1)), "was dropped with all its values");
    brio_mesh_free(m);
    m = io_read_text("a.csv", "x,y,z,v,kind\n1,2,3,NA,tree\n4,5,6,7,NA\n1,2,3,null,\n1,2,3,N/A,car\n");
    EXPECT(m && m->num_properties == 1 && value(m, "v", 1) == 7, "missing numbers");
    EXPECT(isnan(value(m, "v", 0)) && isnan(value(m, "v", 2)) && isnan(value(m, "v", 3)), "missing numbers");
    brio_mesh_free(m);
    m = io_read_text("a.txt", "x;y;z;v\n1,5;2;3;NA\n4;5;6;7,5\n");
    EXPECT(m && isnan(value(m, "v", 0)) && value(m, "v", 1) == 7.5, "missing numbers beside decimal commas");
    brio_mesh_free(m);
    m = io_read_text("a.txt", "//X Y Z Intensity\n1 2 3 4\n");
    EXPECT(value(m, "intensity", 0) == 4);
    brio_mesh_free(m);
    m = io_read_text("a.txt", "# made by x y z inc\n1 2 3 4\n");
    EXPECT(value(m, "column4", 0) == 4);
    brio_mesh_free(m);
    m = io_read_text("a.txt", "x lon y z lon\n1 9 2 3 4\n");
    EXPECT(value(m, "lon", 0) == 9 && value(m, "column5", 0) == 4 && m->vertices[2] == 3);
    brio_mesh_free(m);
}

static void xyz_errors_name_the_line(void) {
    io_expect_error("a.xyz", "1 2 3\n\n4 5\n", BRIO_ERR_FORMAT, "line 3: expected 3 numbers, found 2");
    io_expect_error("a.xyz", "1 2 3\n4 5 6x\n", BRIO_ERR_FORMAT, "line 2: expected a number, found \"6x\"");
    io_expect_error("a.xyz", "1 two 3\n", BRIO_ERR_FORMAT, "line 1: expected a number, found \"two\"");
    io_expect_error("a.csv", "1,,3\n", BRIO_ERR_FORMAT, "line 1: column 2 is empty");
    io_expect_error("a.csv", "1,NA,3\n", BRIO_ERR_FORMAT, "line 1: expected a number, found \"NA");
    io_expect_error("a.csv", "1,2,3,NA\n4,5,6,tree\n", BRIO_ERR_FORMAT, "line 2: expected a number, found \"tree\"");
    io_expect_error("a.xyz", "1 2 3 4\n4 5 6 \x01\x02\n", BRIO_ERR_FORMAT, "found \"\?\?\"");
    io_expect_error("a.pts", "3\n1 2 3\n4 5 6\n", BRIO_ERR_FORMAT, "line 1: promises 3 points, 2 rows follow");
    io_expect_error("a.pts", "1\n1 2 3\n4 5 6\n", BRIO_ERR_FORMAT, "line 1: promises 1 points, 2 rows follow");
    io_expect_error("a.xyz", "1 2\n", BRIO_ERR_FORMAT, "line 1: expected 3 numbers, found 2");
    io_expect_error("a.xyz", "1 2 3\nnan 0 0\n0 inf 0\n", BRIO_ERR_NOT_FINITE,
                    "point 1: x is NaN (2 such points in all)");
    io_expect_error("a.csv", "a,b,x,y,z\n1,2,3\n", BRIO_ERR_FORMAT, "line 2");
    brio_status status;
    brio_mesh *m = io_read_bytes("a.xyz", "1 2 3\n4 \0 6\n", 12, &status);
    EXPECT(status == BRIO_ERR_FORMAT && strstr(brio_message(io_ctx), "line 2: holds a byte 0"), "%s",
           brio_message(io_ctx));
    brio_mesh_free(m);
}

/* Lines across the ends of the buffer, and one longer than it. */
static void xyz_long_files(void) {
    size_t rows = 300000, used = 0;
    char *text = malloc(rows * 24 + (3 << 20));
    for (size_t i = 0; i < rows; i++) {
        used += (size_t)sprintf(text + used, "%zu %zu -%zu\n", i, i * 7, i % 13);
        if (i == 1000) {
            memset(text + used, '#', 3 << 20);
            used += 3 << 20;
            text[used++] = '\n';
        }
    }
    brio_status status;
    brio_mesh *m = io_read_bytes("long.xyz", text, used, &status);
    EXPECT(m && m->num_vertices == rows, "%s", brio_message(io_ctx));
    for (size_t i = 0; m && i < rows; i++)
        if (m->vertices[3 * i] != (double)i || m->vertices[3 * i + 1] != (double)(i * 7)) {
            EXPECT(0, "row %zu", i);
            break;
        }
    brio_mesh_free(m);
    free(text);
}

/* --- OBJ --- */

static void obj_statements(void) {
    brio_mesh *m = io_read_text(
        "a.obj", "# c\r\nmtllib x\ng a b\nv 0 0 0\nv 1 0 0 1.0\nv 1 \\\n1 0\nvn 0 0 1\nvt 0 0\n"
                 "f 1/1/1 2//1 3/2\nv 0 1 0 1 0.5 0.5\nf -4 -3 \\ \n -2 -1# c\nl 1 2\nusemtl \\\n f\nf 1 2 3");
    if (!m) return;
    EXPECT(m->num_vertices == 4 && m->vertices[7] == 1 && m->vertices[10] == 1);
    EXPECT(m->num_faces == 3 && m->face_offsets[3] == 10 && m->face_vertices[3] == 0 && m->face_vertices[6] == 3);
    brio_mesh_free(m);
}

static void obj_errors(void) {
    io_expect_error("a.obj", "v 1 2\n", BRIO_ERR_FORMAT, "line 1: expected a coordinate");
    io_expect_error("a.obj", "v 1 2 3\nf 1 1 2\n", BRIO_ERR_FORMAT,
                    "face 0 (counted from 0): index 2, expected one of the 1");
    io_expect_error("a.obj", "v 1 2 3\nf 1 0 1\n", BRIO_ERR_FORMAT, "face 0 (counted from 0): 0 is not");
    io_expect_error("a.obj", "v 1 2 3\nf 1 -2 1\n", BRIO_ERR_FORMAT, "face 0");
    io_expect_error("a.obj", "v 1 2 3\nf 1 a 1\n", BRIO_ERR_FORMAT, "line 2: expected a corner");
    io_expect_error("a.obj", "v 1 2 3\nf 1 99999999999999999999 1\n", BRIO_ERR_FORMAT, "line 2");
    io_expect_error("a.obj", "v 1 2 nan\n", BRIO_ERR_NOT_FINITE, "point 0: z is NaN");
}

/* --- OFF --- */

static void off_variants(void) {
    static const char *const texts[] = {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                                        "OFF 3 1 0\n\n0 0 0 # c\n1 0\n0\n0 1 0\n3 0 1\n2 255 0 0",
                                        "# c\nOFF # c\n3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 0.5 0.5 0.5\n",
                                        "3 1 0\n0 0 0 255 0 0\n1 0 0 9 9 9\n0 1 0 8 8 8\n3 0 1 2\n",
                                        "COFF\n3 1 0\n0 0 0 255 0 0\n1 0 0 9 9 9\n0 1 0 8 8 8\n3 0 1 2\n",
                                        ("STCNOFF\n3 1 0\n0 0 0 1 2 3 4 5 6 1 7 8\n1 0 0 1 2 3 4 5 6 1 7 8\n"
                                         "0 1 0 1 2 3 4 5 6 1 7 8\n3 0 1 2\n")};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        brio_mesh *m = io_read_text("a.off", texts[i]);
        if (!m) continue;
        EXPECT(m->num_vertices == 3 && m->vertices[3] == 1 && m->num_faces == 1 && m->face_vertices[2] == 2, "%s",
               texts[i]);
        EXPECT(m->num_properties == (i < 3 ? 0u : i < 5 ? 3u : 9u), "%s", texts[i]);
        if (i == 4) EXPECT(value(m, "red", 2) == 8);
        if (i == 5) EXPECT(value(m, "nz", 0) == 3 && value(m, "alpha", 0) == 1 && value(m, "t", 2) == 8);
        brio_mesh_free(m);
    }
    brio_mesh_free(io_read_text("any.txt", texts[0]));
}

static void off_errors(void) {
    io_expect_error("a.off", "4OFF\n", BRIO_ERR_FORMAT, "line 1");
    io_expect_error("a.off", "OFF BINARY\n", BRIO_ERR_FORMAT, "ends at byte 11");
    io_expect_error("a.off", "OFF\n3\n", BRIO_ERR_FORMAT, "ends at byte 6");
    io_expect_error("a.off", "OFF\n4000000000000 0 0\n", BRIO_ERR_FORMAT, "promises at least 20000000000000");
    io_expect_error("a.off", "OFF\n1 1 0\n0 0 0\n3 0 0 1\n", BRIO_ERR_FORMAT, "face 0 (counted from 0): index 1");
    io_expect_error("a.off", "OFF\n1 1 0\n0 0 0\n-3 0 0 1\n", BRIO_ERR_FORMAT, "the number of corners is -3");
    io_expect_error("a.off", "OFF\n2 0 0\n0 0 0      \n", BRIO_ERR_FORMAT, "in vertex 1 (counted from 0) of 2");
    io_expect_error("a.off", "NOFF\n2 0 0\n0 0 0 1 1 1\n0 0 0 1 1\n", BRIO_ERR_FORMAT, "line 4: 2 numbers behind");
}

/* --- rows beyond those that a file announces --- */

static void rows_too_many(void) {
    io_expect_error("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 9\n\n# c\n3 2 1 0\n", BRIO_ERR_FORMAT,
                    "line 9: a row behind face 1 of 1");
    io_expect_error("a.off", "OFF\n1 0 0\n0 0 0\n1 0 0\n", BRIO_ERR_FORMAT, "line 4: a row behind face 0 of 0");
    io_expect_error("a.node", "0 3 0 0\n0 0 0 0\n", BRIO_ERR_FORMAT, "line 2: a row behind point 0 of 0");
    io_expect_error("a.node", "1 3 0 0\n0 0 0 0\n1 0 0 0\n", BRIO_ERR_FORMAT, "line 3: a row behind point 1 of 1");
    io_expect_error("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                    "end_header\n0 0 0\n1 0 0\n",
                    BRIO_ERR_FORMAT, "line 9: a row behind vertex 1 of 1");
    brio_mesh_free(io_read_text("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 9 9\n# the end\n\n"));
    brio_mesh_free(io_read_text("a.node", "1 3 0 0\n0 0 0 0\n# Generated by a program\n"));
}

/* --- NODE and ELE --- */

static void node_with_attributes_and_tetrahedra(void) {
    io_empty_folder();
    io_put("n.ele", "# c\n1 10 1\n1 1 2 3 4 0 0 0 0 0 0 7\n", 35);
    brio_mesh *m = NULL;
    brio_status status = brio_read(io_ctx, io_path("n.ele"), NULL, &m);
    EXPECT(status == BRIO_ERR_OPEN && strstr(brio_message(io_ctx), "n.node"), "%s", brio_message(io_ctx));
    io_put("n.ele", "# c\n1 10 1\n1 1 2 3 4 1 1 1 1 1 1 7\n", 35);
    static const char node[] = "4 3 1 1\n1 0 0 0 0.5 1\n2 1 0 0 1.5 1 # c\n\n3 0 1 0 2.5 0\n4 0 0 1 3.5 -1\n";
    m = io_read_text("n.node", node);
    EXPECT(m && m->num_tetrahedra == 1 && m->tetrahedra[3] == 3, "the .ele beside");
    EXPECT(value(m, "attribute1", 2) == 2.5);
    const brio_property *marker = m ? brio_mesh_property(m, "boundary_marker") : NULL;
    EXPECT(marker && marker->type == BRIO_SCALAR_INT32 && brio_property_value(marker, 3) == -1);
    brio_mesh_free(m);
    EXPECT(brio_read(io_ctx, io_path("n.ele"), NULL, &m) == BRIO_OK && m->num_vertices == 4, "%s",
           brio_message(io_ctx));
    brio_mesh_free(m);
    m = io_read_text("zero.node", "2 3\n0 1 2 3\n1 4 5 6\n");
    EXPECT(m && m->num_vertices == 2 && m->num_properties == 0 && m->vertices[5] == 6);
    brio_mesh_free(m);
}

static void node_errors(void) {
    io_expect_error("a.node", "1 2 0 0\n1 0 0\n", BRIO_ERR_FORMAT, "2 dimensions, expected 3");
    io_expect_error("a.node", "2 3 0 0\n1 0 0 0\n3 0 0 0\n", BRIO_ERR_FORMAT, "line 3: expected row 2, found 3");
    io_expect_error("a.node", "2 3 0 0\n7 0 0 0\n8 0 0 0\n", BRIO_ERR_FORMAT, "line 2: expected row 0, found 7");
    io_expect_error("a.node", "2 3 0 0\n1 0 0 0 5\n2 0 0 0\n", BRIO_ERR_FORMAT, "line 2: expected the end of point 0");
    io_expect_error("a.node", "4000000000000 3 0 0\n", BRIO_ERR_FORMAT, "promises");
    io_expect_error("a.node", "0 3 9999999999 0\n", BRIO_ERR_FORMAT, "attributes");
    io_expect_error("a.node", "1 3 0 1\n1 0 0 0 0.5\n", BRIO_ERR_FORMAT, "line 2: boundary marker 0.5");
    io_put("b.ele", "1 4 0\n0 0 1 2 3\n", 16);
    io_expect_error("b.node", "2 3 0 0\n0 0 0 0\n1 0 0 0\n", BRIO_ERR_FORMAT, "b.ele: line 2: corner 2");
}

/* A text that broke off between facets was a smaller surface, and one in a single line an empty one. */
static void stl_ends_with_its_solid(void) {
    static const char facet[] =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    char text[400], upper[400];
    snprintf(text, sizeof text, "solid a\n%sendsolid a\nsolid b\n%sendsolid b\n", facet, facet);
    for (size_t i = 0; i <= strlen(text); i++) upper[i] = (char)toupper(text[i]);
    brio_mesh *m = io_read_text("a.stl", text), *same = io_read_text("a.stl", upper);
    EXPECT(m && m->num_faces == 2 && same && same->num_faces == 2);
    brio_mesh_free(m);
    brio_mesh_free(same);
    snprintf(text, sizeof text, "solid a\n%s", facet);
    io_expect_error("a.stl", text, BRIO_ERR_FORMAT, "expected facet or endsolid");
    io_expect_error(
        "a.stl",
        "solid a facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet endsolid\n",
        BRIO_ERR_FORMAT, "expected facet or endsolid");
}

/* --- blocks --- */

static int fail_inside(const brio_mesh *block, void *user) {
    brio_triangulation *t;
    double nowhere[3] = {0, NAN, 0};
    (void)block;
    return *(int *)user && brio_delaunay(io_ctx, nowhere, NULL, 1, NULL, &t) != BRIO_OK;
}

static int stop(const brio_mesh *block, void *user) {
    (void)block, (void)user;
    return 1;
}

/* The sentence of what had failed in the callback gave way to "cancelled". */
static void a_failure_in_a_callback_was_called_cancelled(void) {
    int fails = 1;
    io_put("a.xyz", "1 2 3\n", 6);
    EXPECT(brio_read_blocks(io_ctx, io_path("a.xyz"), NULL, fail_inside, &fails, NULL) == BRIO_ERR_CANCELLED);
    EXPECT(strstr(brio_message(io_ctx), "NaN"), "%s", brio_message(io_ctx));
    EXPECT(brio_read_blocks(io_ctx, io_path("a.xyz"), NULL, stop, NULL, NULL) == BRIO_ERR_CANCELLED);
    EXPECT(!strcmp(brio_message(io_ctx), "cancelled"), "%s", brio_message(io_ctx));
}

SUITE(test_io_text) {
    io_begin();
    RUN(stl_ends_with_its_solid);
    RUN(format_of_names);
    RUN(missing_files_and_unknown_formats);
    RUN(xyz_separators_and_comments);
    RUN(xyz_names_of_columns);
    RUN(xyz_errors_name_the_line);
    RUN(xyz_long_files);
    RUN(obj_statements);
    RUN(obj_errors);
    RUN(off_variants);
    RUN(off_errors);
    RUN(rows_too_many);
    RUN(node_with_attributes_and_tetrahedra);
    RUN(node_errors);
    RUN(a_failure_in_a_callback_was_called_cancelled);
    return io_end();
}
