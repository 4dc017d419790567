/* Texts of points: which columns are x, y and z; decimal commas; Fortran's exponents. Each error of the past has a test
 * with its name. */
#include "failing_allocator.h"
#include "io_files.h"

static double value(const brio_mesh *m, const char *name, size_t i) {
    const brio_property *p = m ? brio_mesh_property(m, name) : NULL;
    EXPECT(p, "no %s", name);
    return p ? brio_property_value(p, i) : 0;
}

/* Reads a text whose first point is 1.5 2.5 3.5, with a number of points and of properties. */
static void expect_first(const char *text, size_t count, size_t properties) {
    brio_mesh *m = io_read_text("a.txt", text);
    if (!m) return;
    EXPECT(m->num_vertices == count && m->num_properties == properties, "%zu points, %zu properties: %s",
           m->num_vertices, m->num_properties, text);
    EXPECT(m->vertices[0] == 1.5 && m->vertices[1] == 2.5 && m->vertices[2] == 3.5, "%g %g %g: %s", m->vertices[0],
           m->vertices[1], m->vertices[2], text);
    brio_mesh_free(m);
}

static brio_status read_as(const char *name, const char *text, const char *columns, brio_mesh **m) {
    brio_read_options o = {0};
    o.columns = columns;
    io_put(name, text, strlen(text));
    return brio_read(io_ctx, io_path(name), &o, m);
}

/* --- what is noted --- */

