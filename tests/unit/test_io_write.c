/* Writing: what is written reads back with the same bits in each format; files appear complete or not at all. */
#define _GNU_SOURCE
#include "io_files.h"
#include <fcntl.h>

static brio_mesh *write_and_read(const brio_mesh *mesh, const char *name, brio_write_options options) {
    brio_mesh *back = NULL;
    brio_status status = brio_write(io_ctx, io_path(name), mesh, &options);
    EXPECT(status == BRIO_OK, "%s: %s", name, brio_message(io_ctx));
    status = brio_read(io_ctx, io_path(name), NULL, &back);
    EXPECT(status == BRIO_OK, "%s: %s", name, brio_message(io_ctx));
    EXPECT(io_count_files(".part-") == 0, "a temporary file is left");
    return back;
}

/* values: properties as doubles, for formats that keep no types. */
static void expect_properties(const brio_mesh *a, const brio_mesh *b, bool types) {
    EXPECT(a->num_properties == b->num_properties, "%zu and %zu", a->num_properties, b->num_properties);
    for (size_t i = 0; i < a->num_properties && i < b->num_properties; i++) {
        const brio_property *p = &a->properties[i], *q = &b->properties[i];
        if (types) {
            EXPECT(!strcmp(p->name, q->name) && p->type == q->type, "%s %s", p->name, q->name);
            EXPECT(io_same_bytes(p->data, q->data, a->num_vertices * brio_scalar_size(p->type)), "%s", p->name);
            continue;
        }
        for (size_t v = 0; v < a->num_vertices; v++)
            EXPECT(p->type == BRIO_SCALAR_FLOAT32 ? (float)brio_property_value(q, v) == (float)brio_property_value(p, v)
                                                  : brio_property_value(q, v) == brio_property_value(p, v),
                   "%s of point %zu", p->name, v);
    }
}

static void check_ply(int parts, int ascii, int float32) {
    brio_write_options options = {0};
    options.ascii = ascii;
    options.float32 = float32;
    options.comment = "two\nlines";
    brio_mesh *mesh = io_make(1000, parts), *back = write_and_read(mesh, "a.ply", options);
    if (back) {
        EXPECT(io_same_points(mesh, back), "parts %d ascii %d float32 %d", parts, ascii, float32);
        EXPECT(io_same_faces(mesh, back), "parts %d ascii %d", parts, ascii);
        EXPECT(io_same_tetrahedra(mesh, back), "parts %d ascii %d", parts, ascii);
        expect_properties(mesh, back, true);
    }
    brio_mesh_free(mesh);
    brio_mesh_free(back);
}

static void ply_reads_back(void) {
    for (int ascii = 0; ascii < 2; ascii++) {
        for (int parts = 0; parts < 16; parts++) check_ply(parts, ascii, 0);
        check_ply(IO_SINGLE | IO_FACES | IO_PROPERTIES, ascii, 1);
    }
}

static void vtu_reads_back(void) {
    brio_write_options options = {0};
    options.comment = "-- > <";
    for (int parts = 0; parts < 32; parts++) {
        options.float32 = parts >= IO_SINGLE;
        brio_mesh *mesh = io_make(700, parts), *back = write_and_read(mesh, "a.vtu", options);
        if (back) {
            EXPECT(io_same_points(mesh, back) && io_same_faces(mesh, back) && io_same_tetrahedra(mesh, back),
                   "parts %d", parts);
            expect_properties(mesh, back, true);
        }
        brio_mesh_free(mesh);
        brio_mesh_free(back);
    }
}