static brio_read_notes notes_of(const char *text, const char *columns) {
    brio_read_notes notes = {0};
    brio_read_options o = {0};
    brio_mesh *m = NULL;
    o.columns = columns;
    o.notes = &notes;
    io_put("n.xyz", text, strlen(text));
    EXPECT(brio_read(io_ctx, io_path("n.xyz"), &o, &m) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_mesh_free(m);
    return notes;
}

/* The output of voro++, id x y z, was read as coordinates without a word. */
static void numbers_of_rows_were_read_as_x_without_a_word(void) {
    static const char ids[] = "1 .1 .2 .3\n2 .5 .6 .1\n3 .9 .1 .7\n4 .3 .8 .9\n5 .5 .5 .5\n";
    EXPECT(notes_of(ids, NULL).numbered && notes_of("3 0 0 1\n0 1 0 1\n2 0 1 1\n1 1 1 0\n", NULL).numbered);
    EXPECT(!notes_of(ids, "-,x,y,z").numbered &&
           !notes_of("x y z w\n1 0 0 1\n2 0 1 1\n3 0 0 1\n4 1 0 1\n", NULL).numbered);
    EXPECT(!notes_of("1 0 0\n2 0 1\n3 0 0\n4 1 0\n", NULL).numbered);
    EXPECT(!notes_of("1 0 0 1\n1 0 1 1\n4 0 0 1\n4 1 0 1\n", NULL).numbered);
    EXPECT(!notes_of("1 0 0 1\n2 0 1 1\n3 0 0 1\n", NULL).numbered);
}

/* Numbers such as 9007199254740993 lost a bit in silence. */
static void whole_numbers_that_doubles_do_not_hold_are_counted(void) {
    brio_read_notes n = notes_of("x y z id\n0 0 0 7\n1 0 0 9007199254740993\n0 1 0 -36028797018963969\n", NULL);
    EXPECT(n.rounded == 2 && n.rounded_line == 3 && !strcmp(n.rounded_column, "id"), "%s", n.rounded_column);
    n = notes_of("0 0 0\n0 99999999999999999999999 0\n", NULL);
    EXPECT(n.rounded == 1 && n.rounded_line == 2 && !strcmp(n.rounded_column, "y"));
    n = notes_of("0 0 0 9007199254740992\n0 0 1 -18446744073709551616\n1 0 0 1e300\n0 1 0 9007199254740993.5\n"
                 "18014398509481984 0 0 9007199254740991\n",
                 NULL);
    EXPECT(n.rounded <= 1, "%d", (int)n.rounded);
    EXPECT(notes_of("0 0 0 9007199254740993\n", "x,y,z,-").rounded == 0);
}

/* --- names --- */

static void header_with_id_lat_lon_alt_read_the_id_as_x(void) {
    static const char text[] = "id,lat,lon,alt\n1,48.1,11.5,520\n2,48.2,11.6,530\n";
    io_expect_error("a.csv", text, BRIO_ERR_FORMAT, "line 1: latitude and longitude are angles, not lengths");
    EXPECT(strstr(brio_message(io_ctx), "--columns x,y,z,-"), "%s", brio_message(io_ctx));
    EXPECT(strstr(brio_message(io_ctx), "begins \"id,lat,lon,alt\", \"1,48.1,11.5,520\""), "%s", brio_message(io_ctx));
    io_expect_error("a.csv", "# lat lon alt\n48.1 11.5 520\n", BRIO_ERR_FORMAT, "angles");
    brio_mesh *m = NULL;
    EXPECT(read_as("a.csv", text, "-,y,x,z", &m) == BRIO_OK && m->num_vertices == 2, "%s", brio_message(io_ctx));
    EXPECT(m && m->vertices[0] == 11.5 && m->vertices[1] == 48.1 && m->vertices[2] == 520 && !m->num_properties);
    brio_mesh_free(m);
}

static void names_of_surveyors_and_programs(void) {
    static const char *const same[] = {"x y z\n1.5 2.5 3.5\n",
                                       "//X,Y,Z\n1.5,2.5,3.5\n",
                                       "X [m];Y [m];Z [m]\n1.5;2.5;3.5\n",
                                       "easting northing elevation\n1.5 2.5 3.5\n",
                                       "Northing,Easting,Height\n2.5,1.5,3.5\n",
                                       "# N E H\n2.5 1.5 3.5\n",
                                       "x,y,altitude\n1.5,2.5,3.5\n",
                                       "X_coord Y_coord Z_coord\n1.5 2.5 3.5\n",
                                       "\"Points:0\",\"Points:1\",\"Points:2\"\n1.5,2.5,3.5\n",
                                       "Hochwert;Rechtswert;H\xc3\xb6he\n2,5;1,5;3,5\n",
                                       "Hochwert;Rechtswert;H\xf6he\n2.5;1.5;3.5\n",
                                       "# made by a program\n# x y z\n# and more words\n1.5 2.5 3.5\n",
                                       "# x y z\n1\n1.5 2.5 3.5\n"};
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) expect_first(same[i], 1, 0);
    expect_first("id lat lon easting northing elev\n7 48 11 1.5 2.5 3.5\n", 1, 3);
    expect_first("height z y x\n9 3.5 2.5 1.5\n", 1, 1);
    expect_first("x,y,z,450,550\n1.5,2.5,3.5,1,2\n", 1, 2);
    expect_first("# made by x y z inc\n1.5 2.5 3.5 1\n", 1, 1);
    expect_first("# x y z\n1.5 2.5 3.5 1\n", 1, 1);
    expect_first("x y z x[m] y# z(gps) -x\n1.5 2.5 3.5 4 5 6 7\n", 1, 4);
    expect_first("//X,Y,Z,x[m],#y\n1.5,2.5,3.5,4,5\n", 1, 2);
    expect_first("# x y z 450 550\n1.5 2.5 3.5 1 2\n", 1, 2);
    expect_first("# x z y x in words\n1.5 2.5 3.5\n", 1, 0);
    expect_first("# x y z nx\n# of something else\n1.5 2.5 3.5 1\n", 1, 1);
}

static void names_with_marks_of_comments_are_whole(void) {
    static const char *const files[] = {"x,y,z,Humidity %,c#1,a//b,\"d # e\"\n1,2,3,4,5,6,7\n",
                                        "x,y,z,c#1,a//b,d,Humidity %\n1,2,3,5,6,7,4 % note\n"};
    static const char *const names[2][4] = {{"Humidity %", "c#1", "a//b", "d # e"}, {"c#1", "a//b", "d", "Humidity %"}};
    for (size_t k = 0; k < 2; k++) {
        brio_mesh *m = io_read_text("a.csv", files[k]);
        EXPECT(m && m->num_properties == 4, "%s", brio_message(io_ctx));
        for (size_t i = 0; m && i < 4; i++)
            EXPECT(!strcmp(m->properties[i].name, names[k][i]), "%s", m->properties[i].name);
        brio_mesh_free(m);
    }
}

static void names_that_do_not_decide_are_errors(void) {
    io_expect_error("a.txt", "a b c\n1 2 3\n", BRIO_ERR_FORMAT, "line 1: the names do not say");
    io_expect_error("a.txt", "id x y\n1 2 3\n", BRIO_ERR_FORMAT, "the names do not say");
    io_expect_error("a.txt", "x x y z\n1 2 3 4\n", BRIO_ERR_FORMAT, "several columns have a name of x, y or z");
    io_expect_error("a.txt", "//X,Y,Z,x\n1,2,3,4\n", BRIO_ERR_FORMAT, "several columns");
    io_expect_error("a.txt", "X[m],Y[m],Z[m],x(gps)\n1,2,3,4\n", BRIO_ERR_FORMAT, "several columns");
    io_expect_error("a.txt", "x,y,height,elevation\n1,2,3,4\n", BRIO_ERR_FORMAT, "several columns");
    io_expect_error("a.txt", "easting northing e n z\n1 2 3 4 5\n", BRIO_ERR_FORMAT, "several columns");
    io_expect_error("a.txt", "# id x y z name\n7 1 2 3\n", BRIO_ERR_FORMAT, "line 1: a comment names columns");
    io_expect_error("a.txt", "# id x y z x\n7 1 2 3 4\n", BRIO_ERR_FORMAT, "several columns");
    io_expect_error("a.txt", "# id x y z\n7 1 2 3 4\n", BRIO_ERR_FORMAT, "a comment names columns");
}

/* x was the thousands of a number, or the number of a row. */
/* The number of a point's name was a column of its own, and all others were one place too far. */
static void names_of_points_with_a_number_are_one_field(void) {
    expect_first("Punkt;Rechtswert;Hochwert;H\xc3\xb6he [m]\nA 1;1,5;2,5;3,5\nA 2;4;5;6\n", 2, 0);
    expect_first("name;x;y;z\nA 1;1.5;2.5;3.5\nB;4;5;6\n", 2, 0);
}

static void more_columns_than_names_are_errors(void) {
    io_expect_error("a.txt", "x;y;z\n1.234,5;2.345,6;12,5\n", BRIO_ERR_FORMAT, "line 2: 6 columns, but line 1 names 3");
    io_expect_error("a.csv", "x,y,z\n1,234.5,2,3\n", BRIO_ERR_FORMAT, "line 2: 4 columns, but line 1 names 3");
    io_expect_error("a.txt", "x y z\n1 1.5 2.5 3.5\n", BRIO_ERR_FORMAT, "line 2: 4 columns, but line 1 names 3");
    expect_first("x,y,z\n1.5,2.5,3.5,,\n", 1, 0);
}

static void words_between_rows_are_errors(void) {
    io_expect_error("a.txt", "x y z\n1 2 3\nx y z\n4 5 6\n", BRIO_ERR_FORMAT, "line 3: expected a number, found \"x\"");
    io_expect_error("a.txt", "1 2 3\nend of scan\n", BRIO_ERR_FORMAT, "line 2: expected a number, found \"end\"");
    io_expect_error("a.txt", "x y z\nx y z\n", BRIO_ERR_FORMAT, "line 2");
    io_expect_error("a.txt", "6x\n1 2 3\n", BRIO_ERR_FORMAT, "line 1");
}

/* --- names from the caller --- */

static void columns_by_the_caller(void) {
    brio_mesh *m = NULL;
    EXPECT(read_as("a.txt", "P1 1 2 3 0.5 oak\nP2 4 5 6 1.5 elm\n", "_,z, y ,X,value", &m) == BRIO_OK, "%s",
           brio_message(io_ctx));
    EXPECT(m && m->vertices[0] == 3 && m->vertices[5] == 4 && m->num_properties == 1 && value(m, "value", 1) == 1.5);
    brio_mesh_free(m);
    EXPECT(read_as("a.csv", "easting,northing,elev\n1,2,3\n", "y,x,z", &m) == BRIO_OK && m->vertices[0] == 2);
    brio_mesh_free(m);
    EXPECT(read_as("a.csv", "x;y;z\n1,5;2,5;3,5\n", "x,y,z", &m) == BRIO_OK && m->vertices[0] == 1.5);
    brio_mesh_free(m);
    EXPECT(read_as("a.csv", "x,y,z,w\n1,2,3,\n4,5,6,7\n", "x,y,z,w", &m) == BRIO_OK && isnan(value(m, "w", 0)));
    brio_mesh_free(m);
}