static void texts_read_back(void) {
    static const struct {
        const char *name;
        int parts;
        bool properties;
    } cases[] = {{"a.xyz", IO_PROPERTIES, true},
                 {"a.csv", IO_PROPERTIES, true},
                 {"a.pts", 0, true},
                 {"a.obj", IO_FACES, false},
                 {"b.obj", IO_BIG_FACE, false},
                 {"a.off", IO_FACES, false},
                 {"b.off", IO_BIG_FACE, false},
                 {"c.off", 0, false},
                 {"a.node", IO_PROPERTIES, true},
                 {"b.node", IO_TETRAHEDRA | IO_PROPERTIES, true},
                 {"c.ele", IO_TETRAHEDRA, true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        brio_mesh *mesh = io_make(500, cases[i].parts);
        brio_write_options options = {0};
        options.comment = "a comment";
        brio_mesh *back = write_and_read(mesh, cases[i].name, options);
        if (back) {
            EXPECT(io_same_points(mesh, back), "%s", cases[i].name);
            EXPECT(io_same_faces(mesh, back), "%s", cases[i].name);
            EXPECT(io_same_tetrahedra(mesh, back), "%s", cases[i].name);
            if (cases[i].properties) expect_properties(mesh, back, false);
        }
        brio_mesh_free(mesh);
        brio_mesh_free(back);
    }
}

static void empty_mesh_reads_back(void) {
    static const char *const names[] = {"e.ply", "e.xyz", "e.obj", "e.off", "e.vtu", "e.node"};
    for (size_t i = 0; i < 6; i++) {
        brio_mesh *mesh = io_make(0, 0), *back = write_and_read(mesh, names[i], (brio_write_options){0});
        EXPECT(back && back->num_vertices == 0 && !back->vertices && !back->face_offsets && !back->tetrahedra, "%s",
               names[i]);
        brio_mesh_free(mesh);
        brio_mesh_free(back);
    }
}

/* New points without tetrahedra must not be read with the tetrahedra of the old ones. */
static void node_replaces_old_tetrahedra(void) {
    brio_mesh *old = io_make(50, IO_TETRAHEDRA), *new = io_make(40, 0);
    brio_mesh_free(write_and_read(old, "r.node", (brio_write_options){0}));
    brio_mesh *back = write_and_read(new, "r.node", (brio_write_options){0});
    EXPECT(back && back->num_vertices == 40 && back->num_tetrahedra == 0);
    brio_mesh_free(old);
    brio_mesh_free(new);
    brio_mesh_free(back);
}

static void property_names_become_words(void) {
    brio_mesh *mesh = io_make(5, 0);
    void *data;
    EXPECT(brio_mesh_add_property(mesh, "two words,\n", BRIO_SCALAR_INT32, &data) == BRIO_OK);
    brio_mesh *ply = write_and_read(mesh, "n.ply", (brio_write_options){0});
    brio_mesh *vtu = write_and_read(mesh, "n.vtu", (brio_write_options){0});
    EXPECT(ply && brio_mesh_property(ply, "two_words__"));
    EXPECT(vtu && vtu->num_properties == 1);
    brio_mesh_free(mesh);
    brio_mesh_free(ply);
    brio_mesh_free(vtu);
}

static bool is_in_file(const char *name, const char *part) {
    size_t size;
    char *bytes = io_get(name, &size);
    bool found = bytes && memmem(bytes, size, part, strlen(part));
    free(bytes);
    return found;
}

/* A name of Latin-1 made files that parsers of XML, JSON and NumPy refuse. */
static void names_are_utf8_in_every_format(void) {
    static const char *const files[] = {"u.ply", "u.csv", "u.vtu", "u.vtp", "u.glb", "u.npy"};
    static const char ply[] =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\n"
        "property double z\nproperty int h\xf6he\nproperty int \xe2\x82\xac\xe2\x82\nend_header\n1 2 3 4 5\n";
    brio_mesh *mesh = io_read_text("u.ply", ply);
    EXPECT(mesh && mesh->num_properties == 2 && !strcmp(mesh->properties[0].name, "h\xc3\xb6he"));
    EXPECT(!strcmp(mesh->properties[1].name, "\xe2\x82\xac\xc3\xa2\xc2\x82"), "%s", mesh->properties[1].name);
    EXPECT(brio_mesh_property(mesh, "h\xf6he") && brio_mesh_property(mesh, "h\xc3\xb6he"));
    EXPECT(brio_mesh_add_property(mesh, "h\xf6he", BRIO_SCALAR_INT8, NULL) == BRIO_ERR_ARGUMENT);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        EXPECT(brio_write(io_ctx, io_path(files[i]), mesh, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(is_in_file(files[i], "h\xc3\xb6he"), "%s", files[i]);
    }
    brio_mesh_free(mesh);
}

/* Names that become one word, each longer than fits behind it a number, and of characters of two bytes. */
static void numbered_names_are_whole_characters(void) {
    brio_mesh *mesh = io_make(5, 0);
    char name[64] = "";
    for (size_t i = 0; i < 31; i++) strcat(name, "\xc3\xb6");
    for (char last = 1; last < 13; last++) {
        name[62] = last;
        EXPECT(brio_mesh_add_property(mesh, name, BRIO_SCALAR_INT32, NULL) == BRIO_OK);
    }
    static const char *const files[] = {"m.ply", "m.vtu", "m.npy"};
    for (size_t k = 0; k < 3; k++) {
        brio_mesh *again = write_and_read(mesh, files[k], (brio_write_options){0});
        EXPECT(again && again->num_properties == 12, "%s", files[k]);
        for (size_t i = 0; again && i < 12; i++)
            EXPECT(!strstr(again->properties[i].name, "\xc3\x83"), "%s: %s", files[k], again->properties[i].name);
        brio_mesh_free(again);
    }
    brio_mesh_free(mesh);
}

/* A text's line of names ended at # or %, and took "x[m]" for another x. */
static void names_that_texts_take_for_something_else(void) {
    static const char *const names[][2] = {{"x[m]", "x[m]"}, {"slope %", "slope__"}, {"z#1", "z_1"}, {"a//b", "a_/b"},
                                           {"m/s", "m/s"},   {"450", "450"},         {"#y-", "_y-"}, {"y", "y_2"}};
    static const char *const files[] = {"a.xyz", "a.csv"};
    size_t count = sizeof names / sizeof *names;
    brio_mesh *mesh = io_make(5, 0);
    for (size_t i = 0; i < count; i++)
        EXPECT(brio_mesh_add_property(mesh, names[i][0], BRIO_SCALAR_FLOAT64, NULL) == BRIO_OK);
    for (size_t k = 0; k < 2; k++) {
        brio_mesh *again = write_and_read(mesh, files[k], (brio_write_options){0});
        EXPECT(again && again->num_properties == count, "%s", brio_message(io_ctx));
        for (size_t i = 0; again && i < count; i++)
            EXPECT(!strcmp(again->properties[i].name, names[i][1]), "%s: %s", files[k], again->properties[i].name);
        brio_mesh_free(again);
    }
    brio_mesh_free(mesh);
}

static void refuse_what_the_format_cannot_hold(void) {
    static const char *const names[] = {"t.obj", "t.off", "t.xyz", "t.csv", "t.unknown", "-"};
    brio_mesh *mesh = io_make(10, IO_TETRAHEDRA);
    for (size_t i = 0; i < 6; i++) {
        EXPECT(brio_write(io_ctx, io_path(names[i]), mesh, NULL) == BRIO_ERR_ARGUMENT, "%s", names[i]);
        EXPECT(io_count_files("t.") == 0, "%s", names[i]);
    }
    EXPECT(brio_write(io_ctx, "-", mesh, NULL) == BRIO_ERR_ARGUMENT, "standard output without a format");
    brio_write_options options = {0};
    options.format = BRIO_FORMAT_NODE;
    EXPECT(brio_write(io_ctx, "-", mesh, &options) == BRIO_ERR_ARGUMENT, "two files");
    mesh->vertices[4] = 1e300;
    options = (brio_write_options){.size = sizeof(brio_write_options), .float32 = 1};
    EXPECT(brio_write(io_ctx, io_path("t.ply"), mesh, &options) == BRIO_ERR_ARGUMENT);
    EXPECT(strstr(brio_message(io_ctx), "point 1 "), "%s", brio_message(io_ctx));
    brio_mesh_free(mesh);
}

/* A LAS file had a number in the place of NaN; files of all other formats, none of which brio reads. */
static void coordinates_that_are_no_numbers_are_refused(void) {
    static const char *const names[] = {"n.ply", "n.xyz",  "n.csv", "n.obj", "n.off", "n.vtu",
                                        "n.vtp", "n.node", "n.las", "n.stl", "n.npy", "n.glb"};
    static const double wrong[] = {NAN, INFINITY, -INFINITY};
    io_empty_folder();
    for (size_t i = 0; i < 3 * sizeof names / sizeof *names; i++) {
        const char *name = names[i / 3];
        brio_mesh *mesh = io_make(10, IO_FACES | IO_SINGLE);
        brio_write_options options = {0};
        double moved = -1;
        options.moved = &moved;
        options.float32 = i % 2;
        mesh->vertices[3 * 7 + 1] = wrong[i % 3];
        mesh->vertices[3 * 8] = NAN;
        EXPECT(brio_write(io_ctx, io_path(name), mesh, &options) == BRIO_ERR_NOT_FINITE, "%s: %g", name, wrong[i % 3]);
        EXPECT(strstr(brio_message(io_ctx), name) && strstr(brio_message(io_ctx), "point 7: y is ") &&
                   strstr(brio_message(io_ctx), "2 such points in all"),
               "%s", brio_message(io_ctx));
        EXPECT(io_count_files("n.") == 0 && moved == 0, "%s: moved %g", name, moved);
        brio_mesh_free(mesh);
        io_empty_folder();
    }
}

static void full_disk_is_a_status(void) {
    if (access("/dev/full", W_OK) != 0) return;
    brio_mesh *mesh = io_make(100000, 0);
    brio_write_options options = {0};
    options.format = BRIO_FORMAT_PLY;
    EXPECT(brio_write(io_ctx, "/dev/full", mesh, &options) == BRIO_ERR_WRITE);
    EXPECT(strstr(brio_message(io_ctx), "/dev/full: No space left on device"), "%s", brio_message(io_ctx));
    brio_mesh_free(mesh);
}

static void unwritable_folder_is_a_status(void) {
    brio_mesh *mesh = io_make(10, 0);
    EXPECT(brio_write(io_ctx, io_path("no/such/folder/a.ply"), mesh, NULL) == BRIO_ERR_WRITE);
    EXPECT(brio_write(io_ctx, io_folder, mesh,
                      &(brio_write_options){.size = sizeof(brio_write_options), .format = BRIO_FORMAT_PLY}) ==
           BRIO_ERR_WRITE);
    brio_mesh_free(mesh);
}

static int cancel(const char *stage, double fraction, void *user) {
    EXPECT(fraction >= 0 && fraction <= 1, "%s %g", stage, fraction);
    return --*(int *)user < 0;
}

/* Cancelled at each report in turn, a write leaves the old file and nothing else. */
static void cancelled_write_leaves_the_old_file(void) {
    brio_mesh *old = io_make(10, 0), *new = io_make(100000, IO_PROPERTIES), *back = NULL;
    EXPECT(brio_write(io_ctx, io_path("c.ply"), old, NULL) == BRIO_OK);
    int allowed = 0, reports = 0;
    for (;; allowed++) {
        reports = allowed;
        brio_context_set_progress(io_ctx, cancel, &reports);
        brio_status status = brio_write(io_ctx, io_path("c.ply"), new, NULL);
        brio_context_set_progress(io_ctx, NULL, NULL);
        if (status == BRIO_OK) break;
        EXPECT(status == BRIO_ERR_CANCELLED, "status %d", (int)status);
        EXPECT(io_count_files(".part-") == 0);
        EXPECT(brio_read(io_ctx, io_path("c.ply"), NULL, &back) == BRIO_OK && back->num_vertices == 10);
        brio_mesh_free(back);
    }
    EXPECT(allowed >= 5, "only %d reports for 5 MB", allowed);
    reports = 2;
    brio_context_set_progress(io_ctx, cancel, &reports);
    EXPECT(brio_read(io_ctx, io_path("c.ply"), NULL, &back) == BRIO_ERR_CANCELLED && !back);
    brio_context_set_progress(io_ctx, NULL, NULL);
    brio_mesh_free(old);
    brio_mesh_free(new);
}

static void permissions_and_links_stay(void) {
    brio_mesh *mesh = io_make(10, 0);
    struct stat facts;
    EXPECT(brio_write(io_ctx, io_path("p.ply"), mesh, NULL) == BRIO_OK);
    EXPECT(chmod(io_path("p.ply"), 0600) == 0 && symlink("p.ply", io_path("l.ply")) == 0);
    EXPECT(brio_write(io_ctx, io_path("l.ply"), mesh, NULL) == BRIO_OK);
    EXPECT(lstat(io_path("l.ply"), &facts) == 0 && S_ISLNK(facts.st_mode), "the link is replaced");
    EXPECT(stat(io_path("p.ply"), &facts) == 0 && (facts.st_mode & 0777) == 0600, "mode %o", (unsigned)facts.st_mode);
    brio_mesh_free(mesh);
}

/* --- names --- */

/* The temporary name was longer than the name, and so than a file system allows. */
static void longest_names_can_be_written(void) {
    brio_mesh *mesh = io_make(10, 0);
    for (int kind = 0; kind < 2; kind++) { /* bytes, and characters of two bytes */
        char name[256] = "";
        while (strlen(name) < 249) strcat(name, kind ? "\u00e9" : "n");
        while (strlen(name) < 251) strcat(name, "-");
        strcat(name, ".ply");
        EXPECT(strlen(name) == 255);
        EXPECT(brio_write(io_ctx, io_path(name), mesh, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
        EXPECT(io_count_files("") == 1 && io_count_files(name) == 1);
        unlink(io_path(name));
    }
    brio_mesh_free(mesh);
}

static bool is_link(const char *name) {
    struct stat facts;
    return lstat(io_path(name), &facts) == 0 && S_ISLNK(facts.st_mode);
}

static void link_to_no_file_makes_the_file(void) {
    brio_mesh *mesh = io_make(10, 0);
    EXPECT(mkdir(io_path("sub"), 0700) == 0);
    EXPECT(symlink("second.ply", io_path("first.ply")) == 0 && symlink("sub/file.ply", io_path("second.ply")) == 0);
    EXPECT(symlink("../back.ply", io_path("sub/up.ply")) == 0 && symlink("missing/x.ply", io_path("bad.ply")) == 0);
    EXPECT(brio_write(io_ctx, io_path("first.ply"), mesh, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(is_link("first.ply") && is_link("second.ply") && access(io_path("sub/file.ply"), R_OK) == 0);
    EXPECT(brio_write(io_ctx, io_path("sub/up.ply"), mesh, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(is_link("sub/up.ply") && access(io_path("back.ply"), R_OK) == 0);
    EXPECT(brio_write(io_ctx, io_path("bad.ply"), mesh, NULL) == BRIO_ERR_WRITE && is_link("bad.ply"));
    EXPECT(strstr(brio_message(io_ctx), "bad.ply: No such file"), "%s", brio_message(io_ctx));
    EXPECT(io_count_files(".part-") == 0);
    unlink(io_path("sub/file.ply"));
    unlink(io_path("sub/up.ply"));
    rmdir(io_path("sub"));
    io_empty_folder();
    brio_mesh_free(mesh);
}

static void names_that_cannot_be_written_are_a_status(void) {
    brio_mesh *mesh = io_make(10, 0);
    brio_write_options ply = {.size = sizeof(brio_write_options), .format = BRIO_FORMAT_PLY};
    EXPECT(symlink("b.ply", io_path("a.ply")) == 0 && symlink("a.ply", io_path("b.ply")) == 0);
    EXPECT(symlink(".", io_path("folder.ply")) == 0);
    const char *const wrong[] = {"a.ply", "folder.ply", "new/", ".", "a.ply/x.ply"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        EXPECT(brio_write(io_ctx, io_path(wrong[i]), mesh, &ply) == BRIO_ERR_WRITE, "%s", wrong[i]);
        EXPECT(io_count_files("") == 3, "%s", wrong[i]);
    }
    EXPECT(brio_write(io_ctx, "", mesh, &ply) == BRIO_ERR_WRITE, "the empty name");
    io_empty_folder();
    brio_mesh_free(mesh);
}

static int change_folder(const char *stage, double fraction, void *user) {
    (void)stage;
    (void)fraction;
    return chdir(user) != 0;
}

/* A relative path means the folder that the process was in when the writing began. */
static void change_of_the_working_folder_does_not_move_the_output(void) {
    brio_mesh *mesh = io_make(100000, 0);
    char old[4096];
    EXPECT(getcwd(old, sizeof old) && chdir(io_folder) == 0);
    brio_context_set_progress(io_ctx, change_folder, old);
    EXPECT(brio_write(io_ctx, "here.ply", mesh, NULL) == BRIO_OK, "%s", brio_message(io_ctx));
    brio_context_set_progress(io_ctx, NULL, NULL);
    EXPECT(chdir(old) == 0 && access(io_path("here.ply"), R_OK) == 0 && io_count_files(".part-") == 0);
    unlink(io_path("here.ply"));
    brio_mesh_free(mesh);
}

/* Standard output may be a file without a name. */
static void file_without_a_name_is_written_in_place(void) {
    brio_mesh *mesh = io_make(300, 0), *back = NULL;
    int out = dup(1), file = open(io_path("gone.ply"), O_RDWR | O_CREAT, 0600);
    unlink(io_path("gone.ply"));
    dup2(file, 1);
    brio_status status =
        brio_write(io_ctx, "/dev/stdout", mesh,
                   &(brio_write_options){.size = sizeof(brio_write_options), .format = BRIO_FORMAT_PLY});
    dup2(out, 1);
    EXPECT(status == BRIO_OK && io_count_files("") == 0, "%s", brio_message(io_ctx));
    int in = dup(0);
    EXPECT(lseek(file, 0, SEEK_SET) == 0 && dup2(file, 0) == 0);
    EXPECT(brio_read(io_ctx, "-", NULL, &back) == BRIO_OK && io_same_points(mesh, back));
    dup2(in, 0);
    close(in);
    close(out);
    close(file);
    brio_mesh_free(mesh);
    brio_mesh_free(back);
}

/* --- pipes that wait for ever --- */

/* The other side opens the FIFO, and then neither reads nor writes. */
static void expect_cancelled_wait(int other_side) {
    brio_mesh *mesh = io_make(100000, 0), *back = NULL;
    EXPECT(mkfifo(io_path("fifo"), 0600) == 0);
    int other = other_side ? open(io_path("fifo"), O_RDWR | O_NONBLOCK) : -1;
    for (int allowed = 0; allowed < 3; allowed++) {
        int left = allowed;
        brio_context_set_progress(io_ctx, cancel, &left);
        brio_write_options ply = {.size = sizeof(brio_write_options), .format = BRIO_FORMAT_PLY};
        EXPECT(brio_write(io_ctx, io_path("fifo"), mesh, &ply) == BRIO_ERR_CANCELLED, "%s", brio_message(io_ctx));
        char taken[4096]; /* what was written must not be there to be read */
        while (other >= 0 && read(other, taken, sizeof taken) > 0) {}
        left = allowed;
        EXPECT(brio_read(io_ctx, io_path("fifo"), &(brio_read_options){.format = BRIO_FORMAT_PLY}, &back) ==
                       BRIO_ERR_CANCELLED &&
                   !back,
               "%s", brio_message(io_ctx));
    }
    brio_context_set_progress(io_ctx, NULL, NULL);
    if (other >= 0) close(other);
    unlink(io_path("fifo"));
    brio_mesh_free(mesh);
}

static void fifo_without_another_side_can_be_cancelled(void) {
    expect_cancelled_wait(0);
}

static void fifo_with_a_stalled_side_can_be_cancelled(void) {
    expect_cancelled_wait(1);
}

/* Writes to standard output and reads from standard input, both a file in place of the terminal. */
static void standard_streams(void) {
    brio_mesh *mesh = io_make(300, IO_FACES | IO_PROPERTIES), *back = NULL;
    brio_write_options options = {0};
    options.format = BRIO_FORMAT_PLY;
    int out = dup(1), in = dup(0), file = open(io_path("s"), O_RDWR | O_CREAT, 0600);
    dup2(file, 1);
    brio_status status = brio_write(io_ctx, "-", mesh, &options);
    dup2(out, 1);
    EXPECT(status == BRIO_OK, "%s", brio_message(io_ctx));
    EXPECT(lseek(file, 0, SEEK_SET) == 0);
    dup2(file, 0);
    status = brio_read(io_ctx, "-", NULL, &back);
    dup2(in, 0);
    EXPECT(status == BRIO_OK && io_same_points(mesh, back) && io_same_faces(mesh, back), "%s", brio_message(io_ctx));
    close(in);
    close(out);
    close(file);
    brio_mesh_free(mesh);
    brio_mesh_free(back);
}

static void numbers_from_a_pipe(void) {
    int ends[2], in = dup(0);
    brio_mesh *m = NULL;
    EXPECT(pipe(ends) == 0 && write(ends[1], "1 2 3\n4 5 6", 11) == 11);
    close(ends[1]);
    dup2(ends[0], 0);
    brio_status status = brio_read(io_ctx, "-", NULL, &m);
    dup2(in, 0);
    EXPECT(status == BRIO_OK && m->num_vertices == 2 && m->vertices[5] == 6, "%s", brio_message(io_ctx));
    close(in);
    close(ends[0]);
    brio_mesh_free(m);
}

SUITE(test_io_write) {
    io_begin();
    RUN(ply_reads_back);
    RUN(vtu_reads_back);
    RUN(texts_read_back);
    RUN(empty_mesh_reads_back);
    RUN(node_replaces_old_tetrahedra);
    RUN(property_names_become_words);
    RUN(names_are_utf8_in_every_format);
    RUN(numbered_names_are_whole_characters);
    RUN(names_that_texts_take_for_something_else);
    RUN(refuse_what_the_format_cannot_hold);
    RUN(coordinates_that_are_no_numbers_are_refused);
    RUN(full_disk_is_a_status);
    RUN(unwritable_folder_is_a_status);
    RUN(cancelled_write_leaves_the_old_file);
    RUN(permissions_and_links_stay);
    io_empty_folder();
    RUN(longest_names_can_be_written);
    RUN(link_to_no_file_makes_the_file);
    RUN(names_that_cannot_be_written_are_a_status);
    RUN(change_of_the_working_folder_does_not_move_the_output);
    RUN(file_without_a_name_is_written_in_place);
    RUN(fifo_without_another_side_can_be_cancelled);
    RUN(fifo_with_a_stalled_side_can_be_cancelled);
    RUN(standard_streams);
    RUN(numbers_from_a_pipe);
    return io_end();
}