static void wrong_columns_by_the_caller(void) {
    static const struct {
        const char *columns, *part;
    } wrong[] = {{"x,y", "z is missing"},
                 {"", "a name of 0 characters"},
                 {"x,y,z,", "a name of 0 characters"},
                 {"x,y,z,x", "x is there twice"},
                 {"x,y,z,a,a", "a is there twice"}};
    brio_mesh *m;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        EXPECT(read_as("a.txt", "1 2 3\n", wrong[i].columns, &m) == BRIO_ERR_ARGUMENT && !m &&
                   strstr(brio_message(io_ctx), wrong[i].part),
               "%s: %s", wrong[i].columns, brio_message(io_ctx));
    EXPECT(read_as("a.txt", "1 2 3\n", "-,x,y,z", &m) == BRIO_ERR_FORMAT &&
           strstr(brio_message(io_ctx), "line 1: 3 col"));
    EXPECT(read_as("a.txt", "1 2 3 oak\n", "x,y,z,w", &m) == BRIO_ERR_FORMAT &&
           strstr(brio_message(io_ctx), "\"oak\""));
    EXPECT(read_as("a.obj", "v 1 2 3\n", "x,y,z", &m) == BRIO_ERR_ARGUMENT && !m);
    EXPECT(strstr(brio_message(io_ctx), "only texts of points"), "%s", brio_message(io_ctx));
}

/* --- numbers --- */

static void decimal_commas_read_1_5_2(void) {
    expect_first("1,5;2,5;3,5\n4,5;5,5;6,5\n", 2, 0);
    expect_first("1,5\t2,5\t3,5\n", 1, 0);
    expect_first("1,5 2,5 3,5 -0,25E+01 7\n", 1, 2);
    expect_first("x;y;z;name\n1,5;2,5;3,5;Main St\n4;5;6;Oak\n", 2, 0);
    expect_first("x;y;z;v\n1,5;2,5;3,5;\n", 1, 1);
    brio_mesh *m = io_read_text("a.csv", "1;2;3\n4,5;5;6\n");
    EXPECT(m && m->vertices[0] == 1 && m->vertices[3] == 4.5 && m->vertices[5] == 6, "commas from the second row on");
    brio_mesh_free(m);
    m = io_read_text("a.csv", "4453021,123;5332123,456;512,789\n");
    EXPECT(m && m->vertices[0] == 4453021.123 && m->vertices[2] == 512.789);
    brio_mesh_free(m);
    m = io_read_text("a.csv", "1,5D+02 2,5d-1 3\n");
    EXPECT(m && m->vertices[0] == 150 && m->vertices[1] == 0.25 && m->vertices[2] == 3);
    brio_mesh_free(m);
}

static void commas_that_separate_stay(void) {
    expect_first("1.5,2.5,3.5\n", 1, 0);
    expect_first("1.5, 2.5, 3.5\n", 1, 0);
    expect_first("1.5 , 2.5\t,3.5,\n", 1, 0);
    expect_first("1.5,2.5,3.5 255 0 0\n", 1, 3);
    expect_first("1.5,2.5,3.5;1,2,3\n", 1, 3);
    expect_first("1.5,2.5,3.5,2020-01-01 12:00:00,5\n1,2,3,today,5\n", 2, 1);
    expect_first("x,y,z,street,v\n1.5,2.5,3.5,Main St,5\n1,2,3,Oak,5\n", 2, 1);
    brio_mesh *m = io_read_text("a.csv", "1,2,3\n4,5,6\n");
    EXPECT(m && m->num_vertices == 2 && m->vertices[4] == 5 && m->num_properties == 0);
    brio_mesh_free(m);
}

static void commas_that_could_be_either_are_errors(void) {
    io_expect_error("a.txt", "1,5 2\n", BRIO_ERR_FORMAT, "line 1: its commas may be decimal");
    io_expect_error("a.txt", "512,345.12 5,412,345.67 312.4\n", BRIO_ERR_FORMAT, "mark thousands");
    io_expect_error("a.txt", "1,5 2.5 3,5\n", BRIO_ERR_FORMAT, "line 1: its commas may");
    io_expect_error("a.txt", "1.5 2.5 3.5\n1,5 2,5 3,5\n", BRIO_ERR_FORMAT, "line 2: its commas seem to be decimal");
    io_expect_error("a.txt", "1,2,3\n1,5;2,5;3,5\n", BRIO_ERR_FORMAT, "since line 1 a comma separates");
    io_expect_error("a.txt", "1,5;2,5;3,5\n1,5;2.5;3,5\n", BRIO_ERR_FORMAT, "line 2: expected a number, found \"2.5");
    io_expect_error("a.txt", "1,5;2,5;3,5\n1,2,3;2;3\n", BRIO_ERR_FORMAT, "line 2: expected a number, found \"1,2,3");
}

static void first_row_with_fortran_exponents_counted_as_names(void) {
    expect_first("1.5D+00 25.0d-1 .35D1\n1.0D+00 2.0D+00 3.0D+00\n", 2, 0);
    brio_mesh *m = io_read_text("a.xyz", "1.00000000000000000000000D+300 -1D-400 0.1d0\n");
    EXPECT(m && m->vertices[0] == 1e300 && m->vertices[1] == 0 && m->vertices[2] == 0.1);
    brio_mesh_free(m);
    m = io_read_text("a.xyz", "1 2 3 4D\n5 6 7 8D\n");
    EXPECT(m && m->num_properties == 0, "4D is a word");
    brio_mesh_free(m);
}

/* --- damage --- */

static const char *const texts[] = {"Punkt;Rechtswert;Hochwert;H\xc3\xb6he [m]\nA 1;1,5;2,5;3,5\nA 2;4;5;6\n",
                                    "# id x y z\n7 1.5 2.5 3.5\n8 1D0 2 3\n", "id,lat,lon,alt\n1,48.1,11.5,520\n"};

static void every_prefix_and_changed_byte(void) {
    uint64_t state = 9;
    for (size_t k = 0; k < 3; k++) {
        size_t size = strlen(texts[k]);
        char *bytes = strdup(texts[k]);
        for (size_t n = 0; n < size; n++) brio_mesh_free(io_expect_sane("a.csv", bytes, n, "prefix", n));
        for (size_t i = 0; bytes && i < 8 * size; i++) {
            char old = bytes[i / 8];
            bytes[i / 8] = i % 2 ? ",;. \t\"#D"[i / 2 % 4 + 4 * (i % 8 > 4)] : (char)(io_random(&state) & 127);
            brio_mesh_free(io_expect_sane("a.csv", bytes, size, "byte", i));
            bytes[i / 8] = old;
        }
        free(bytes);
    }
}

static brio_status read_with_columns(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_read_options o = {0};
    o.columns = "-,x,y,z";
    brio_status status = brio_read(ctx, io_path("a.csv"), &o, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static brio_status read_by_names(brio_context *ctx) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_read(ctx, io_path("a.csv"), NULL, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static void each_allocation_fails(void) {
    io_put("a.csv", texts[0], strlen(texts[0]));
    expect_clean_failures(read_with_columns);
    expect_clean_failures(read_by_names);
}

SUITE(test_io_columns) {
    io_begin();
    RUN(numbers_of_rows_were_read_as_x_without_a_word);
    RUN(whole_numbers_that_doubles_do_not_hold_are_counted);
    RUN(header_with_id_lat_lon_alt_read_the_id_as_x);
    RUN(names_of_surveyors_and_programs);
    RUN(names_with_marks_of_comments_are_whole);
    RUN(names_that_do_not_decide_are_errors);
    RUN(names_of_points_with_a_number_are_one_field);
    RUN(more_columns_than_names_are_errors);
    RUN(words_between_rows_are_errors);
    RUN(columns_by_the_caller);
    RUN(wrong_columns_by_the_caller);
    RUN(decimal_commas_read_1_5_2);
    RUN(commas_that_separate_stay);
    RUN(commas_that_could_be_either_are_errors);
    RUN(first_row_with_fortran_exponents_counted_as_names);
    RUN(every_prefix_and_changed_byte);
    RUN(each_allocation_fails);
    return io_end();
}
